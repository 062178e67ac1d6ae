// SPDX-License-Identifier: Apache-2.0
#include "scene_arguments.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"
#include "apps/scene/scene_command.hpp"
#include "apps/scene/scene_file.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/files/volume_name.hpp"
#include "scene_flag.hpp"

namespace palpate {
SceneArguments::SceneArguments(CLI::App& verb, Of of) : values_(sceneOptions().size()) {
  verb.add_option("source", source_, "volume (file, DICOM folder, 'phantom:NAME?size=64') or scene file (.toml)")
      ->type_name("VOLUME|SCENE.toml");
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const SceneOption& option = sceneOptions()[i];
    const bool has_flag = of == Of::kService || !isOfService(option);
    options_.push_back(has_flag ? addSceneFlag(verb, option, values_[i]) : nullptr);
  }
  verb.add_option("--object", objects_, objectHelp())
      ->type_name(" ")
      ->allow_extra_args(false)
      ->group(optionGroup(*optionOfKey("volume")));
}

namespace {

// A scene may name a file that everybody has to get for himself.
void checkVolumeIsThere(const std::string& volume, const std::string& scene_file) {
  if (volume.starts_with("phantom:")) return;
  std::error_code failure;
  if (std::filesystem::exists(parseVolumeName(volume).path, failure) || failure) return;
  throw Error(Error::Code::kNotFound, volume,
              fmt::format("there is no such file or folder, and {} names it", scene_file),
              "put it there; the scene's first lines may say where it comes from");
}

}  // namespace

Scene SceneArguments::scene() const {
  Scene scene;
  std::string of_file;  // the volume that a scene file names
  if (std::filesystem::path(source_).extension() == kSceneExtension) {
    readSceneFile(source_, scene);
    of_file = scene.volume;
  } else {
    scene.volume = source_;
  }
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const SceneOption& option = sceneOptions()[i];
    if (isGiven(i)) setOption(option.value, values_[i], option.flag, scene, option.unit);
  }
  for (const std::string& object : objects_) scene.objects.push_back(parseObject(object));
  if (scene.volume.empty()) {
    throw Error(Error::Code::kBadInput, source_.empty() ? "VOLUME" : source_, "no volume is given",
                "name a file, a DICOM folder or a phantom, for example 'phantom:sphere?size=64'");
  }
  if (scene.volume == of_file) checkVolumeIsThere(scene.volume, source_);
  if (!scene.series.empty()) scene.volume = withSeries(scene.volume, scene.series);
  if (!scene.nan.empty()) scene.volume = withNan(scene.volume, scene.nan);
  if (scene.resample) scene.volume = withResample(scene.volume);
  return scene;
}

void SceneArguments::checkNotRead(const Scene& scene, const std::string& output) const {
  if (output.empty()) return;
  checkNotInput(scene.volume, output);
  std::vector<std::string> inputs = {source_, scene.path_file, scene.recording};
  for (const ObjectSpec& object : scene.objects) inputs.push_back(object.file);
  for (const std::string& input : inputs) {
    if (input.empty() || !sameFile(input, output)) continue;
    refuse(output, "the scene is made of it, and it would be overwritten", "write to another file");
  }
}

std::vector<std::string> SceneArguments::givenFlags() const {
  std::vector<std::string> flags;
  for (std::size_t i = 0; i < options_.size(); ++i) {
    if (isGiven(i)) flags.emplace_back(sceneOptions()[i].flag);
  }
  return flags;
}

std::string nextFreeName(const std::string& name) {
  std::string stem = name;
  while (stem.size() > 1 && stem.back() == '/') stem.pop_back();
  long number = 1;
  if (const auto dash = stem.rfind('-'); dash != std::string::npos && dash + 1 < stem.size() &&
                                         stem.size() - dash < 8 &&
                                         stem.find_first_not_of("0123456789", dash + 1) == std::string::npos) {
    number = std::stol(stem.substr(dash + 1));
    stem.resize(dash);
  }
  std::error_code ignored;
  std::string next;
  do next = stem + "-" + std::to_string(++number);
  while (std::filesystem::exists(std::filesystem::symlink_status(next, ignored)));
  return next;
}

std::string SceneArguments::commandLine(const std::string& verb, const Scene& scene) const {
  std::string line = "palpate " + verb;
  if (!source_.empty()) line += " " + shellWord(source_);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const bool is_journal = optionOfKey("edit.journal") == &sceneOptions()[i];
    if (is_journal && !scene.journal.empty()) {
      line += " --journal " + shellWord(nextFreeName(scene.journal));
    } else if (isGiven(i)) {
      line += std::string(" ") + sceneOptions()[i].flag;
      if (!isBare(sceneOptions()[i].value)) line += " " + shellWord(values_[i]);
    }
  }
  for (const std::string& object : objects_) line += " --object " + shellWord(object);
  return line;
}

}  // namespace palpate
