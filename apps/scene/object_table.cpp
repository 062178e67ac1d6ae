// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/object_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/scene/option_value.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr std::pair<ObjectKind, const char*> kKinds[] = {{ObjectKind::kPlane, "plane"},
                                                         {ObjectKind::kSphere, "sphere"},
                                                         {ObjectKind::kBox, "box"},
                                                         {ObjectKind::kMesh, "mesh"}};

// clang-format off
const std::vector<ObjectOption> kObjectOptions = {
    {"point_mm", "point", "mm", {ObjectKind::kPlane}, false, "a point of the plane", ObjectVector{&ObjectSpec::position_W, kMetresPerMillimetre}},
    {"normal", "normal", "", {ObjectKind::kPlane}, true, "out of the half-space that is object; any length", ObjectVector{&ObjectSpec::normal_W, 1}},
    {"centre_mm", "centre", "mm", {ObjectKind::kSphere, ObjectKind::kBox}, false, "the centre", ObjectVector{&ObjectSpec::position_W, kMetresPerMillimetre}},
    {"radius_mm", "radius", "mm", {ObjectKind::kSphere}, true, "the radius", ObjectNumber{&ObjectSpec::radius_m, kMetresPerMillimetre}},
    {"size_mm", "size", "mm", {ObjectKind::kBox}, true, "lengths of the edges", ObjectVector{&ObjectSpec::size_m, kMetresPerMillimetre}},
    {"position_mm", "position", "mm", {ObjectKind::kMesh}, false, "where the file's origin comes to lie", ObjectVector{&ObjectSpec::position_W, kMetresPerMillimetre}},
    {"rotation_deg", "rotation", "degree", {ObjectKind::kBox, ObjectKind::kMesh}, false, "turns about the world's x axis, then its y axis, then its z axis, around centre or origin", ObjectVector{&ObjectSpec::rotation_deg, 1}},
    {"scale", "scale", "", {ObjectKind::kMesh}, false, "factor besides the unit", ObjectNumber{&ObjectSpec::scale, 1}},
    {"unit", "unit", "", {ObjectKind::kMesh}, false, "of the file's coordinates: mm, cm, m or in", ObjectText{&ObjectSpec::unit}},
    {"file", "file", "", {ObjectKind::kMesh}, true, "OBJ, STL or PLY; in --object the last key", ObjectText{&ObjectSpec::file}},
};
// clang-format on

bool has(const ObjectOption& option, ObjectKind kind) {
  return std::find(option.kinds.begin(), option.kinds.end(), kind) != option.kinds.end();
}

// The name of a key for the user: `key` in a scene file, `word` in --object.
using ObjectName = const char* ObjectOption::*;

std::vector<std::string> namesOf(ObjectKind kind, ObjectName name) {
  std::vector<std::string> names;
  for (const ObjectOption& option : kObjectOptions) {
    if (has(option, kind)) names.emplace_back(option.*name);
  }
  return names;
}

ObjectKind kindOf(const std::string& name, const std::string& where) {
  std::vector<std::string> kinds;
  for (const auto& [kind, known] : kKinds) {
    if (name == known) return kind;
    kinds.emplace_back(known);
  }
  refuse(where, fmt::format("there is no object of kind '{}'", name),
         withDidYouMean(name, kinds, "use plane, sphere, box or mesh"));
}

struct ObjectForm {
  const char* operator()(const ObjectVector&) const { return "x,y,z"; }
  const char* operator()(const ObjectNumber&) const { return "a number"; }
  const char* operator()(const ObjectText&) const { return "text"; }
};

struct ObjectSetter {
  const std::string& text;
  ObjectSpec& spec;

  bool operator()(const ObjectVector& value) const {
    const auto vector = vectorOf(text);
    if (vector) spec.*value.member = *vector * value.scale;
    return vector.has_value();
  }
  bool operator()(const ObjectNumber& value) const {
    const auto number = numberOf(text);
    if (number) spec.*value.member = *number * value.scale;
    return number && std::isfinite(*number);
  }
  bool operator()(const ObjectText& value) const {
    spec.*value.member = text;
    return !text.empty();
  }
};

struct ObjectWriter {
  const ObjectSpec& spec;

  std::string operator()(const ObjectVector& value) const { return screenText(spec.*value.member, value.scale); }
  std::string operator()(const ObjectNumber& value) const { return screenText(spec.*value.member, value.scale); }
  std::string operator()(const ObjectText& value) const { return spec.*value.member; }
};

void checkSpec(const ObjectSpec& spec, const std::string& where) {
  const bool is_mesh = spec.kind == ObjectKind::kMesh;
  if (spec.kind == ObjectKind::kPlane && spec.normal_W.isZero(0))
    refuse(where, "the normal is zero", "give a direction");
  if (!(spec.radius_m > 0)) refuse(where, "the radius is not positive", "give a radius above 0 mm");
  if (!(spec.size_m.minCoeff() > 0)) refuse(where, "an edge is not positive", "give three sizes above 0 mm");
  if (is_mesh && !(spec.scale > 0)) refuse(where, "the scale is not positive", "give a scale above 0");
  if (is_mesh && spec.unit != "mm" && spec.unit != "cm" && spec.unit != "m" && spec.unit != "in") {
    refuse(where, fmt::format("the unit '{}' is not known", spec.unit), "use mm, cm, m or in");
  }
}

ObjectSpec specOf(const std::string& kind, const std::vector<std::pair<std::string, std::string>>& keys,
                  const std::string& where, ObjectName shown) {
  ObjectSpec spec;
  spec.kind = kindOf(kind, where);
  std::vector<const ObjectOption*> given;
  for (const auto& [name, text] : keys) {
    const auto known = [&, key = name](const ObjectOption& option) {
      return has(option, spec.kind) && (key == option.key || key == option.word);
    };
    const auto option = std::find_if(kObjectOptions.begin(), kObjectOptions.end(), known);
    if (option == kObjectOptions.end()) {
      const std::vector<std::string> names = namesOf(spec.kind, shown);
      refuse(where, fmt::format("a {} has no '{}'", kind, name),
             withDidYouMean(name, names, fmt::format("it takes {}", fmt::join(names, ", "))));
    }
    if (std::find(given.begin(), given.end(), &*option) != given.end()) {
      refuse(where, fmt::format("'{}' is given twice", name), "give it once");
    }
    given.push_back(&*option);
    if (!std::visit(ObjectSetter{text, spec}, option->value)) {
      refuse(where, fmt::format("{} '{}' is not what it takes", name, text),
             fmt::format("give {}", std::visit(ObjectForm{}, option->value)));
    }
  }
  for (const ObjectOption& option : kObjectOptions) {
    if (!option.required || !has(option, spec.kind)) continue;
    if (std::find(given.begin(), given.end(), &option) == given.end()) {
      refuse(where, fmt::format("a {} needs '{}'", kind, option.*shown),
             fmt::format("give {}", std::visit(ObjectForm{}, option.value)));
    }
  }
  checkSpec(spec, where);
  return spec;
}

}  // namespace

std::span<const ObjectOption> objectOptions() {
  return kObjectOptions;
}

const char* objectKindName(ObjectKind kind) noexcept {
  const auto* found =
      std::find_if(std::begin(kKinds), std::end(kKinds), [&](const auto& k) { return k.first == kind; });
  return found->second;
}

ObjectSpec makeObjectSpec(const std::string& kind, const std::vector<std::pair<std::string, std::string>>& keys,
                          const std::string& where) {
  return specOf(kind, keys, where, &ObjectOption::key);
}

ObjectSpec parseObject(const std::string& text) {
  const std::string where = fmt::format("--object '{}'", text);
  std::vector<std::pair<std::string, std::string>> keys;
  std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  while (colon != std::string::npos) {
    const std::size_t begin = colon + 1;
    const std::size_t equals = text.find('=', begin);
    const std::string name = text.substr(begin, equals == std::string::npos ? equals : equals - begin);
    colon = name == "file" ? std::string::npos : text.find(':', begin);
    if (equals == std::string::npos || equals > colon) {
      refuse(where,
             fmt::format("'{}' has no value", text.substr(begin, colon == std::string::npos ? colon : colon - begin)),
             "write KIND:key=value:key=value, for example sphere:centre=0,0,30:radius=5");
    }
    keys.emplace_back(name, text.substr(equals + 1, colon == std::string::npos ? colon : colon - equals - 1));
  }
  return specOf(kind, keys, where, &ObjectOption::word);
}

std::string objectText(const ObjectSpec& spec) {
  std::string text = objectKindName(spec.kind);
  for (const ObjectOption& option : kObjectOptions) {
    if (has(option, spec.kind))
      text += fmt::format(":{}={}", option.word, std::visit(ObjectWriter{spec}, option.value));
  }
  return text;
}

std::string objectHelp() {
  return "an object beside the volume, as often as wanted: "
         "plane:point=x,y,z:normal=x,y,z, "
         "sphere:centre=x,y,z:radius=r, "
         "box:centre=x,y,z:size=x,y,z:rotation=x,y,z "
         "or mesh:position=x,y,z:rotation=x,y,z:scale=s:unit=mm:file=NAME "
         "[mm, degree] (added to those of the scene file; table [[object]])";
}

std::string objectDocument() {
  std::string text =
      R"(
## Objects

Each `[[object]]` is a solid beside the volume that the tool touches as well; the VHIP stays outside of all of them. `kind` is
plane, sphere, box or mesh. The flag `--object` takes the same as one word, with the keys without their units:
`--object sphere:centre=0,0,30:radius=5`; it may be repeated and adds to the file's objects. A relative `file` starts at the
scene's folder. A mesh is scaled, turned, then moved. A mesh that is not closed is touched from both sides.

| key | `--object` | kind | unit | takes | default | meaning |
|---|---|---|---|---|---|---|
)";
  for (const ObjectOption& option : kObjectOptions) {
    std::string kinds;
    for (const ObjectKind kind : option.kinds) kinds += (kinds.empty() ? "" : ", ") + std::string(objectKindName(kind));
    const std::string standard =
        option.required ? "must be given" : std::visit(ObjectWriter{ObjectSpec{}}, option.value);
    text += fmt::format("| `{}` | `{}` | {} | {} | {} | {} | {} |\n", option.key, option.word, kinds, option.unit,
                        std::visit(ObjectForm{}, option.value), standard, option.help);
  }
  return text;
}

}  // namespace palpate
