// SPDX-License-Identifier: Apache-2.0
#include "base/byte_size.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kMostBytes = 9007199254740992;  // 2^53: up to here a double counts bytes
constexpr std::array<const char*, 5> kUnits = {"B", "KiB", "MiB", "GiB", "TiB"};

// What the unit is multiplied with; 0: there is no such unit.
double factorOf(std::string_view unit) {
  std::string letters;
  for (const char c : unit) letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (letters.empty() || letters == "B") return 1;
  const std::size_t power = std::string_view(" KMGT").find(letters[0]);
  const std::string rest = letters.substr(1);
  if (power == 0 || power == std::string_view::npos || !(rest.empty() || rest == "B" || rest == "IB")) return 0;
  return std::ldexp(1.0, 10 * static_cast<int>(power));
}

}  // namespace

std::uint64_t byteSize(const std::string& text, const std::string& input) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  const double bytes = number * factorOf(unit);
  // Written so that NaN is refused too.
  if (error != std::errc() || !(bytes >= 1 && bytes <= kMostBytes) || bytes != std::floor(bytes)) {
    throw Error(Error::Code::kBadInput, input, fmt::format("'{}' is no size of memory", text),
                "give a number above 0 and a unit, for example 512MiB or 2GiB");
  }
  return static_cast<std::uint64_t>(bytes);
}

std::string byteSizeText(std::uint64_t bytes) {
  std::size_t unit = 0;
  for (; bytes != 0 && bytes % 1024 == 0 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024;
  return fmt::format("{}{}", bytes, kUnits[unit]);
}

}  // namespace palpate
