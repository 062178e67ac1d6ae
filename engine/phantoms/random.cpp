// SPDX-License-Identifier: Apache-2.0
// Random values for bit-exactness tests: a fifth each of ordinary values, denormals, +-1e-30, +-1e30 and zeros of both
// signs. It has no surface; its isovalue is 0.
#include <bit>
#include <limits>
#include <random>

#include "engine/phantoms/kinds.hpp"

namespace palpate {
namespace {

float randomValue(std::uint64_t bits) {
  const auto low = static_cast<std::uint32_t>(bits);
  const std::uint32_t sign = low & 0x80000000U;
  switch ((bits >> 32) % 5) {
    case 0:
      return static_cast<float>(static_cast<std::int32_t>(low)) * 0x1p-21F;  // within +-1024
    case 1:
      return std::bit_cast<float>(sign | (low & 0x007fffffU));  // denormal, rarely zero
    case 2:
      return sign != 0 ? -1e-30F : 1e-30F;
    case 3:
      return sign != 0 ? -1e30F : 1e30F;
    default:
      return sign != 0 ? -0.0F : 0.0F;
  }
}

class Random : public Phantom {
 public:
  explicit Random(const PhantomSpec& spec) : Phantom(spec, {0, -1000, 1000, 1}) {}

  [[nodiscard]] SurfaceOffset offset(const Vec3& /*p_W*/) const override {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, Vec3::Constant(kNone)};
  }
  [[nodiscard]] bool hasSurface() const override { return false; }

  [[nodiscard]] bool isByPlace() const override { return false; }
  [[nodiscard]] std::vector<float> densities() const override {
    std::mt19937_64 bits(spec().seed);
    std::vector<float> values(static_cast<std::size_t>(size().cast<long long>().prod()));
    for (float& value : values) value = randomValue(bits());
    return values;
  }
};

}  // namespace

std::unique_ptr<Phantom> makeRandom(const PhantomSpec& spec) {
  return std::make_unique<Random>(spec);
}

}  // namespace palpate
