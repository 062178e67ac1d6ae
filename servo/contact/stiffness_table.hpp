// SPDX-License-Identifier: Apache-2.0
// servo/contact/stiffness_table.hpp: a factor of the stiffness for each density, linear between the table's rows.
//
// Thread: factor() any; the rest is set-up code, which throws.
#pragma once

#include <vector>

namespace palpate {

struct StiffnessRow {
  double density = 0;
  double factor = 1;  // times the contact's K [-]
  [[nodiscard]] bool operator==(const StiffnessRow&) const = default;
};

class StiffnessTable {
 public:
  static constexpr double kLargestFactor = 100;

  // Throws Error(kBadInput) on an empty table, on densities that do not rise from row to row or are not finite, and on
  // a factor outside 0 to kLargestFactor.
  explicit StiffnessTable(std::vector<StiffnessRow> rows);

  // Linear between rows; constant before the first and after the last. Cost: linear in the number of rows.
  [[nodiscard]] double factor(double density) const noexcept;

  // The largest factor less the smallest.
  [[nodiscard]] double range() const noexcept;

 private:
  std::vector<StiffnessRow> rows_;
};

}  // namespace palpate
