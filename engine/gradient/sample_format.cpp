// SPDX-License-Identifier: Apache-2.0
#include "engine/gradient/sample_format.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kLargestPower =
    12;  // stored numbers are at most 2^12, a sixteenth of the largest half; the rest is for edits
constexpr int kScalePower = 120;  // beyond 2^120 or 2^-120 a scale or its inverse would be no normal float

// A power of two that scales numbers up to `largest` to at most 2^kLargestPower.
float scaleFor(double largest) {
  if (!(largest > 0)) return 1;
  int power = 0;
  (void)std::frexp(largest, &power);  // largest <= 2^power
  return std::ldexp(1.0F, std::clamp(kLargestPower - power, -kScalePower, kScalePower));
}

}  // namespace

layout::SampleCode SampleFormat::readingCode() const noexcept {
  return {code.zero, 1 / code.density_scale, 1 / code.gradient_scale};
}

SampleFormat halfSamples(float isovalue, float lowest, float highest, const Vec3& spacing_m) {
  const double low = static_cast<double>(lowest) - static_cast<double>(isovalue);
  const double high = static_cast<double>(highest) - static_cast<double>(isovalue);
  SampleFormat format;
  format.half = true;
  format.code.zero = isovalue;
  format.code.density_scale = scaleFor(std::max(std::abs(low), std::abs(high)));
  format.code.gradient_scale = scaleFor((high - low) / spacing_m.minCoeff());
  return format;
}

void checkHalfSamples(const SampleFormat& format, float lowest, float highest, double contrast) {
  // Near the isovalue halves lie 2^-24 apart, so they are rounded by up to half of that.
  const double rounding = std::ldexp(1.0, -25) / static_cast<double>(format.code.density_scale);
  if (rounding <= std::ldexp(contrast, -11)) return;
  throw Error(
      Error::Code::kBadInput, "--samples half",
      fmt::format("densities from {:g} to {:g} are too far apart for halves: "
                  "rounding by up to {:g} is too coarse for a surface whose object lies {:g} above the isovalue",
                  lowest, highest, rounding, contrast),
      "use --samples float; if the farthest density marks what was not measured, replace it in the file");
}

}  // namespace palpate
