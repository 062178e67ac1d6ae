// SPDX-License-Identifier: Apache-2.0
#include "base/byte_size.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kTooMany = 9223372036854775808.0;  // 2^63

constexpr std::pair<std::string_view, double> kUnits[] = {
    {"", 1},      {"b", 1},        {"kb", 1e3},        {"mb", 1e6},           {"gb", 1e9},
    {"tb", 1e12}, {"kib", 1024.0}, {"mib", 1048576.0}, {"gib", 1073741824.0}, {"tib", 1099511627776.0}};

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

}  // namespace palpate
