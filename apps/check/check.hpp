// SPDX-License-Identifier: Apache-2.0
// apps/check/check.hpp: what every check of the GPU against its CPU twin is: what was compared, what was promised, and
// what came out. Any thread.
//
// A promise is either bits (a value may be off by so many floats, 0 unless somebody asks for less) or, where the kernel
// may round otherwise than the twin, a bound of each value's own that whoever compares derives from the operations in
// between, and says why. Where densities come out, finite numbers are promised besides: NaN on both sides is no
// agreement.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/vec.hpp"

namespace palpate {

struct Check {
  std::string name;             // "filter", "gradient", "edits"
  std::string what;             // "gaussian:1.5"
  std::string part;             // "step 2 of 3"; empty: all of it
  std::string volume;           // as it was given
  std::uint32_t bound_ulp = 0;  // promised of every value [ULP]; of no meaning with a reason
  std::string reason;           // why the promise is a bound of each value's own, and which; empty: bits
  bool finite = false;          // promised besides: each value is a finite number

  std::uint64_t compared = 0;     // values
  std::uint64_t differing = 0;    // whose bits differ
  std::uint64_t broken = 0;       // that are further off than promised, or not finite
  std::uint64_t not_finite = 0;   // of those
  std::uint32_t largest_ulp = 0;  // of all [ULP]
  double largest_share = 0;       // of its own bound, of all; with a reason only [-]
  Vec3i voxel = Vec3i::Zero();    // where it is worst
  std::string component;          // "density", "gradient_i", ...; empty: nothing differs
  float gpu_value = 0;            // there
  float cpu_value = 0;
  std::string device;
  double gpu_seconds = 0;
  double cpu_seconds = 0;  // of the twin

  [[nodiscard]] bool holds() const noexcept { return compared > 0 && broken == 0; }

  // One value more, promised by its bits.
  void compare(const Vec3i& where, const char* of_what, float gpu, float cpu);
  // The same with a bound of its own; a NaN on one side alone breaks any.
  void compareWithin(const Vec3i& where, const char* of_what, float gpu, float cpu, double bound);

 private:
  // True: it is told already.
  bool breaksAsNotFinite(const Vec3i& where, const char* of_what, float gpu, float cpu);
  void note(const Vec3i& where, const char* of_what, float gpu, float cpu);
};

// "0 differing bits", "2 ULP", "a bound of each value's own", with "and finite numbers".
[[nodiscard]] std::string promiseWords(const Check& check);

// A table for people: a line for all parts of one check, the worst place of each part that does not hold, reasons, and
// how many hold.
[[nodiscard]] std::string checkTable(std::span<const Check> checks);

// {"check", "commit", "holds", "checks": [...]}.
[[nodiscard]] std::string checkJson(std::span<const Check> checks, const std::string& name, const std::string& commit);

[[nodiscard]] bool allHold(std::span<const Check> checks) noexcept;  // false for none

}  // namespace palpate
