// SPDX-License-Identifier: Apache-2.0
// apps/scene/option_value.hpp: the kinds of values in a scene, with range and screen unit, and how they are read from
// text and written as text.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "apps/scene/scene.hpp"

namespace palpate {

// A number; its value in the screen unit times `scale` is the SI value in the scene. The range is in the screen unit.
// It is closed, or open at its lower end.
struct NumberOption {
  std::variant<double Scene::*, std::optional<double> Scene::*> member;
  double scale = 1;
  double lowest = 0;
  double highest = 0;
  bool above_lowest = false;  // the lowest itself is refused

  [[nodiscard]] bool takes(double number) const noexcept {  // no NaN
    return (above_lowest ? number > lowest : number >= lowest) && number <= highest;
  }
};

struct IntegerOption {
  std::variant<int Scene::*, std::uint64_t Scene::*> member;
  long long lowest = 0;
  long long highest = 0;
};

// A size of memory: "512MiB". 0 in the scene means that none was given; a user cannot give 0.
struct BytesOption {
  std::uint64_t Scene::*member;
};

struct TextOption {
  std::string Scene::*member;
  bool may_be_empty = true;  // false: an empty text is refused
};

// Words, separated by blanks; in a scene file a list of texts.
struct ListOption {
  std::string Scene::*member;
};

// One of two words. Bare: on the command line the flag has no value and stands for the second.
struct SwitchOption {
  bool Scene::*member;
  const char* word_if_false;
  const char* word_if_true;
  bool bare = false;
};

// One of several words, the first of which is the default.
struct WordOption {
  std::string Scene::*member;
  std::span<const char* const> words;
};

// Three numbers with commas between them: "x,y,z".
struct VectorOption {
  std::optional<Vec3> Scene::*member;
  double scale = 1;
  bool direction = false;  // is normalised; zero is refused
};

// Rows of numbers: "a:b:c,d:e:f". At least one row, each with the numbers that `row` names.
struct TableOption {
  NumberTable Scene::*member;
  double first_scale;  // screen unit times this is the SI value, for the first number of each row
  const char* row;     // "density:force:viscosity"
};

using OptionValue = std::variant<NumberOption, IntegerOption, BytesOption, TextOption, ListOption, SwitchOption,
                                 WordOption, VectorOption, TableOption>;

// Sets the member of `scene` from `text`. `where`: the flag or key, `unit`: "mm", both for the message. Throws
// Error(kBadInput) for text of the wrong form, NaN, or a number out of range; the scene is then unchanged.
void setOption(const OptionValue& value, const std::string& text, const std::string& where, Scene& scene,
               const std::string& unit = "");

// The member's value in the form that setOption() takes; empty if the program chooses the value.
[[nodiscard]] std::string optionText(const OptionValue& value, const Scene& scene);

// The member of `from` goes to `to`, bit for bit.
void copyOption(const OptionValue& value, const Scene& from, Scene& to);
[[nodiscard]] bool isSame(const OptionValue& value, const Scene& one, const Scene& other);

// An SI value in screen units: with ten digits, or with the fewest digits above ten that give exactly the SI value when
// they are read and scaled. A vector is three such numbers, separated by commas.
[[nodiscard]] std::string screenText(double si, double scale);
[[nodiscard]] std::string screenText(const Vec3& si, double scale);

// The whole text as a number, or as three finite numbers separated by commas; empty for any other text.
[[nodiscard]] std::optional<double> numberOf(std::string_view text);
[[nodiscard]] std::optional<Vec3> vectorOf(std::string_view text);

[[nodiscard]] bool isBare(const OptionValue& value) noexcept;

// The words from which a user must choose; empty if the option takes any text, number or file.
[[nodiscard]] std::vector<std::string> optionWords(const OptionValue& value);

// What the option takes, in words: "0 ... 20000", "rigid or spring", "none, procedural or density", "x,y,z", "rows
// density:force:viscosity with commas between".
[[nodiscard]] std::string optionForm(const OptionValue& value);

}  // namespace palpate
