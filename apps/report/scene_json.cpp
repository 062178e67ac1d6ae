// SPDX-License-Identifier: Apache-2.0
#include "apps/report/scene_json.hpp"

#include <algorithm>
#include <string>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

// From the text that the command line takes for the value, which is empty where none is set.
struct ToJson {
  std::string text;

  Json operator()(const NumberOption&) const { return orNull(numberOf(text)); }
  Json operator()(const IntegerOption&) const { return std::stoll(text); }
  Json operator()(const BytesOption&) const { return text.empty() ? Json(nullptr) : Json(text); }
  Json operator()(const VectorOption&) const {
    const std::optional<Vec3> vector = vectorOf(text);
    return vector ? Json{vector->x(), vector->y(), vector->z()} : Json(nullptr);
  }
  // "a:b,c:d" is [[a,b],[c,d]].
  Json operator()(const TableOption&) const {
    if (text.empty()) return nullptr;
    std::string rows;
    for (const char c : text) rows += c == ',' ? "],[" : std::string(1, c == ':' ? ',' : c);
    return Json::parse("[[" + rows + "]]");
  }
  template <class Words>
  Json operator()(const Words&) const {
    return text;
  }

 private:
  static Json orNull(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }
};

}  // namespace

nlohmann::ordered_json sceneJson(const Scene& scene) {
  Json json;
  for (const SceneOption& option : sceneOptions()) {
    std::string place = std::string("/") + option.key;
    std::replace(place.begin(), place.end(), '.', '/');
    json[Json::json_pointer(place)] = std::visit(ToJson{optionText(option.value, scene)}, option.value);
  }
  json["objects"] = Json::array();
  for (const ObjectSpec& object : scene.objects) json["objects"].push_back(objectText(object));
  return json;
}

}  // namespace palpate
