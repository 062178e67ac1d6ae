// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/edit_value.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuseValue(const EditValue& value, const std::string& what, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, value.where, fmt::format("'{}' of {} is {}", value.text, value.key, what),
              remedy);
}

// Parses a number at the front of the text and removes it.
double numberFrom(const EditValue& value, std::string_view& rest, const char* remedy) {
  double number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error != std::errc{} || !std::isfinite(number)) refuseValue(value, "no number", remedy);
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return number;
}

// "no length: there is no unit 'miles'", where a word stands behind the number.
std::string withUnit(const char* what, std::string_view unit) {
  if (unit.empty() || unit.find_first_of("0123456789.,") != std::string_view::npos) return what;
  return fmt::format("{}: there is no unit '{}'", what, unit);
}

std::optional<double> metresPer(std::string_view unit) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"", kMetresPerMillimetre}, {"mm", kMetresPerMillimetre}, {"um", 1e-6}, {"cm", 1e-2}, {"m", 1}};
  for (const auto& [name, metres] : kUnits) {
    if (name == unit) return metres;
  }
  return std::nullopt;
}

// Parses x,y,z at the front of the text and removes them.
Vec3 threeFrom(const EditValue& value, std::string_view& rest, const char* remedy) {
  Vec3 numbers;
  for (int axis = 0; axis < 3; ++axis) {
    numbers[axis] = numberFrom(value, rest, remedy);
    if (axis == 2) break;
    if (!rest.starts_with(',')) refuseValue(value, "not three numbers", remedy);
    rest.remove_prefix(1);
  }
  return numbers;
}

}  // namespace

double EditValue::number(double lowest, double highest) const {
  std::string_view rest = text;
  const std::string range = fmt::format("give {:g} to {:g}", lowest, highest);
  const double number = numberFrom(*this, rest, range.c_str());
  if (!rest.empty()) refuseValue(*this, "no number", range);
  if (number < lowest || number > highest)
    throw Error(Error::Code::kBadInput, where, fmt::format("{} is {:g}", key, number), range);
  return number;
}

double EditValue::length() const {
  constexpr const char* kRemedy = "give a number and mm, um, cm or m: 2mm";
  std::string_view rest = text;
  const double number = numberFrom(*this, rest, kRemedy);
  const std::optional<double> metres = metresPer(rest);
  if (!metres) refuseValue(*this, withUnit("no length", rest), kRemedy);
  if (!(number * *metres > 0)) refuseValue(*this, "no length above 0", kRemedy);
  return number * *metres;
}

Vec3 EditValue::place() const {
  constexpr const char* kRemedy = "give three numbers and, behind the last, mm, um, cm or m: 10,20,30mm";
  std::string_view rest = text;
  const Vec3 numbers = threeFrom(*this, rest, kRemedy);
  const std::optional<double> metres = metresPer(rest);
  if (!metres) refuseValue(*this, withUnit("no place", rest), kRemedy);
  return numbers * *metres;
}

Vec3 EditValue::numbers() const {
  constexpr const char* kRemedy = "give three numbers: 0,0,1";
  std::string_view rest = text;
  Vec3 numbers = threeFrom(*this, rest, kRemedy);
  if (!rest.empty()) refuseValue(*this, "not three numbers", kRemedy);
  return numbers;
}

}  // namespace palpate
