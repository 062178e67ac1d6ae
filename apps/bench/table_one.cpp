// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/table_one.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/error_row.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

struct PaperRow {
  const char* name;     // as the paper prints it
  const char* phantom;  // part of our volume's name
  double hri_us, blezek_us, avila_us;
};

constexpr PaperRow kPaper[] = {
    {"sphere (64x64x64)", "sphere", 39.00, 47.10, 38.30},
    {"knot (64x64x64)", "knot", 42.00, 49.10, 41.20},
    {"head (128x128x64)", "head", 48.00, 59.70, 47.40},
    {"lung (128x128x64)", "lung", 46.80, 57.60, 46.20},
};

struct Column {
  const char* algorithm;
  const char* title;
};
constexpr Column kColumns[] = {
    {"hri", "hri"}, {"hri-paper", "Intermediate Repr."}, {"blezek", "Blezek and Robb"}, {"avila", "Avila and Sob."}};

std::optional<double> today_us(const BenchResult& result, const char* phantom, const char* algorithm) {
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "tick" || textOf(row, "algorithm") != algorithm ||
        figureOf(row, "n_ticks") != kTableRenewal)
      continue;
    if (textOf(row, "volume").find(phantom) != std::string::npos) return figureOf(row, "cost_ns") * 1e-3;
  }
  return std::nullopt;
}

std::string cell(std::optional<double> us, int decimals) {
  if (!us) return fmt::format("{:>10} {:>10}", "-", "-");
  return fmt::format("{:>10.{}f} {:>10.2f}", *us, decimals, 1e3 / *us);
}

// Those of the table, each once.
std::vector<Entrant> tableEntrants(const BenchVolume& volume) {
  std::vector<Entrant> list = makeEntrants(volume, {kTableRenewal}).list;
  std::erase_if(list, [](const Entrant& entrant) {
    return std::none_of(std::begin(kColumns), std::end(kColumns),
                        [&](const Column& column) { return entrant.algorithm == column.algorithm; });
  });
  return list;
}

std::optional<ContactPath> pathOf(const BenchVolume& volume, double depth_voxel, const TableTrialRequest& request) {
  try {
    return contactPath(
        volume, {.rate_hz = kBenchRate_hz, .depth_voxel = depth_voxel, .ticks = request.ticks, .seed = request.seed});
  } catch (const Error&) {  // nowhere so thick
    return std::nullopt;
  }
}

}  // namespace

std::string tableOne(const BenchResult& result) {
  std::string text =
      "Table 1: average time of a servo loop [microsecond] and servo rate [kHz]; planes renewed every 5 ticks.\n"
      "\"Intermediate Repr.\" today is hri-paper, the paper's Figure 2 to the letter; hri, the default, mends it.\n";
  text += fmt::format("{:<26}", "");
  for (const Column& column : kColumns) text += fmt::format("|{:^23}", column.title);
  text += fmt::format("\n{:<26}", "");
  for (const Column& column : kColumns) {
    static_cast<void>(column);
    text += fmt::format("|{:>11}{:>11} ", "time", "rate");
  }
  text += "\n";
  for (const PaperRow& row : kPaper) {
    text += fmt::format("{:<26}", std::string(row.name) + " today");
    for (const Column& column : kColumns) {
      text += fmt::format("| {} ", cell(today_us(result, row.phantom, column.algorithm), 4));
    }
    text += fmt::format("\n{:<26}", std::string(row.name) + " paper");
    for (const std::optional<double> us : {std::optional<double>(), std::optional(row.hri_us),
                                           std::optional(row.blezek_us), std::optional(row.avila_us)}) {
      text += fmt::format("| {} ", cell(us, 2));
    }
    text += "\n";
  }
  return text;
}

void addTableTrial(const TableTrialRequest& request, BenchResult& result, const BenchProgress& progress) {
  const double steps = static_cast<double>(request.volumes.size() * request.noises_voxel.size());
  double step = 0;
  for (const std::string& name : request.volumes) {
    for (const double noise_voxel : request.noises_voxel) {
      progress(step++ / steps);
      const BenchVolume volume(withNoise(name, noise_voxel, request.seed));
      std::vector<Entrant> entrants = tableEntrants(volume);
      for (const double depth_voxel : request.depths_voxel) {
        const auto path = pathOf(volume, depth_voxel, request);
        if (!path) continue;
        const auto still = [&](double) { progress(step / steps); };
        const auto errors = touchErrors(volume, *path, entrants, still);
        const auto costs = tickCosts(ReplayPath(volume, *path), entrants, request.cost, still);
        for (std::size_t e = 0; e < entrants.size(); ++e) {
          const Spread cost = spreadOf(costs[e].batch_ns);
          BenchRow row = {{"part", "table"},
                          {"volume", name},
                          {"algorithm", entrants[e].algorithm},
                          {"n_ticks", std::int64_t{entrants[e].n}},
                          {"noise_voxel", noise_voxel},
                          {"depth_voxel", depth_voxel},
                          {"seed", static_cast<std::int64_t>(request.seed)},
                          {"cost_ns", cost.median},
                          {"cost_quartile_1_ns", cost.low},
                          {"cost_quartile_3_ns", cost.high}};
          addCells(row, errorRow(errors[e]));
          result.rows.push_back(std::move(row));
        }
      }
    }
  }
}

std::string tableTrial(const BenchResult& result) {
  const auto nameOf = [](const BenchRow& row) {
    return fmt::format("{:<36} {:>5g} {:>5g}", textOf(row, "volume"), figureOf(row, "noise_voxel"),
                       figureOf(row, "depth_voxel"));
  };
  std::vector<std::string> lines;
  std::map<std::string, std::map<std::string, std::string>> cells;  // by line, by algorithm
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "table") continue;
    const std::string line = nameOf(row);
    if (cells.find(line) == cells.end()) lines.push_back(line);
    const double lost = 1 - figureOf(row, "contact_ticks") / std::max(1.0, figureOf(row, "ticks"));
    const double angle = figureOf(row, "force_angle_median_deg");
    cells[line][textOf(row, "algorithm")] =
        fmt::format("{:>8.4f} {:>8} {:>4.0f}", figureOf(row, "cost_ns") * 1e-3,
                    std::isnan(angle) ? "-" : fmt::format("{:.2f}", angle), 100 * lost);
  }
  if (lines.empty()) return {};
  std::string text =
      "Table 1 tried with noise and depth [voxel]: average time of a servo loop [microsecond], median angle of the "
      "force "
      "[degree], ticks in which\nthe contact was lost [%]; planes renewed every 5 ticks. A volume that is nowhere so "
      "thick has no line.\n";
  text += fmt::format("{:<36} {:>5} {:>5}", "", "noise", "depth");
  for (const Column& column : kColumns) text += fmt::format(" |{:^22}", column.title);
  for (const std::string& line : lines) {
    text += "\n" + line;
    for (const Column& column : kColumns) {
      const auto& of_line = cells[line];
      const auto at = of_line.find(column.algorithm);
      text += fmt::format(" |{:>22}", at == of_line.end() ? "-" : at->second);
    }
  }
  return text + "\n";
}

}  // namespace palpate
