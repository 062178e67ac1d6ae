// SPDX-License-Identifier: Apache-2.0
// Halves against their definition, the kernels' text against the twin, and the error that samples as halves have.
#include "engine/reference/half.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "shaders/kernel_text.hpp"

namespace palpate {
namespace half_test {

// The bits of known numbers (IEEE 754 binary16).
TEST(Half, HasTheBitsOfTheStandard) {
  EXPECT_EQ(reference::toHalf(0.0F), 0x0000);
  EXPECT_EQ(reference::toHalf(-0.0F), 0x8000);
  EXPECT_EQ(reference::toHalf(1.0F), 0x3c00);
  EXPECT_EQ(reference::toHalf(-2.0F), 0xc000);
  EXPECT_EQ(reference::toHalf(65504.0F), 0x7bff);
  EXPECT_EQ(reference::toHalf(std::ldexp(1.0F, -14)), 0x0400);
  EXPECT_EQ(reference::toHalf(std::ldexp(1.0F, -24)), 0x0001);
  EXPECT_EQ(reference::toHalf(1.0F / 3.0F), 0x3555);
  // Ties go to the even one: 2049 lies between 2048 and 2050, 2051 between 2050 and 2052, 2815 between 2814 and 2816.
  EXPECT_EQ(reference::toHalf(2049.0F), reference::toHalf(2048.0F));
  EXPECT_EQ(reference::toHalf(2051.0F), reference::toHalf(2052.0F));
  EXPECT_EQ(reference::toHalf(2815.0F), 0x6980);
  EXPECT_EQ(reference::toHalf(std::ldexp(1.0F, -25)), 0x0000);
  EXPECT_EQ(reference::toHalf(std::ldexp(3.0F, -25)), 0x0002);
  // Beyond the largest it stays that.
  EXPECT_EQ(reference::toHalf(65520.0F), 0x7bff);
  EXPECT_EQ(reference::toHalf(std::numeric_limits<float>::max()), 0x7bff);
  EXPECT_EQ(reference::toHalf(-std::numeric_limits<float>::infinity()), 0xfbff);
}

TEST(Half, ComesBackForEveryFiniteHalf) {
  for (std::uint32_t bits = 0; bits < 65536; ++bits) {
    if ((bits & 0x7c00U) == 0x7c00U) continue;  // infinities and NaN are never stored
    const auto half = static_cast<std::uint16_t>(bits);
    const float value = reference::fromHalf(half);
    ASSERT_EQ(reference::toHalf(value), half);
    ASSERT_EQ(kernel_text::halfOf(value), bits);
    ASSERT_EQ(std::bit_cast<std::uint32_t>(kernel_text::ofHalf(bits)), std::bit_cast<std::uint32_t>(value)) << bits;
  }
}

// Between two halves that follow one another, a float goes to the nearer one, and from the middle to the even one.
TEST(Half, OfEveryMiddleAndItsNeighboursIsTheNearest) {
  for (std::uint32_t bits = 0; bits < 0x7bffU; ++bits) {
    const float low = reference::fromHalf(static_cast<std::uint16_t>(bits));
    const float high = reference::fromHalf(static_cast<std::uint16_t>(bits + 1));
    const float middle = low + (high - low) / 2;  // exact: a half and one bit more
    const std::uint32_t even = bits % 2 == 0 ? bits : bits + 1;
    for (const float sign : {1.0F, -1.0F}) {
      const std::uint32_t top = sign < 0 ? 0x8000U : 0;
      const auto check = [&](float value, std::uint32_t want) {
        ASSERT_EQ(reference::toHalf(sign * value), top + want) << value;
        ASSERT_EQ(kernel_text::halfOf(sign * value), top + want) << value;
      };
      check(middle, even);
      check(std::nextafter(middle, low), bits);
      check(std::nextafter(middle, high), bits + 1);
    }
  }
}

TEST(Half, OfRandomFloatsIsTheKernelTexts) {
  std::mt19937 random(5);
  for (int n = 0; n < 4'000'000; ++n) {
    const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isnan(value)) continue;
    ASSERT_EQ(kernel_text::halfOf(value), reference::toHalf(value)) << value;
  }
}

// Scales are powers of two; the largest becomes at most 2^12, and more than half of that.
TEST(HalfSamples, ScaleByPowersOfTwo) {
  for (const float range : {1e-30F, 0.004F, 1.0F, 4095.0F, 65535.0F, 1e30F}) {
    const SampleFormat format = halfSamples(0.25F * range, 0, range, {0.7e-3, 0.9e-3, 1.3e-3});
    int power = 0;
    EXPECT_EQ(std::frexp(format.code.density_scale, &power), 0.5F) << range;
    EXPECT_EQ(std::frexp(format.code.gradient_scale, &power), 0.5F) << range;
    const double distance = 0.75 * static_cast<double>(range) * static_cast<double>(format.code.density_scale);
    const double gradient = static_cast<double>(range) / 0.7e-3 * static_cast<double>(format.code.gradient_scale);
    for (const double largest : {distance, gradient}) {
      EXPECT_LE(largest, 4096) << range;
      EXPECT_GT(largest, 2048) << range;
    }
    EXPECT_EQ(format.readingCode().density_scale * format.code.density_scale, 1) << range;
    EXPECT_EQ(format.readingCode().gradient_scale * format.code.gradient_scale, 1) << range;
  }
  EXPECT_EQ(halfSamples(5, 5, 5, Vec3::Ones()).code.density_scale, 1);  // a volume of one density
}

// The farther side decides, and the smallest spacing: 4000 lies below 2^12, 4010 / 0.5 below 2^13. Beyond 2^120 a scale
// or its inverse would be no normal float.
TEST(HalfSamples, ScaleByTheFarthestDensityAndTheSmallestSpacing) {
  const layout::SampleCode code = halfSamples(0, -4000, 10, {2, 0.5, 1}).code;
  EXPECT_EQ(code.zero, 0);
  EXPECT_EQ(code.density_scale, 1);
  EXPECT_EQ(code.gradient_scale, 0.5F);
  EXPECT_EQ(halfSamples(7, 7, 8, Vec3::Ones()).code.zero, 7);
  EXPECT_EQ(halfSamples(0, 0, 1e-40F, Vec3::Ones()).code.density_scale, std::ldexp(1.0F, 120));
  const layout::SampleCode huge = halfSamples(0, -3e38F, 3e38F, Vec3::Constant(1e-6)).code;
  EXPECT_EQ(huge.density_scale, std::ldexp(1.0F, -116));  // 3e38 lies below 2^128
  EXPECT_EQ(huge.gradient_scale, std::ldexp(1.0F, -120));
}

// The bound of engine/gradient/sample_format.hpp, and the side of the isovalue. A half has 11 bits, so its rounding is
// at most 2^-11 of it, or 2^-25 where it counts in 2^-24; the difference from the isovalue is rounded by 2^-24 of
// itself, which the (1 + 2^-11) holds, and the sum that gives the density back by 2^-24 of that.
TEST(HalfSamples, KeepDensitiesWithinTheStatedBoundAndOnTheirSide) {
  std::mt19937 random(7);
  const float isovalue = 226.3F;
  const SampleFormat format = halfSamples(isovalue, -1024, 3071, {0.7e-3, 0.9e-3, 1.3e-3});
  const double tiny = std::ldexp(1.0, -25) / static_cast<double>(format.code.density_scale);
  std::uniform_real_distribution<float> anywhere(-1024, 3071);
  std::uniform_real_distribution<float> power(-30, 8);
  for (int n = 0; n < 1'000'000; ++n) {
    const float near = isovalue + (n % 4 == 0 ? -1.0F : 1.0F) * std::exp2(power(random));
    const float density = n % 2 == 0 ? near : anywhere(random);
    const float back = reference::stored({0, 0, 0, density}, format).density;
    const double distance = std::abs(static_cast<double>(density) - static_cast<double>(isovalue));
    const double bound = std::ldexp(distance * (1 + std::ldexp(1.0, -11)), -11) + tiny +
                         std::ldexp(std::abs(static_cast<double>(back)), -24);
    ASSERT_LE(std::abs(static_cast<double>(back) - static_cast<double>(density)), bound) << density;
    ASSERT_EQ(back > isovalue, density > isovalue) << density;
    ASSERT_EQ(back < isovalue, density < isovalue) << density;
  }
  // The neighbours of the isovalue itself come back as they are.
  for (const float to : {-1e9F, 1e9F}) {
    const float neighbour = std::nextafter(isovalue, to);
    EXPECT_EQ(reference::stored({0, 0, 0, neighbour}, format).density, neighbour);
  }
  EXPECT_EQ(reference::stored({0, 0, 0, isovalue}, format).density, isovalue);
}

TEST(HalfSamples, KeepGradientsWithinTheStatedBoundAndFinite) {
  std::mt19937 random(8);
  const SampleFormat format = halfSamples(226, -1024, 3071, {0.7e-3, 0.9e-3, 1.3e-3});
  const double tiny = std::ldexp(1.0, -25) / static_cast<double>(format.code.gradient_scale);
  const float largest = 4095 / 0.7e-3F;
  std::uniform_real_distribution<float> anywhere(-largest, largest);
  std::uniform_real_distribution<float> power(-20, 0);
  for (int n = 0; n < 1'000'000; ++n) {
    const float g = anywhere(random) * (n % 2 == 0 ? 1.0F : std::exp2(power(random)));
    const float back = reference::stored({g, 0, 0, 0}, format).gradient_i;
    ASSERT_LE(std::abs(static_cast<double>(back) - static_cast<double>(g)),
              std::ldexp(std::abs(static_cast<double>(g)), -11) + tiny);
  }
  for (const float g : {1e30F, -1e38F, std::numeric_limits<float>::infinity()}) {
    const float back = reference::stored({g, g, g, g}, format).gradient_k;
    EXPECT_TRUE(std::isfinite(back)) << g;
    EXPECT_EQ(std::signbit(back), std::signbit(g));
    EXPECT_GT(std::abs(back), 15 * largest);
  }
}

// Scans are told apart from one whose "no data" leaves nothing of the surface; the bound is that of the formula.
TEST(HalfSamples, AreRefusedWhereTheyLoseTheSurface) {
  const auto check = [](float lowest, double contrast) {
    checkHalfSamples(halfSamples(400, lowest, 3071, Vec3::Constant(1e-3)), lowest, 3071, contrast);
  };
  EXPECT_NO_THROW(check(-1024, 600));
  EXPECT_NO_THROW(check(-32768, 600));
  EXPECT_NO_THROW(check(-1e9F, 600));
  for (const float lowest : {-1e12F, -1e20F, -3.4e38F}) {
    try {
      check(lowest, 600);
      ADD_FAILURE() << lowest;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("--samples half: densities from"), std::string::npos);
    }
  }
  // 3e10 lies below 2^35, so halves of the scale 2^-23 are rounded by 2^-25 / 2^-23, which is 2^-11 of 512.
  EXPECT_NO_THROW(check(-3e10F, 512));
  try {
    check(-3e10F, 511);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "--samples half: densities from -3e+10 to 3071 are too far apart for halves: "
                 "rounding by up to 0.25 is too coarse for a surface whose object lies 511 above the isovalue; "
                 "use --samples float; if the farthest density marks what was not measured, replace it in the file");
  }
}

}  // namespace half_test
}  // namespace palpate
