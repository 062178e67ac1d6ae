// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/quantity.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/scene/option_value.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

struct Unit {
  std::string_view word;
  double factor;  // to the unit of the result
};
constexpr Unit kForces[] = {{"N", 1}, {"mN", 1e-3}, {"uN", 1e-6}, {"kN", 1e3}};
constexpr Unit kTimes[] = {{"us", 1}, {"ms", 1e3}, {"ns", 1e-3}, {"s", 1e6}};

// Micro is a sign of its own on some keyboards, and the Greek letter on others.
std::string withPlainMicro(std::string unit) {
  for (const std::string_view micro : {"\u00b5", "\u03bc"}) {
    if (unit.starts_with(micro)) unit.replace(0, micro.size(), "u");
  }
  return unit;
}

double quantityOf(const std::string& text, const std::string& where, std::span<const Unit> units,
                  const std::string& example) {
  const std::string input = fmt::format("{} '{}'", where, text);
  const std::string remedy = fmt::format("give a number above 0 with its unit, as {}", example);
  const std::size_t number_end = text.find_last_of("0123456789. ");
  const std::size_t begin = number_end == std::string::npos ? 0 : number_end + 1;
  const std::string word = withPlainMicro(text.substr(begin));
  std::string number = text.substr(0, begin);
  while (!number.empty() && number.back() == ' ') number.pop_back();
  const auto value = numberOf(number);
  if (!value) refuse(input, number.empty() ? "it is no number" : fmt::format("'{}' is no number", number), remedy);
  const auto unit = std::ranges::find(units, word, &Unit::word);
  if (unit == units.end()) {
    std::vector<std::string_view> words;
    for (const Unit& known : units) words.push_back(known.word);
    refuse(input, word.empty() ? "it has no unit" : fmt::format("'{}' is no unit of it", word),
           fmt::format("use one of {}, as {}", fmt::join(words, ", "), example));
  }
  const double result = *value * unit->factor;
  if (!(result > 0) || !std::isfinite(result)) refuse(input, "it is not above 0 and finite", remedy);
  return result;
}

}  // namespace

double forceOf_N(const std::string& text, const std::string& where) {
  return quantityOf(text, where, kForces, "0.05N or 50mN");
}

double timeOf_us(const std::string& text, const std::string& where) {
  return quantityOf(text, where, kTimes, "200us or 0.2ms");
}

std::string forceText(double force_N) {
  return fmt::format("{}N", force_N);
}

std::string timeText(double time_us) {
  return fmt::format("{}us", time_us);
}

}  // namespace palpate
