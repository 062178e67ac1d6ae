// SPDX-License-Identifier: Apache-2.0
// tests/fuzz/scene_text.hpp: compares scenes value by value, and writes them as TOML.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"

namespace palpate::fuzz {

// All that a scene holds, as text.
inline std::vector<std::string> wordsOf(const Scene& scene) {
  std::vector<std::string> words;
  for (const SceneOption& option : sceneOptions()) words.push_back(optionText(option.value, scene));
  for (const ObjectSpec& object : scene.objects) words.push_back(objectText(object));
  return words;
}

// Whether two values are equal: bit for bit, a direction within rounding, since it is normalised again.
inline bool sameValue(const OptionValue& value, const Scene& a, const Scene& b) {
  return std::visit(
      [&](const auto& option) {
        using Option = std::decay_t<decltype(option)>;
        if constexpr (std::is_same_v<Option, NumberOption> || std::is_same_v<Option, IntegerOption>) {
          return std::visit([&](auto member) { return a.*member == b.*member; }, option.member);
        } else if constexpr (std::is_same_v<Option, VectorOption>) {
          const auto &of_a = a.*option.member, &of_b = b.*option.member;
          if (!of_a || !of_b || !option.direction) return of_a == of_b;
          return (*of_a - *of_b).norm() <= 4e-16;  // each of three components is rounded twice, to 2^-53 of 1
        } else {
          return a.*option.member == b.*option.member;
        }
      },
      value);
}

inline std::string quoted(const std::string& text) {
  std::string words = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      words += std::string("\\") + c;
    } else if (byte < 0x20 || byte == 0x7f) {
      words += fmt::format("\\u{:04x}", byte);
    } else {
      words += c;
    }
  }
  return words + "\"";
}

// "a:b,c:d" as [[a, b], [c, d]], "a,b,c" as [a, b, c].
inline std::string arrayOf(const std::string& text, bool rows) {
  std::string words = rows ? "[[" : "[";
  for (const char c : text) {
    if (c == ',') {
      words += rows ? "], [" : ", ";
    } else {
      words += c == ':' ? std::string(", ") : std::string(1, c);
    }
  }
  return words + (rows ? "]]" : "]");
}

// A scene file that holds all that `scene` holds.
inline std::string tomlOf(const Scene& scene) {
  std::string text;
  for (const SceneOption& option : sceneOptions()) {
    const std::string words = optionText(option.value, scene);
    if (words.empty()) continue;
    const bool number =
        std::holds_alternative<NumberOption>(option.value) || std::holds_alternative<IntegerOption>(option.value);
    const bool rows = std::holds_alternative<TableOption>(option.value);
    const bool array = rows || std::holds_alternative<VectorOption>(option.value);
    text += fmt::format("{} = {}\n", option.key, array ? arrayOf(words, rows) : number ? words : quoted(words));
  }
  for (const ObjectSpec& object : scene.objects) {
    std::string words = objectText(object);  // "kind:key=value:...:file=NAME", the file last, in which anything may be
    text += "[[object]]\n";
    std::size_t end = words.find(':');
    text += fmt::format("kind = {}\n", quoted(words.substr(0, end)));
    while (end != std::string::npos) {
      words.erase(0, end + 1);
      const std::size_t equals = words.find('=');
      const std::string key = words.substr(0, equals);
      end = key == "file" ? std::string::npos : words.find(':');
      const std::string value = words.substr(equals + 1, end == std::string::npos ? end : end - equals - 1);
      const bool is_text = key == "file" || key == "unit";
      text += fmt::format("{} = {}\n", key,
                          is_text                                ? quoted(value)
                          : value.find(',') != std::string::npos ? arrayOf(value, false)
                                                                 : value);
    }
  }
  return text;
}

}  // namespace palpate::fuzz
