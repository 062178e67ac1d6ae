// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_words.hpp"

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"

namespace palpate {

std::vector<std::string> sceneWords(const Scene& scene) {
  std::vector<std::string> words;
  for (const SceneOption& option : sceneOptions()) {
    const std::string text = optionText(option.value, scene);
    if (text == optionText(option.value, Scene{})) continue;
    words.emplace_back(option.flag);
    if (!isBare(option.value)) words.push_back(text);
  }
  for (const ObjectSpec& object : scene.objects) words.insert(words.end(), {"--object", objectText(object)});
  return words;
}

}  // namespace palpate
