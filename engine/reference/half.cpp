// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/half.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::reference {
namespace {

constexpr int kSmallestExponent = -14;  // of normal halves
constexpr int kFractionBits = 10;
constexpr double kLargest = 65504;

}  // namespace

std::uint16_t toHalf(float value) {
  const std::uint16_t sign = std::signbit(value) ? 0x8000 : 0;
  const double size = std::min(std::abs(static_cast<double>(value)), kLargest);
  const int exponent = size == 0 ? kSmallestExponent : std::max(std::ilogb(size), kSmallestExponent);
  const double steps = std::ldexp(size, kFractionBits - exponent);  // exact
  // Rounds half to even. If `count` becomes 2^11, the sum below carries into the exponent, as it should.
  const auto count = static_cast<int>(std::nearbyint(steps));
  // Below 2^-14 there is no implicit bit. Then count is less than 2^10, and the exponent field stays 0.
  return static_cast<std::uint16_t>(sign + ((exponent - kSmallestExponent) << kFractionBits) + count);
}

float fromHalf(std::uint16_t half) {
  const int field = (half >> kFractionBits) & 0x1f;
  const int fraction = half & ((1 << kFractionBits) - 1);
  const int count = field == 0 ? fraction : fraction + (1 << kFractionBits);
  const int exponent = std::max(field, 1) - 1 + kSmallestExponent;
  const auto size = static_cast<float>(std::ldexp(static_cast<double>(count), exponent - kFractionBits));
  return (half & 0x8000) != 0 ? -size : size;
}

Sample stored(const Sample& sample, const SampleFormat& format) {
  if (!format.half) return sample;
  const auto gradient = [&](float component) {
    return fromHalf(toHalf(component * format.code.gradient_scale)) / format.code.gradient_scale;
  };
  const float distance = sample.density - format.code.zero;
  const float kept = fromHalf(toHalf(distance * format.code.density_scale));
  return {gradient(sample.gradient_i), gradient(sample.gradient_j), gradient(sample.gradient_k),
          kept / format.code.density_scale + format.code.zero};
}

}  // namespace palpate::reference
