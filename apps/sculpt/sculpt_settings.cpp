// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/sculpt_settings.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/sculpt/gestures.hpp"
#include "base/atomic_file.hpp"
#include "base/json_text.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

// The number of `key`, where it has one within these limits.
template <typename Number>
void take(const Json& json, const char* key, double low, double high, double unit, Number& into) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return;
  const double value = found->get<double>();
  if (value >= low && value <= high) into = static_cast<Number>(value * unit);
}

constexpr double kMost_mm = BrushChoice::kMostRadius_m * kMillimetresPerMetre;

SculptSettings settingsOf(const Json& json) {
  SculptSettings settings;
  if (const auto dark = json.find("dark"); dark != json.end() && dark->is_boolean()) settings.dark = dark->get<bool>();
  take(json, "scale", 0, 4, 1, settings.scale);
  take(json, "width", SculptSettings::kLeastWidth, 16384, 1, settings.width);
  take(json, "height", SculptSettings::kLeastHeight, 16384, 1, settings.height);
  if (const auto brush = json.find("brush"); brush != json.end() && brush->is_string()) {
    for (const BrushEntry& entry : brushes()) {
      if (brush->get<std::string>() == entry.name) settings.brush.kind = entry.kind;
    }
  }
  take(json, "radius_mm", BrushChoice::kLeastRadius_m * kMillimetresPerMetre, kMost_mm, kMetresPerMillimetre,
       settings.brush.radius_m);
  take(json, "strength", 0.01, 1, 1, settings.brush.strength);
  take(json, "depth_mm", Gestures::kLeastDepth_m * kMillimetresPerMetre, Gestures::kMostDepth_m * kMillimetresPerMetre,
       kMetresPerMillimetre, settings.reach.depth_m);
  if (const auto recent = json.find("recent"); recent != json.end() && recent->is_array()) {
    for (const Json& name : *recent) {
      if (name.is_string() && settings.recent.size() < SculptSettings::kMostRecent)
        settings.recent.push_back(name.get<std::string>());
    }
  }
  return settings;
}

}  // namespace

void SculptSettings::opened(std::string volume) {  // which may be one of the list
  std::erase(recent, volume);
  recent.insert(recent.begin(), std::move(volume));
  if (recent.size() > kMostRecent) recent.resize(kMostRecent);
}

SculptSettings readSettings(const std::filesystem::path& file, std::string& trouble) {
  trouble.clear();
  std::ifstream stream(file);
  if (!stream) return {};
  const Json json = Json::parse(stream, nullptr, false);
  if (!json.is_object()) {
    trouble = fmt::format("{} is damaged: the settings are those of a first start", file.string());
    return {};
  }
  return settingsOf(json);
}

void writeSettings(const SculptSettings& settings, const std::filesystem::path& file) {
  std::error_code ignored;  // the file says what is wrong
  std::filesystem::create_directories(file.parent_path(), ignored);
  const Json json = {{"dark", settings.dark},
                     {"scale", settings.scale},
                     {"width", settings.width},
                     {"height", settings.height},
                     {"brush", brushEntry(settings.brush.kind).name},
                     {"radius_mm", settings.brush.radius_m * kMillimetresPerMetre},
                     {"strength", settings.brush.strength},
                     {"depth_mm", settings.reach.depth_m * kMillimetresPerMetre},
                     {"recent", settings.recent}};
  writeFileAtomically(file, jsonFileText(json));
}

}  // namespace palpate
