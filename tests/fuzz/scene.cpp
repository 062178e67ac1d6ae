// SPDX-License-Identifier: Apache-2.0
// Scene files. An accepted scene, written to a file in full, or as `palpate tune` does, and read again, is the same. A
// refused one leaves the scene as it was.
#include "apps/scene/scene_file.hpp"
#include "apps/scene/scene_text.hpp"
#include "fuzz_target.hpp"
#include "scene_text.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

// The scene in full is read from `words` as it is.
void readsBack(const fuzz::ScratchFile& file, const Scene& scene, const std::string& words) {
  file.write(words);
  fuzz::mustAccept("its own words are refused:\n" + words, [&] {
    Scene again;
    readSceneFile(file.path(), again);
    for (const SceneOption& option : sceneOptions())
      fuzz::require(fuzz::sameValue(option.value, again, scene),
                    std::string(option.key) + " reads otherwise from\n" + words);
    fuzz::require(fuzz::wordsOf(again).size() == fuzz::wordsOf(scene).size(), "objects are lost");
  });
}

void check(const std::string& bytes) {
  static const fuzz::ScratchFile file("scene.toml");
  file.write(bytes);
  Scene scene;
  if (!fuzz::accepts(file.path(), [&] { readSceneFile(file.path(), scene); })) {
    fuzz::require(fuzz::wordsOf(scene) == fuzz::wordsOf(Scene{}), "a refused file changed the scene");
    return;
  }
  readsBack(file, scene, fuzz::tomlOf(scene));
  readsBack(file, scene, sceneText(scene, std::filesystem::path(file.path()).parent_path()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
