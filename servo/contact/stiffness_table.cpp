// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_table.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr const char* kInput = "stiffness by density";

[[noreturn]] void refuse(const std::string& reason, const char* remedy) {
  throw Error(Error::Code::kBadInput, kInput, reason, remedy);
}

std::optional<double> number(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(" \t") - first + 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

StiffnessTable::StiffnessTable(std::vector<StiffnessRow> rows) : rows_(std::move(rows)) {
  if (rows_.empty()) refuse("the table has no row", "give one or more");
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const StiffnessRow& row = rows_[i];
    if (!std::isfinite(row.density)) refuse(fmt::format("density {:g}", row.density), "give a finite number");
    if (!(row.factor >= 0 && row.factor <= kLargestFactor)) {
      refuse(fmt::format("factor {:g} cannot be used", row.factor), "give one from 0 to 100");
    }
    if (i > 0 && !(row.density > rows_[i - 1].density)) {
      refuse(fmt::format("density {:g} comes after {:g}", row.density, rows_[i - 1].density),
             "give the rows in rising order");
    }
  }
}

double StiffnessTable::factor(double density) const noexcept {
  if (!(density > rows_.front().density)) return rows_.front().factor;
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    const StiffnessRow& a = rows_[i - 1];
    const StiffnessRow& b = rows_[i];
    if (density < b.density)
      return a.factor + (b.factor - a.factor) * ((density - a.density) / (b.density - a.density));
  }
  return rows_.back().factor;
}

std::vector<StiffnessRow> parseStiffnessRows(std::string_view text) {
  std::vector<StiffnessRow> rows;
  while (!text.empty()) {
    const auto comma = text.find(',');
    const std::string_view row = text.substr(0, comma);
    const auto colon = row.find(':');
    const auto density = colon == std::string_view::npos ? std::nullopt : number(row.substr(0, colon));
    const auto factor = colon == std::string_view::npos ? std::nullopt : number(row.substr(colon + 1));
    if (!density || !factor || comma + 1 == text.size()) {
      refuse(fmt::format("'{}' is no row of the table", density && factor ? "" : row),
             "give density:factor,density:factor");
    }
    rows.push_back({*density, *factor});
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  }
  return rows;
}

}  // namespace palpate
