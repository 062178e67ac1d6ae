// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/table_one.hpp"

#include <optional>

#include <fmt/format.h>

#include "apps/bench/servo_bench.hpp"

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

std::optional<double> today_us(const BenchResult& result, const char* phantom, const char* algorithm) {
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "tick" || textOf(row, "algorithm") != algorithm || figureOf(row, "n_ticks") != 5)
      continue;
    if (textOf(row, "volume").find(phantom) != std::string::npos) return figureOf(row, "cost_ns") * 1e-3;
  }
  return std::nullopt;
}

std::string cell(std::optional<double> us, int decimals) {
  if (!us) return fmt::format("{:>10} {:>10}", "-", "-");
  return fmt::format("{:>10.{}f} {:>10.2f}", *us, decimals, 1e3 / *us);
}

}  // namespace

std::string tableOne(const BenchResult& result) {
  std::string text =
      "Table 1: average time of a servo loop [microsecond] and servo rate [kHz]; planes renewed every 5 ticks\n";
  text += fmt::format("{:<26}|{:^23}|{:^23}|{:^23}\n", "", "Intermediate Repr.", "Blezek and Robb", "Avila and Sob.");
  text += fmt::format("{:<26}|{:>11}{:>11} |{:>11}{:>11} |{:>11}{:>11}\n", "", "time", "rate", "time", "rate", "time",
                      "rate");
  for (const PaperRow& row : kPaper) {
    text += fmt::format("{:<26}| {} | {} | {}\n", std::string(row.name) + " today",
                        cell(today_us(result, row.phantom, "hri"), 4), cell(today_us(result, row.phantom, "blezek"), 4),
                        cell(today_us(result, row.phantom, "avila"), 4));
    text += fmt::format("{:<26}| {} | {} | {}\n", std::string(row.name) + " paper", cell(row.hri_us, 2),
                        cell(row.blezek_us, 2), cell(row.avila_us, 2));
  }
  return text;
}

}  // namespace palpate
