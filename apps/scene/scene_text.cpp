// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_text.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "base/outside_text.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// A basic string of TOML.
std::string quotedText(const std::string& text) {
  if (!isUtf8(text)) {
    refuse(fmt::format("'{}'", oneLine(text)), "it is not in UTF-8, and a scene's file holds no other text",
           "give the file or folder another name");
  }
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

// "a,b,c" is [a, b, c].
std::string listText(const std::string& numbers) {
  std::string list = "[";
  for (const char c : numbers) list += c == ',' ? std::string(", ") : std::string(1, c);
  return list + "]";
}

// "a:b,c:d" is [[a, b], [c, d]].
std::string rowsText(const std::string& rows) {
  std::string list = "[[";
  for (const char c : rows) list += c == ',' ? "], [" : c == ':' ? std::string(", ") : std::string(1, c);
  return list + "]]";
}

// A value from its text as the command line takes it.
struct ValueForm {
  const std::string& text;
  std::string operator()(const NumberOption&) const { return text; }
  std::string operator()(const IntegerOption&) const { return text; }
  std::string operator()(const VectorOption&) const { return listText(text); }
  std::string operator()(const TableOption&) const { return rowsText(text); }
  template <class Words>
  std::string operator()(const Words&) const {
    return quotedText(text);
  }
};

std::string seenFrom(const fs::path& folder, const std::string& name) {
  if (name.empty() || name.starts_with("phantom:") || fs::path(name).is_absolute()) return name;
  const fs::path here = fs::current_path();
  return (here / name).lexically_normal().lexically_proximate((here / folder).lexically_normal()).string();
}

struct ObjectTomlForm {
  const ObjectSpec& spec;
  std::string operator()(const ObjectVector& value) const {
    return listText(screenText(spec.*value.member, value.scale));
  }
  std::string operator()(const ObjectNumber& value) const { return screenText(spec.*value.member, value.scale); }
  std::string operator()(const ObjectText& value) const { return quotedText(spec.*value.member); }
};

std::string objectTable(const ObjectSpec& spec) {
  std::string text = fmt::format("\n[[object]]\nkind = {}\n", quotedText(objectKindName(spec.kind)));
  for (const ObjectOption& option : objectOptions()) {
    if (std::ranges::find(option.kinds, spec.kind) == option.kinds.end()) continue;
    text += fmt::format("{} = {}\n", option.key, std::visit(ObjectTomlForm{spec}, option.value));
  }
  return text;
}

// The lines of one table of the file; "" is what stands before all tables.
struct Lines {
  std::string table, text;
};

}  // namespace

std::string sceneText(const Scene& scene, const fs::path& folder, std::span<const std::string_view> always) {
  Scene seen = scene;
  seen.volume = seenFrom(folder, scene.volume);
  seen.path_file = seenFrom(folder, scene.path_file);
  seen.recording = seenFrom(folder, scene.recording);
  for (ObjectSpec& object : seen.objects) object.file = seenFrom(folder, object.file);
  std::vector<Lines> tables = {{}};
  for (const SceneOption& option : sceneOptions()) {
    const std::string_view key = option.key;
    const std::string value = optionText(option.value, seen);
    const bool usual = value == optionText(option.value, Scene{});
    if (usual && std::ranges::find(always, key) == always.end()) continue;
    const std::size_t dot = key.rfind('.');
    const std::string table(key.substr(0, dot == std::string_view::npos ? 0 : dot));
    auto lines = std::ranges::find(tables, table, &Lines::table);
    if (lines == tables.end()) lines = tables.insert(tables.end(), {table, ""});
    lines->text += fmt::format("{} = {}\n", key.substr(dot == std::string_view::npos ? 0 : dot + 1),
                               std::visit(ValueForm{value}, option.value));
  }
  std::string text;
  for (const Lines& lines : tables) {
    if (!lines.table.empty()) text += fmt::format("\n[{}]\n", lines.table);
    text += lines.text;
  }
  for (const ObjectSpec& object : seen.objects) text += objectTable(object);
  return text;
}

std::string tomlComment(std::string_view words) {
  std::string text = "# ";
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t bytes = characterBytes(words, at);
    const auto lead = static_cast<unsigned char>(words[at]);
    if (lead == '\n')
      text += "\n# ";
    else if (bytes == 0 || lead < 0x20 || lead == 0x7f)
      text += '?';
    else
      text += words.substr(at, bytes);
    at += std::max<std::size_t>(bytes, 1);
  }
  return text + "\n";
}

}  // namespace palpate
