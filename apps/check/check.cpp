// SPDX-License-Identifier: Apache-2.0
#include "apps/check/check.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"

namespace palpate {
namespace {

// Maps floats to integers in the same order: negative floats count down from 0x7fffffff.
std::uint32_t order(float value) noexcept {
  constexpr std::uint32_t kSign = 0x80000000U;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

// JSON has no infinities.
nlohmann::ordered_json numberOrText(float value) {
  if (std::isfinite(value)) return value;
  return fmt::format("{}", value);
}

nlohmann::ordered_json rowOf(const Check& check) {
  nlohmann::ordered_json row = {{"check", check.name},
                                {"what", check.what},
                                {"part", check.part},
                                {"volume", check.volume},
                                {"vulkan_device", check.device},
                                {"compared", check.compared},
                                {"differing", check.differing},
                                {"broken", check.broken},
                                {"not_finite", check.not_finite},
                                {"largest_ulp", check.largest_ulp}};
  if (check.reason.empty()) {
    row["bound_ulp"] = check.bound_ulp;
  } else {
    row["largest_share_of_bound"] = check.largest_share;
    row["reason"] = check.reason;
  }
  row["worst_at_voxel"] = {check.voxel.x(), check.voxel.y(), check.voxel.z()};
  row["worst_component"] = check.component;
  row["worst_gpu"] = numberOrText(check.gpu_value);
  row["worst_cpu"] = numberOrText(check.cpu_value);
  row["holds"] = check.holds();
  row["gpu_s"] = check.gpu_seconds;
  row["cpu_s"] = check.cpu_seconds;
  return row;
}

bool isPartOfTheSame(const Check& a, const Check& b) {
  return a.name == b.name && a.what == b.what && a.volume == b.volume && !a.part.empty() && !b.part.empty();
}

std::string lineOf(std::span<const Check> parts, std::size_t name, std::size_t what) {
  Check sum;
  bool bounded = false;
  bool holds = true;
  for (const Check& check : parts) {
    sum.compared += check.compared;
    sum.differing += check.differing;
    sum.largest_ulp = std::max(sum.largest_ulp, check.largest_ulp);
    sum.largest_share = std::max(sum.largest_share, check.largest_share);
    sum.gpu_seconds += check.gpu_seconds;
    sum.cpu_seconds += check.cpu_seconds;
    bounded = bounded || !check.reason.empty();
    holds = holds && check.holds();
  }
  const std::string largest =
      bounded ? fmt::format("{:.2g} bound", sum.largest_share) : fmt::format("{} ULP", sum.largest_ulp);
  return fmt::format("  {:<6} {:<{}}  {:<{}} {:>10} {:>9} {:>10} {:>8.3f} {:>8.3f}\n", holds ? "yes" : "NO",
                     parts[0].name, name, parts[0].what, what, sum.compared, sum.differing, largest, sum.gpu_seconds,
                     sum.cpu_seconds);
}

std::string brokenWords(const Check& check) {
  return fmt::format(
      "         {}{}{} values break the promise of {}; worst at voxel {},{},{} {}: GPU {:.9g}, CPU {:.9g}\n",
      check.part, check.part.empty() ? "" : ": ", check.broken, promiseWords(check), check.voxel.x(), check.voxel.y(),
      check.voxel.z(), check.component, check.gpu_value, check.cpu_value);
}

}  // namespace

std::uint32_t ulpDistance(float a, float b) noexcept {
  if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b)) return 0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint32_t>::max();
  return order(a) > order(b) ? order(a) - order(b) : order(b) - order(a);
}

void Check::note(const Vec3i& where, const char* of_what, float gpu, float cpu) {
  voxel = where;
  component = of_what;
  gpu_value = gpu;
  cpu_value = cpu;
}

bool Check::breaksAsNotFinite(const Vec3i& where, const char* of_what, float gpu, float cpu) {
  if (!finite || std::isfinite(gpu)) return false;
  if (ulpDistance(gpu, cpu) != 0) ++differing;
  if (broken++ == 0) note(where, of_what, gpu, cpu);
  ++not_finite;
  return true;
}

void Check::compare(const Vec3i& where, const char* of_what, float gpu, float cpu) {
  ++compared;
  if (breaksAsNotFinite(where, of_what, gpu, cpu)) return;
  const std::uint32_t ulp = ulpDistance(gpu, cpu);
  if (ulp == 0) return;
  ++differing;
  if (ulp > bound_ulp) ++broken;
  if (ulp <= largest_ulp) return;
  largest_ulp = ulp;
  note(where, of_what, gpu, cpu);
}

void Check::compareWithin(const Vec3i& where, const char* of_what, float gpu, float cpu, double bound) {
  ++compared;
  if (breaksAsNotFinite(where, of_what, gpu, cpu)) return;
  const std::uint32_t ulp = ulpDistance(gpu, cpu);
  if (ulp == 0) return;
  ++differing;
  largest_ulp = std::max(largest_ulp, ulp);
  const double apart = std::abs(static_cast<double>(gpu) - cpu);
  const double share = apart <= bound ? (apart > 0 ? apart / bound : 0) : std::numeric_limits<double>::infinity();
  const bool breaks = !(apart <= bound);
  // Of several that break it the first is told: it has the fewest others behind it.
  if ((breaks && broken == 0) || share > largest_share || component.empty()) {
    largest_share = std::max(share, largest_share);
    note(where, of_what, gpu, cpu);
  }
  if (breaks) ++broken;
}

std::string promiseWords(const Check& check) {
  const char* finite = check.finite ? " and finite numbers" : "";
  if (!check.reason.empty()) return fmt::format("a bound of each value's own{}", finite);
  if (check.bound_ulp == 0) return fmt::format("0 differing bits{}", finite);
  return fmt::format("{} ULP{}", check.bound_ulp, finite);
}

std::string checkTable(std::span<const Check> checks) {
  std::size_t name = 5;
  std::size_t what = 4;
  for (const Check& check : checks) {
    name = std::max(name, check.name.size());
    what = std::max(what, check.what.size());
  }
  std::string text = fmt::format("  {:<6} {:<{}}  {:<{}} {:>10} {:>9} {:>10} {:>8} {:>8}\n", "holds", "check", name,
                                 "what", what, "values", "differing", "largest", "GPU [s]", "CPU [s]");
  std::string volume;
  std::vector<std::string> reasons;
  for (std::size_t first = 0; first < checks.size();) {
    std::size_t end = first + 1;
    while (end < checks.size() && isPartOfTheSame(checks[first], checks[end])) ++end;
    const auto parts = checks.subspan(first, end - first);
    if (parts[0].volume != volume) text += fmt::format("{}\n", volume = parts[0].volume);
    text += lineOf(parts, name, what);
    for (const Check& check : parts) {
      if (!check.holds()) text += brokenWords(check);
      if (!check.reason.empty() && std::find(reasons.begin(), reasons.end(), check.reason) == reasons.end())
        reasons.push_back(check.reason);
    }
    first = end;
  }
  text += "Promised are finite densities and 0 differing bits";
  for (const std::string& reason : reasons) text += fmt::format("; but\n  {}", reason);
  const auto held = std::count_if(checks.begin(), checks.end(), [](const Check& check) { return check.holds(); });
  return text + fmt::format(".\n{} of {} checks hold{}\n", held, checks.size(),
                            allHold(checks) ? "" : ": the promise is BROKEN");
}

std::string checkJson(std::span<const Check> checks, const std::string& name, const std::string& commit) {
  nlohmann::ordered_json json = {
      {"check", name}, {"commit", commit}, {"holds", allHold(checks)}, {"checks", nlohmann::ordered_json::array()}};
  for (const Check& check : checks) json["checks"].push_back(rowOf(check));
  return jsonFileText(json);
}

bool allHold(std::span<const Check> checks) noexcept {
  return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.holds(); });
}

}  // namespace palpate
