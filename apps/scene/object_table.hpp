// SPDX-License-Identifier: Apache-2.0
// apps/scene/object_table.hpp: the objects of a scene as text: one table of keys for [[object]] and --object.
//
// In a scene file an object is a table: `[[object]]` with `kind = "sphere"`, `centre_mm = [0, 0, 30]`. On the command
// line it is one word, "sphere:centre=0,0,30:radius=5", with the same keys without their units. Any thread.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "apps/scene/object_spec.hpp"

namespace palpate {

// A member of ObjectSpec; screen unit * scale = its SI value.
struct ObjectVector {
  Vec3 ObjectSpec::*member;
  double scale = 1;
};
struct ObjectNumber {
  double ObjectSpec::*member;
  double scale = 1;
};
struct ObjectText {
  std::string ObjectSpec::*member;
};
using ObjectValue = std::variant<ObjectVector, ObjectNumber, ObjectText>;

struct ObjectOption {
  const char* key;   // "centre_mm"
  const char* word;  // "centre": the key in --object
  const char* unit;  // as on screens
  std::vector<ObjectKind> kinds;
  bool required = false;
  const char* help;
  ObjectValue value;
};

[[nodiscard]] std::span<const ObjectOption> objectOptions();
[[nodiscard]] const char* objectKindName(ObjectKind kind) noexcept;

// An object from its kind and its keys with their values as text, vectors as "x,y,z". `where`: the flag, or the file
// and line, for the message. Throws Error(kBadInput): an unknown kind; a key that the kind does not take (the message
// lists those that it takes), that is given twice or that is missing; a value of the wrong form; an invalid number or
// unit.
[[nodiscard]] ObjectSpec makeObjectSpec(const std::string& kind,
                                        const std::vector<std::pair<std::string, std::string>>& keys,
                                        const std::string& where);

// The same from one word: "box:centre=0,0,5:size=20,20,2". `file` comes last: its value may hold ':' and '='.
[[nodiscard]] ObjectSpec parseObject(const std::string& text);

// The word that parseObject() takes, with every key of the kind.
[[nodiscard]] std::string objectText(const ObjectSpec& spec);

// One line for --help, and the section of docs/scene.md.
[[nodiscard]] std::string objectHelp();
[[nodiscard]] std::string objectDocument();

}  // namespace palpate
