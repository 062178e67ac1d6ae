// SPDX-License-Identifier: Apache-2.0
#include "scene_flag.hpp"

namespace palpate {

CLI::Option* addSceneFlag(CLI::App& verb, const SceneOption& option, std::string& value, const Scene& usual) {
  if (isBare(option.value)) value = std::get<SwitchOption>(option.value).word_if_true;
  CLI::Option* added = isBare(option.value) ? verb.add_flag_callback(
                                                  option.flag, [] {}, optionHelp(option, usual))
                                            : verb.add_option(option.flag, value, optionHelp(option, usual));
  return added->type_name(" ")->group(optionGroup(option));
}

SceneFlags::SceneFlags(CLI::App& verb, std::span<const char* const> keys, const Scene& usual) {
  for (const char* key : keys) flags_.push_back({optionOfKey(key), {}, nullptr});
  for (Flag& flag : flags_) flag.given = addSceneFlag(verb, *flag.option, flag.value, usual);
}

void SceneFlags::apply(Scene& scene) const {
  for (const Flag& flag : flags_) {
    if (flag.given->count() > 0) setOption(flag.option->value, flag.value, flag.option->flag, scene, flag.option->unit);
  }
}

std::vector<std::string> SceneFlags::given() const {
  std::vector<std::string> names;
  for (const Flag& flag : flags_) {
    if (flag.given->count() > 0) names.emplace_back(flag.option->flag);
  }
  return names;
}

}  // namespace palpate
