// SPDX-License-Identifier: Apache-2.0
// apps/study/studies.hpp: the studies that there are, each from a file of its own. A new one is such a file, a line
// here and one in studies.cpp. Any thread.
#pragma once

#include "apps/study/study.hpp"

namespace palpate {

[[nodiscard]] Study gradientStudy();
[[nodiscard]] Study servoStudy();
[[nodiscard]] Study filterStudy();
[[nodiscard]] Study drawStudy();
[[nodiscard]] Study publishStudy();
[[nodiscard]] Study chainStudy();

}  // namespace palpate
