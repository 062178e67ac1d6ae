// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/kept_settings.hpp"

#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/scene/option_table.hpp"
#include "apps/serve/live_setting.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"

namespace palpate {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 20U;
constexpr const char* kIsovalue = "isovalue";
constexpr const char* kFilter = "filter";  // may change, too, but with a new engine

// Of the keys that may be kept.
std::vector<std::string> keys() {
  std::vector<std::string> all = liveKeys();
  all.emplace_back(kFilter);
  return all;
}

std::string textOf(const Scene& scene, const std::string& key) {
  return optionText(optionOfKey(key)->value, scene);
}

// Null: it is no table.
const TableOption* tableOf(const std::string& key) {
  return std::get_if<TableOption>(&optionOfKey(key)->value);
}

void setIn(Scene& scene, const std::string& key, const std::string& text) {
  if (key == kFilter && text.empty()) return scene.filter.clear();
  // A window can clear a table; the text of a flag cannot.
  if (const TableOption* const table = tableOf(key); table != nullptr && text.empty())
    return (scene.*table->member).clear();
  const SceneOption& option = *optionOfKey(key);
  setOption(option.value, text, key, scene, option.unit);
}

// A file's name may have any bytes.
std::string inUtf8(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}
std::string inUtf8(const std::string& text) {
  return nlohmann::json::parse(inUtf8(nlohmann::json(text))).get<std::string>();
}

}  // namespace

KeptSettings::KeptSettings(std::filesystem::path file, const Scene& scene, Tell tell)
    : file_(std::move(file)),
      volume_(inUtf8(scene.volume)),
      tell_(std::move(tell)),
      users_(scene),
      taken_(scene),
      writer_("settings") {
  std::error_code ignored;
  if (file_.empty() || !std::filesystem::exists(file_, ignored)) return;
  try {
    take(wholeFile(file_, "the settings", kMostBytes));
  } catch (const std::exception& error) {
    takeNone(error.what());
  }
}

void KeptSettings::takeNone(const std::string& why) {
  kept_.clear();
  taken_ = users_;
  file_differs_ = true;
  tell_(fmt::format("settings from before are not taken: {}", why));
}

void KeptSettings::check(const std::function<void(const Scene&)>& fits) {
  if (kept_.empty()) return;
  try {
    fits(taken_);
  } catch (const Error& error) {
    takeNone(error.what());
  }
}

void KeptSettings::take(const std::string& text) {
  const nlohmann::json file = nlohmann::json::parse(text);
  const auto volume = file.at("volume").get<std::string>();
  if (volume != volume_) return takeNone(fmt::format("they are of {}", volume));
  const nlohmann::json& all = file.at("settings");
  std::vector<std::string> overtaken;
  for (const std::string& key : keys()) {
    if (!all.contains(key)) continue;
    const Setting one{all.at(key).at("scene").get<std::string>(), all.at(key).at("set").get<std::string>()};
    if (one.in_scene != textOf(users_, key)) {
      overtaken.push_back(key);
      continue;
    }
    setIn(taken_, key, one.set);
    kept_[key] = one;
  }
  overtaken_ = fmt::to_string(fmt::join(overtaken, ", "));
  file_differs_ = !overtaken.empty();
}

void KeptSettings::begin(const Scene& served) {
  at_start_ = served;
  std::vector<std::string> taken, left_out;
  for (const auto& [key, one] : kept_) {
    const bool is_taken = textOf(served, key) == one.set;
    if (is_taken) told_.insert(key);
    (is_taken ? taken : left_out).push_back(fmt::format("{} = {}", key, one.set));
  }
  if (!taken.empty()) tell_(fmt::format("settings from before are taken again: {}", fmt::join(taken, ", ")));
  if (!left_out.empty())
    tell_(fmt::format("settings from before are not taken, as they cannot be here: {}", fmt::join(left_out, ", ")));
  if (!overtaken_.empty())
    tell_(fmt::format("settings from before are not taken, as the scene has changed: {}", overtaken_));
}

void KeptSettings::reread(const Scene& wanted) {
  std::vector<std::string> others;  // with the next start, which then sees that the scene has changed
  users_ = withLiveSettings(users_, wanted, others);
  at_start_ = withLiveSettings(at_start_, wanted, others);
}

KeptSettings::Settings KeptSettings::changed(const Scene& served, bool isovalue_is_felt) const {
  Settings settings;
  for (const std::string& key : keys()) {
    if (key == kIsovalue && !isovalue_is_felt) {
      if (const auto before = kept_.find(key); before != kept_.end()) settings.insert(*before);
      continue;
    }
    const std::string now = textOf(served, key), in_scene = textOf(users_, key);
    const bool is_told = now != textOf(at_start_, key) || told_.contains(key);
    const bool can_be_said = !now.empty() || key == kFilter || tableOf(key) != nullptr;
    if (is_told && can_be_said && now != in_scene) settings[key] = {in_scene, now};
  }
  return settings;
}

void KeptSettings::look(const Scene& served, std::int64_t now_ns, bool isovalue_is_felt) {
  looked_at_ns_ = now_ns;
  if (file_.empty() || !writer_.idle()) return;
  Settings settings = changed(served, isovalue_is_felt);
  if (settings == kept_ && !file_differs_.exchange(false)) return;
  kept_ = std::move(settings);
  writer_.add([this, settings = kept_] { write(settings); });
}

void KeptSettings::write(const Settings& settings) {
  nlohmann::json all = nlohmann::json::object();
  for (const auto& [key, one] : settings) all[key] = {{"scene", one.in_scene}, {"set", one.set}};
  const nlohmann::json file = {{"volume", volume_}, {"settings", all}};
  try {
    writeFileAtomically(file_, inUtf8(file) + "\n");
  } catch (const std::exception& error) {
    file_differs_ = true;
    if (!std::exchange(was_told_, true)) tell_(fmt::format("what is set would not outlive a crash: {}", error.what()));
  }
}

void KeptSettings::forget() {
  writer_.finish();
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

}  // namespace palpate
