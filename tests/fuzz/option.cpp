// SPDX-License-Identifier: Apache-2.0
// One option of a scene, as FLAG=TEXT. An accepted value, written as text and read again, is the same, bit for bit. A
// refused one leaves the scene as it was.
#include "apps/scene/option_table.hpp"
#include "fuzz_target.hpp"
#include "scene_text.hpp"

namespace {

using namespace palpate;

void check(const std::string& input) {
  const std::size_t equals = input.find('=');
  const SceneOption* option = nullptr;
  for (const SceneOption& one : sceneOptions()) {
    if (input.substr(0, equals) == one.flag) option = &one;
  }
  if (option == nullptr || equals == std::string::npos) return;
  Scene scene;
  if (!fuzz::accepts(option->flag, [&] { setOption(option->value, input.substr(equals + 1), option->flag, scene); })) {
    fuzz::require(fuzz::wordsOf(scene) == fuzz::wordsOf(Scene{}), "a refused value changed the scene");
    return;
  }
  const std::string words = optionText(option->value, scene);
  if (words.empty()) return;  // the text means "none"
  fuzz::mustAccept("its own words are refused: " + words, [&] {
    Scene again;
    setOption(option->value, words, option->flag, again);
    fuzz::require(fuzz::sameValue(option->value, again, scene), "it reads otherwise from " + words);
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
