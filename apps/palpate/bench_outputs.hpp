// SPDX-License-Identifier: Apache-2.0
// apps/palpate/bench_outputs.hpp: the benches of the program, and the files into which a bench's result goes. Set-up
// code.
#pragma once

#include <functional>
#include <list>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/bench/benches.hpp"
#include "base/atomic_file.hpp"

namespace palpate {

// Every bench of `palpate bench`.
[[nodiscard]] const std::vector<Bench>& everyBench();
// Throws Error(kBadInput) on an unknown name, which stands in `input`.
[[nodiscard]] const Bench& benchNamed(const std::string& name, const std::string& input);

// What a user may ask of the outputs of a bench; empty: no such file.
struct BenchOutputFlags {
  bool strict = false;  // exit status 1 when a target does not hold
  std::string json, csv, chart, page, report;
  std::vector<std::string> panels;  // of the chart, by title; none: all
};
// `report`: whether there is a report.
void addOutputFlags(CLI::App& verb, BenchOutputFlags& flags, bool report);

// The output files. They are opened before the bench runs, so that a bad name is refused in the first second.
class BenchOutputs {
 public:
  explicit BenchOutputs(const BenchOutputFlags& flags);
  // Writes the files, prints tables and targets. Throws Error kIo; CLI::RuntimeError for --strict; Error(kCancelled) if
  // the user stopped the bench.
  void finish(const Bench& bench, const BenchResult& result);

 private:
  using Text = std::function<std::string(const Bench& bench, const BenchResult& result, const std::string& tables)>;
  void add(const std::string& name, Text text);
  const BenchOutputFlags flags_;
  std::list<std::pair<AtomicFile, Text>> files_;
};

// Runs a bench, and adds commit and command to its result.
[[nodiscard]] BenchResult runBench(const Bench& bench, const BenchArguments& arguments);

// The other verbs under `palpate bench`.
void addBenchMerge(CLI::App& bench);
void addBenchShow(CLI::App& bench);
void addBenchAll(CLI::App& bench);

}  // namespace palpate
