// SPDX-License-Identifier: Apache-2.0
// engine/field/otsu.hpp: thresholds that split a histogram into classes with the largest variance between them.
// Private to engine/field. Source: Otsu, "A threshold selection method from gray-level histograms" (IEEE SMC 9, 1979).
#pragma once

#include <utility>

#include "engine/field/statistics.hpp"

namespace palpate {

// The threshold between two classes [density]: the middle of the empty bins between them, or the edge between two bins
// if none is empty. Cost: one pass over the bins.
[[nodiscard]] double otsuThreshold(const Histogram& histogram);

// Two thresholds for three classes, the lower first. Cost: bins^2.
[[nodiscard]] std::pair<double, double> otsuThresholds(const Histogram& histogram);

}  // namespace palpate
