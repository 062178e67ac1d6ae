// SPDX-License-Identifier: Apache-2.0
// base/units.hpp: conversions between the units of files and screens and those of the code (SI).
#pragma once

namespace palpate {

inline constexpr double kMetresPerMillimetre = 1e-3;
inline constexpr double kMillimetresPerMetre = 1e3;
inline constexpr double kDegreesPerRadian = 57.29577951308232;
inline constexpr double kNanosecondsPerSecond = 1e9;
inline constexpr double kNanosecondsPerMillisecond = 1e6;
inline constexpr double kNanosecondsPerMicrosecond = 1e3;

}  // namespace palpate
