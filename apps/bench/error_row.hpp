// SPDX-License-Identifier: Apache-2.0
// apps/bench/error_row.hpp: errors along a path as figures of a row; and the entrants that a comparison needs.
//
// Any thread; no cost.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

inline void addCells(BenchRow& row, const BenchRow& more) {
  row.insert(row.end(), more.begin(), more.end());
}

// Figures of nothing (without contact, or without a surface that is shown) are NaN: null in JSON, a dash in tables.
[[nodiscard]] BenchRow errorRow(const TouchErrors& errors);

// As makeEntrants(), but an algorithm to which n means nothing takes part once, with the first.
[[nodiscard]] std::vector<Entrant> makeEntrantsOnce(const BenchVolume& volume, const std::vector<int>& renewals);

}  // namespace palpate
