// SPDX-License-Identifier: Apache-2.0
#include "base/byte_size.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kMiB = 1048576.0;
constexpr double kTooMany = 9223372036854775808.0;  // 2^63

constexpr std::pair<std::string_view, double> kUnits[] = {
    {"", 1},      {"b", 1},        {"kb", 1e3},   {"mb", 1e6},           {"gb", 1e9},
    {"tb", 1e12}, {"kib", 1024.0}, {"mib", kMiB}, {"gib", 1073741824.0}, {"tib", 1099511627776.0}};

}  // namespace

std::uint64_t byteSize(const std::string& text, const std::string& input) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  std::string unit(rest, end);
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto* known =
      std::find_if(std::begin(kUnits), std::end(kUnits), [&](const auto& u) { return u.first == unit; });
  const double bytes = known == std::end(kUnits) ? -1 : number * known->second;
  if (error != std::errc{} || !(bytes >= 0 && bytes < kTooMany)) {
    throw Error(Error::Code::kBadInput, input, fmt::format("'{}' is no size of memory", text),
                "give for example 512MiB, 2GiB or a number of bytes");
  }
  return static_cast<std::uint64_t>(bytes);
}

std::string byteSizeText(std::uint64_t bytes) {
  constexpr std::array kBinaryUnits = {"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (; bytes != 0 && bytes % 1024 == 0 && unit + 1 < kBinaryUnits.size(); ++unit) bytes /= 1024;
  return fmt::format("{}{}", bytes, kBinaryUnits[unit]);
}

std::string bytesInWords(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> kNames = {"B", "KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  // A value that rounds to 1024 of a unit is shown as 1 of the next.
  for (; std::round(value) >= 1024 && unit + 1 < kNames.size(); ++unit) value /= 1024;
  return fmt::format("{} {}", value >= 100 ? fmt::format("{:.0f}", std::round(value)) : fmt::format("{:.3g}", value),
                     kNames[unit]);
}

std::string inMiB(std::uint64_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / kMiB);
}

std::string wholeMiB(std::uint64_t bytes) {
  return fmt::format("{:.0f}MiB", std::ceil(static_cast<double>(bytes) / kMiB));
}

}  // namespace palpate
