// SPDX-License-Identifier: Apache-2.0
// apps/study/study.hpp: what a study of error against run time is: its cells, the plots that show them, the orders of
// convergence that they should have, and what is promised of them. All but the cells is data, and is applied to rows,
// wherever these were measured (study_analysis.hpp).
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/study/cell.hpp"

namespace palpate {

// On what the cells of all studies depend.
struct StudySettings {
  bool quick = false;
  std::uint64_t seed = 1;
  std::string gpu = {};                                    // part of the Vulkan device's name; empty: the best one
  std::vector<std::string> python = {"/usr/bin/python3"};  // interpreter with VTK and SciPy, and its options
};

// A formula in a plot.
struct PlotLine {
  std::string name;
  double (*at)(double x) = nullptr;
};

// Rows of a study as marks between two logarithmic axes. A row without one of the two figures is not shown.
struct StudyPlot {
  std::string title;
  BenchRow like = {};                    // which rows: those with these figures
  std::string x, x_label, y, y_label;    // the keys of the figures, and words with units
  std::vector<std::string> series = {};  // keys of what names a series: {"library", "way"}
  std::vector<std::string> labels = {};  // likewise of what stands beside a mark
  bool front = true;                     // both figures should be small: the Pareto front is marked
  BenchRow standard = {};                // the row of the program's default settings; empty: none here
  const char* own = "";                  // the key whose word tells the default's rivals from itself
  std::vector<PlotLine> lines = {};
};

// A fit of error = C x^p over the rows of each family.
struct StudyOrder {
  std::string what;                 // "angle of the gradient against the size of a voxel"
  BenchRow like = {};               // as in StudyPlot
  std::vector<std::string> family;  // keys: rows with the same figures of these are fitted together
  std::string x, y;                 // keys
  double least = 0, most = std::numeric_limits<double>::infinity();  // of x: where the leading term rules
  double (*theory)(const BenchRow& row) = nullptr;                   // NaN: there is none
};

struct Study {
  const char* name = "";  // the part of its rows, and the word of --study
  const char* title = "";
  std::string words{};  // what was measured and how, for pages
  bool on_gpu = false;  // it needs a Vulkan device
  int rounds = 5, quick_rounds = 3;
  double seconds = 60, quick_seconds = 15;  // about, for what is told of the time left
  // The list is the same wherever the settings are the same.
  std::vector<StudyCell> (*cells)(const StudySettings& settings) = nullptr;
  std::vector<StudyPlot> (*plots)(bool quick) = nullptr;
  std::vector<StudyOrder> (*orders)(bool quick) = nullptr;
  void (*promise)(BenchResult& result) = nullptr;  // adds targets of its own; null: it has none
  // Keys of counts of what went wrong, which no logarithmic axis shows, and of what names their rows in a table.
  std::vector<std::string> counts = {}, counts_by = {};
};

// In the order of their rows.
[[nodiscard]] const std::vector<Study>& studies();
// Throws Error(kBadInput) on an unknown name.
[[nodiscard]] const Study& studyNamed(const std::string& name);

}  // namespace palpate
