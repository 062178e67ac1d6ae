// SPDX-License-Identifier: Apache-2.0
// apps/check/check.hpp: the record of a check of the GPU against its CPU twin: what was compared, the bound that was
// promised, and the result. Any thread.
//
// There are two kinds of bounds. By default a value may be off by `bound_ulp` floats, which is 0 unless a caller allows
// more. Where a kernel may round differently from its twin, each value has its own bound; the caller derives it from
// the rounding of the operations and gives a reason. For densities, finite numbers are promised too: NaN on both sides
// is no agreement.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/vec.hpp"

namespace palpate {

// The distance between two floats, counted in floats (ULP).
// 0 for equal bits. +0 and -0 are 1 apart, so that every differing bit shows. NaN and anything else are 2^32 - 1 apart.
[[nodiscard]] std::uint32_t ulpDistance(float a, float b) noexcept;

struct Check {
  std::string name;             // "filter", "gradient", "edits"
  std::string what;             // "gaussian:1.5"
  std::string part;             // "step 2 of 3"; empty: all of it
  std::string volume;           // as it was given
  std::uint32_t bound_ulp = 0;  // bound of every value; unused if there is a reason [ULP]
  std::string reason;           // why each value has its own bound, and which; empty: bound_ulp holds
  bool finite = false;          // finite values are promised too

  std::uint64_t compared = 0;     // number of values
  std::uint64_t differing = 0;    // values whose bits differ
  std::uint64_t broken = 0;       // values beyond their bound, or not finite
  std::uint64_t not_finite = 0;   // of the broken ones, those that are not finite
  std::uint32_t largest_ulp = 0;  // largest difference [ULP]
  double largest_share = 0;       // largest ratio of a difference to its own bound; only with a reason [-]
  Vec3i voxel = Vec3i::Zero();    // where the difference is worst
  std::string component;          // "density", "gradient_i", ...; empty: nothing differs
  float gpu_value = 0;            // at that voxel
  float cpu_value = 0;            // at that voxel
  std::string device;
  double gpu_seconds = 0;
  double cpu_seconds = 0;  // of the twin

  [[nodiscard]] bool holds() const noexcept { return compared > 0 && broken == 0; }

  // Compares one more value, bound by bound_ulp.
  void compare(const Vec3i& where, const char* of_what, float gpu, float cpu);
  // Compares one more value with its own bound. A NaN on one side only breaks every bound.
  void compareWithin(const Vec3i& where, const char* of_what, float gpu, float cpu, double bound);

 private:
  // Notes a value that is not finite where finite ones are promised; true if it did.
  bool breaksAsNotFinite(const Vec3i& where, const char* of_what, float gpu, float cpu);
  void note(const Vec3i& where, const char* of_what, float gpu, float cpu);
};

// "0 differing bits", "2 ULP", "a bound of each value's own", with "and finite numbers".
[[nodiscard]] std::string promiseWords(const Check& check);

// A table for people: a line for all parts of one check, the worst voxel of each part that does not hold, reasons, and
// the number of checks that hold.
[[nodiscard]] std::string checkTable(std::span<const Check> checks);

// {"check", "commit", "holds", "checks": [...]}.
[[nodiscard]] std::string checkJson(std::span<const Check> checks, const std::string& name, const std::string& commit);

[[nodiscard]] bool allHold(std::span<const Check> checks) noexcept;  // false for none

}  // namespace palpate
