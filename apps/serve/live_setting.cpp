// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_setting.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {
namespace {

constexpr std::string_view kLiveKeys[] = {"isovalue",
                                          "servo.algorithm",
                                          "servo.n",
                                          "servo.stiffness_N_per_m",
                                          "servo.damping_Ns_per_m",
                                          "safety.force_limit_N"};
constexpr std::string_view kLiveTables[] = {"contact.", "haptization."};

const SceneOption& optionOf(const std::string& key) {
  if (const SceneOption* const option = optionOfKey(key)) return *option;
  std::vector<std::string> keys;
  for (const SceneOption& option : sceneOptions()) keys.emplace_back(option.key);
  refuse(key, "no setting of a scene has this key", withDidYouMean(key, keys, "'palpate scene' lists them"));
}

}  // namespace

bool isLiveKey(const std::string& key) {
  return std::ranges::find(kLiveKeys, key) != std::end(kLiveKeys) ||
         std::ranges::any_of(kLiveTables, [&](std::string_view table) { return key.starts_with(table); });
}

std::vector<std::string> liveKeys() {
  std::vector<std::string> keys;
  for (const SceneOption& option : sceneOptions())
    if (isLiveKey(option.key)) keys.emplace_back(option.key);
  return keys;
}

Scene withLiveSetting(const Scene& scene, const std::string& key, const std::string& value) {
  const SceneOption& option = optionOf(key);
  if (!isLiveKey(key)) {
    refuse(key, "it cannot change while the scene is served",
           fmt::format("change it in the scene's file and start again; these can: {}", fmt::join(liveKeys(), ", ")));
  }
  Scene next = scene;
  setOption(option.value, value, key, next, option.unit);
  return next;
}

void checkLiveSettings(const Scene& scene, const Scene& next) {
  Scene checked = scene;
  for (const SceneOption& option : sceneOptions()) {
    const std::string text = optionText(option.value, next);
    if (isLiveKey(option.key) && !text.empty() && text != optionText(option.value, scene))
      setOption(option.value, text, option.key, checked, option.unit);
  }
}

Scene withLiveSettings(const Scene& scene, const Scene& wanted, std::vector<std::string>& others) {
  Scene next = scene;
  for (const SceneOption& option : sceneOptions()) {
    const std::string text = optionText(option.value, wanted);
    if (text == optionText(option.value, scene)) continue;
    if (!isLiveKey(option.key) || text.empty()) {
      others.emplace_back(option.key);
    } else {
      setOption(option.value, text, option.key, next, option.unit);
    }
  }
  return next;
}

std::string settingsText(const Scene& scene, std::span<const std::string> keys) {
  std::string text;
  const auto add = [&](const SceneOption& option) {
    text += fmt::format("{} = {}\n", option.key, optionText(option.value, scene));
  };
  for (const std::string& key : keys) add(optionOf(key));
  if (!keys.empty()) return text;
  for (const bool is_live : {true, false}) {
    text += is_live ? "# 'palpate ctl set' changes these:\n"
                    : "# these cannot change while the scene is served (filter: with 'palpate ctl filter'):\n";
    for (const SceneOption& option : sceneOptions())
      if (isLiveKey(option.key) == is_live) add(option);
  }
  return text;
}

}  // namespace palpate
