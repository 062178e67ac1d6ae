// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_command.hpp"

#include <string_view>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"

namespace palpate {

std::string shellWord(const std::string& word) {
  static constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string sceneCommand(const std::string& verb, const Scene& scene) {
  std::string line = "palpate " + verb + " " + shellWord(scene.volume);
  for (const SceneOption& option : sceneOptions()) {
    const std::string text = optionText(option.value, scene);
    if (option.key == std::string_view("volume") || text.empty() || text == optionText(option.value, Scene{})) continue;
    line += std::string(" ") + option.flag;
    // With "=" where the value begins with a minus: it could pass for a flag.
    if (!isBare(option.value)) line += (text.front() == '-' ? "=" : " ") + shellWord(text);
  }
  for (const ObjectSpec& object : scene.objects) line += " --object " + shellWord(objectText(object));
  return line;
}

}  // namespace palpate
