// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/option_value.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "apps/devices/device_table.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuseText(const std::string& where, const std::string& text, const OptionValue& value,
                             const std::string& unit) {
  std::string remedy =
      withDidYouMean(text, optionWords(value), "give " + optionForm(value) + (unit.empty() ? "" : ", in " + unit));
  if (const auto* words = std::get_if<WordOption>(&value); words != nullptr && words->member == &Scene::device) {
    for (const std::string& complaint : deviceKindComplaints()) remedy += fmt::format(" ({})", complaint);
  }
  refuse(where, fmt::format("'{}' is not what it takes", text), remedy);
}

template <typename Number>
std::optional<Number> parseNumber(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<Vec3> parseVector(std::string_view text) {
  Vec3 vector;
  for (int axis = 0; axis < 3; ++axis) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (axis == 2)) return std::nullopt;
    const auto number = parseNumber<double>(trimmed(text.substr(0, comma)));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    vector[axis] = *number;
    if (axis < 2) text.remove_prefix(comma + 1);
  }
  return vector;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::optional<NumberTable> parseTable(std::string_view text, std::size_t columns) {
  NumberTable table;
  for (const std::string_view row_text : split(text, ',')) {
    std::vector<double>& row = table.emplace_back();
    for (const std::string_view cell : split(row_text, ':')) {
      const auto number = parseNumber<double>(trimmed(cell));
      if (!number || !std::isfinite(*number)) return std::nullopt;
      row.push_back(*number);
    }
    if (row.size() != columns) return std::nullopt;
  }
  return table;
}

struct Setter {
  const OptionValue& value;
  const std::string& text;
  const std::string& where;
  const std::string& unit;
  Scene& scene;

  void operator()(const NumberOption& option) const {
    const auto number = parseNumber<double>(text);
    if (!number || !option.takes(*number)) refuseText(where, text, value, unit);
    std::visit([&](auto member) { scene.*member = *number * option.scale; }, option.member);
  }
  void operator()(const IntegerOption& option) const {
    const auto number = parseNumber<long long>(text);
    if (!number || *number < option.lowest || *number > option.highest) refuseText(where, text, value, unit);
    std::visit(
        [&](auto member) { scene.*member = static_cast<std::remove_reference_t<decltype(scene.*member)>>(*number); },
        option.member);
  }
  void operator()(const BytesOption& option) const { scene.*option.member = byteSize(text, where); }
  void operator()(const TextOption& option) const {
    if (text.empty() && !option.may_be_empty)
      throw Error(Error::Code::kBadInput, where, "'' is empty", "give " + optionForm(value) + ", or leave it out");
    scene.*option.member = text;
  }
  void operator()(const ListOption& option) const { scene.*option.member = text; }
  void operator()(const SwitchOption& option) const {
    if (text != option.word_if_false && text != option.word_if_true) refuseText(where, text, value, unit);
    scene.*option.member = text == option.word_if_true;
  }
  void operator()(const WordOption& option) const {
    if (std::find(option.words.begin(), option.words.end(), text) == option.words.end())
      refuseText(where, text, value, unit);
    scene.*option.member = text;
  }
  void operator()(const VectorOption& option) const {
    const auto vector = parseVector(text);
    if (!vector || (option.direction && vector->isZero(0))) refuseText(where, text, value, unit);
    // stableNormalized(): the square of a component may be too small or too large for a double.
    scene.*option.member = option.direction ? vector->stableNormalized() : Vec3(*vector * option.scale);
  }
  void operator()(const TableOption& option) const {
    auto table = parseTable(text, split(option.row, ':').size());
    if (!table) refuseText(where, text, value, unit);
    for (std::vector<double>& row : *table) {
      row.front() *= option.first_scale;
      if (!std::isfinite(row.front())) refuseText(where, text, value, unit);
    }
    scene.*option.member = std::move(*table);
  }
};

struct Writer {
  const Scene& scene;

  std::string operator()(const NumberOption& option) const {
    if (const auto* plain = std::get_if<double Scene::*>(&option.member))
      return screenText(scene.**plain, option.scale);
    const auto& chosen = scene.*std::get<std::optional<double> Scene::*>(option.member);
    return chosen ? screenText(*chosen, option.scale) : std::string();
  }
  std::string operator()(const IntegerOption& option) const {
    return std::visit([&](auto member) { return std::to_string(scene.*member); }, option.member);
  }
  std::string operator()(const BytesOption& option) const {
    return scene.*option.member == 0 ? std::string() : byteSizeText(scene.*option.member);
  }
  std::string operator()(const TextOption& option) const { return scene.*option.member; }
  std::string operator()(const ListOption& option) const { return scene.*option.member; }
  std::string operator()(const SwitchOption& option) const {
    return scene.*option.member ? option.word_if_true : option.word_if_false;
  }
  std::string operator()(const WordOption& option) const { return scene.*option.member; }
  std::string operator()(const VectorOption& option) const {
    const std::optional<Vec3>& vector = scene.*option.member;
    if (!vector) return {};
    return screenText(*vector, option.direction ? 1 : option.scale);
  }
  std::string operator()(const TableOption& option) const {
    std::string text;
    for (const std::vector<double>& row : scene.*option.member) {
      text += (text.empty() ? "" : ",") + screenText(row.front(), option.first_scale);
      for (std::size_t i = 1; i < row.size(); ++i) text += ":" + screenText(row[i], 1);
    }
    return text;
  }
};

struct Form {
  std::string operator()(const NumberOption& option) const {
    return option.above_lowest ? fmt::format("a number above {:g}, at most {:g}", option.lowest, option.highest)
                               : fmt::format("a number from {:g} to {:g}", option.lowest, option.highest);
  }
  std::string operator()(const IntegerOption& option) const {
    return fmt::format("a whole number from {} to {}", option.lowest, option.highest);
  }
  std::string operator()(const BytesOption&) const { return "a size like 512MiB or 2GiB"; }
  std::string operator()(const TextOption&) const { return "text"; }
  std::string operator()(const ListOption&) const { return "words with blanks between"; }
  std::string operator()(const SwitchOption& option) const {
    return fmt::format("{} or {}", option.word_if_false, option.word_if_true);
  }
  std::string operator()(const WordOption& option) const {
    std::string text;
    for (std::size_t i = 0; i < option.words.size(); ++i) {
      const char* between = i + 1 < option.words.size() ? ", " : " or ";
      text += (i == 0 ? "" : between) + std::string(option.words[i]);
    }
    return text;
  }
  std::string operator()(const VectorOption& option) const {
    return option.direction ? "x,y,z, not all zero" : "x,y,z";
  }
  std::string operator()(const TableOption& option) const {
    return fmt::format("rows {} with commas between", option.row);
  }
};

}  // namespace

void setOption(const OptionValue& value, const std::string& text, const std::string& where, Scene& scene,
               const std::string& unit) {
  std::visit(Setter{value, text, where, unit, scene}, value);
}

std::string optionText(const OptionValue& value, const Scene& scene) {
  return std::visit(Writer{scene}, value);
}

bool isBare(const OptionValue& value) noexcept {
  const auto* option = std::get_if<SwitchOption>(&value);
  return option != nullptr && option->bare;
}

std::string optionForm(const OptionValue& value) {
  return std::visit(Form{}, value);
}

// The quotient may differ from the given number by a rounding or two.
std::string screenText(double si, double scale) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double shown = si / scale;
  const double above = std::nextafter(shown, kInfinity), below = std::nextafter(shown, -kInfinity);
  for (const double near : {shown, above, below, std::nextafter(above, kInfinity), std::nextafter(below, -kInfinity)}) {
    for (int digits = 10; digits <= 17; ++digits) {
      std::string text = fmt::format("{:.{}g}", near, digits);
      if (const auto read = parseNumber<double>(text); read && *read * scale == si) return text;
    }
  }
  return fmt::format("{:.17g}", shown);
}
std::string screenText(const Vec3& si, double scale) {
  return screenText(si.x(), scale) + "," + screenText(si.y(), scale) + "," + screenText(si.z(), scale);
}

std::vector<std::string> optionWords(const OptionValue& value) {
  if (const auto* words = std::get_if<WordOption>(&value)) return {words->words.begin(), words->words.end()};
  if (const auto* words = std::get_if<SwitchOption>(&value)) return {words->word_if_false, words->word_if_true};
  return {};
}

std::optional<double> numberOf(std::string_view text) {
  return parseNumber<double>(text);
}

std::optional<Vec3> vectorOf(std::string_view text) {
  return parseVector(text);
}

namespace {

// Calls `use` with the pointer to the option's member.
template <typename Use>
void withMember(const OptionValue& value, const Use& use) {
  std::visit(
      [&](const auto& option) {
        if constexpr (requires { option.member.index(); }) {
          std::visit(use, option.member);
        } else {
          use(option.member);
        }
      },
      value);
}

}  // namespace

void copyOption(const OptionValue& value, const Scene& from, Scene& to) {
  withMember(value, [&](auto member) { to.*member = from.*member; });
}

bool isSame(const OptionValue& value, const Scene& one, const Scene& other) {
  bool same = false;
  withMember(value, [&](auto member) { same = one.*member == other.*member; });
  return same;
}

}  // namespace palpate
