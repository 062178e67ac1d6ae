// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_file.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {
namespace {

using Words = std::vector<std::string>;

bool isIn(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// The word itself if it is known, else the known words near it.
Words knownOrNear(const std::string& word, const Words& known) {
  return isIn(known, word) ? Words{word} : nearestWords(word, known);
}

// A key in two parts, "servo" and "stiffness_N_per_m"; a key outside of all tables has the table "". People forget
// units, so it has a name without one too.
struct KeyParts {
  explicit KeyParts(const std::string& key)
      : table(key.substr(0, key.rfind('.') == std::string::npos ? 0 : key.rfind('.'))),
        name(table.empty() ? key : key.substr(table.size() + 1)),
        plain(name.substr(0, name.find('_'))) {}
  std::string table, name, plain;
};

// What may have been meant by a key that is not known: in its table, or that with the nearest name, the nearest names.
// Where there is none, the same name in any table.
Words nearestKeys(const std::string& key) {
  const KeyParts meant(key);
  Words tables, names, in_table, elsewhere;
  for (const SceneOption& option : sceneOptions()) tables.push_back(KeyParts(option.key).table);
  tables = knownOrNear(meant.table, tables);
  for (const SceneOption& option : sceneOptions()) {
    const KeyParts known(option.key);
    if (isIn(tables, known.table)) names.insert(names.end(), {known.name, known.plain});
  }
  names = knownOrNear(meant.name, names);
  for (const SceneOption& option : sceneOptions()) {
    const KeyParts known(option.key);
    if (isIn(tables, known.table) && (isIn(names, known.name) || isIn(names, known.plain)))
      in_table.emplace_back(option.key);
    if (meant.name == known.name || meant.name == known.plain) elsewhere.emplace_back(option.key);
  }
  return in_table.empty() ? elsewhere : in_table;
}

std::string numberText(const toml::node& node) {
  if (const auto* integer = node.as_integer()) return std::to_string(integer->get());
  return fmt::format("{:.17g}", node.as_floating_point()->get());
}

// A value of the kind that an option takes, as setOption() reads it; nothing for another kind: "5" is text, no number.
struct ValueText {
  const toml::node& node;
  using Text = std::optional<std::string>;

  Text operator()(const NumberOption&) const { return node.is_number() ? Text(numberText(node)) : Text(); }
  Text operator()(const IntegerOption&) const { return node.is_number() ? Text(numberText(node)) : Text(); }
  Text operator()(const BytesOption&) const { return (*this)(TextOption{}); }
  Text operator()(const TextOption&) const { return node.is_string() ? Text(node.as_string()->get()) : Text(); }
  Text operator()(const ListOption&) const {
    if (node.is_string()) return node.as_string()->get();
    const auto* array = node.as_array();
    if (array == nullptr) return std::nullopt;
    std::string text;
    for (const toml::node& element : *array) {
      if (!element.is_string()) return std::nullopt;
      text += (text.empty() ? "" : " ") + element.as_string()->get();
    }
    return text;
  }
  Text operator()(const WordOption&) const { return node.is_string() ? Text(node.as_string()->get()) : Text(); }
  Text operator()(const SwitchOption&) const {
    if (const auto* flag = node.as_boolean()) return flag->get() ? "on" : "off";
    return node.is_string() ? Text(node.as_string()->get()) : Text();
  }
  Text operator()(const VectorOption&) const {
    const auto* array = node.as_array();
    if (array == nullptr) return std::nullopt;
    std::string text;
    for (const toml::node& element : *array) {
      if (!element.is_number()) return std::nullopt;
      text += (text.empty() ? "" : ",") + numberText(element);
    }
    return text;
  }
  Text operator()(const TableOption&) const {
    const auto* rows = node.as_array();
    if (rows == nullptr) return std::nullopt;
    std::string text;
    for (const toml::node& row : *rows) {
      const auto* numbers = row.as_array();
      if (numbers == nullptr) return std::nullopt;
      text += text.empty() ? "" : ",";
      for (std::size_t i = 0; i < numbers->size(); ++i) {
        const toml::node& number = (*numbers)[i];
        if (!number.is_number()) return std::nullopt;
        text += (i == 0 ? "" : ":") + numberText(number);
      }
    }
    return text;
  }
};

// How to write a value that is an array in a scene file, if that differs from a flag's text.
std::string arrayForm(const OptionValue& value) {
  if (std::holds_alternative<VectorOption>(value)) return "[x, y, z]";
  if (std::holds_alternative<ListOption>(value)) return "[\"word\", ...]";
  const auto* table = std::get_if<TableOption>(&value);
  if (table == nullptr) return optionForm(value);
  std::string row;
  for (const char c : std::string_view(table->row)) row += c == ':' ? std::string(", ") : std::string(1, c);
  return fmt::format("[[{}], ...]", row);
}

std::string valueText(const toml::node& node, const OptionValue& value, const std::string& where) {
  if (const auto text = std::visit(ValueText{node}, value)) return *text;
  throw Error(Error::Code::kBadInput, where, "the value is of another kind than it takes", "give " + arrayForm(value));
}

// Whether a key of an object takes text; for an unknown key, whether it was given text.
bool takesText(const std::string& key, const toml::node& node) {
  if (key == "kind") return true;
  for (const ObjectOption& option : objectOptions()) {
    if (key == option.key || key == option.word) return std::holds_alternative<ObjectText>(option.value);
  }
  return node.is_string();
}

// One [[object]].
ObjectSpec objectOf(const toml::table& table, const std::string& file) {
  const std::string where = fmt::format("{}:{}: object", file, table.source().begin.line);
  std::string kind;
  std::vector<std::pair<std::string, std::string>> keys;
  for (const auto& [name, node] : table) {
    const std::string key(name.str());
    const ValueText reader{node};
    std::optional<std::string> text = reader(TextOption{});
    if (!text) text = reader(NumberOption{});
    if (!text) text = reader(VectorOption{});
    if (!text || takesText(key, node) != node.is_string()) {
      throw Error(Error::Code::kBadInput, where, fmt::format("'{}' is of another kind than it takes", key),
                  "give a number, [x, y, z] or text");
    }
    if (key == "kind") {
      kind = *text;
    } else {
      keys.emplace_back(key, *text);
    }
  }
  return makeObjectSpec(kind, keys, where);
}

void addObjects(const toml::node& node, const std::string& file, Scene& scene) {
  const auto* array = node.as_array();
  const bool tables =
      array != nullptr && std::all_of(array->begin(), array->end(), [](const toml::node& e) { return e.is_table(); });
  if (!tables) {
    throw Error(Error::Code::kBadInput, fmt::format("{}:{}: object", file, node.source().begin.line),
                "objects are a list of tables", "begin each with [[object]]");
  }
  for (const toml::node& element : *array) scene.objects.push_back(objectOf(*element.as_table(), file));
}

void setKeys(const toml::table& table, const std::string& prefix, const std::string& file, Scene& scene) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    if (key == "object") {
      addObjects(node, file, scene);
      continue;
    }
    if (const auto* inner = node.as_table()) {
      setKeys(*inner, key + ".", file, scene);
      continue;
    }
    const std::string where = fmt::format("{}:{}: {}", file, node.source().begin.line, key);
    const SceneOption* option = optionOfKey(key);
    if (option == nullptr) {
      const std::string question = didYouMean(nearestKeys(key));
      throw Error(Error::Code::kBadInput, where, "there is no such key",
                  question + (question.empty() ? "" : " ") + "'palpate scene' lists all");
    }
    setOption(option->value, valueText(node, option->value, where), where, scene, option->unit);
  }
}

// A path in the scene starts at the scene's folder; a phantom is no path.
void resolve(const std::filesystem::path& folder, std::string& name) {
  if (name.empty() || name.rfind("phantom:", 0) == 0) return;
  if (std::filesystem::path(name).is_relative()) name = (folder / name).lexically_normal().string();
}

}  // namespace

void readSceneFile(const std::filesystem::path& file, Scene& scene) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(status))  // opening one succeeds, and it reads as empty
    throw Error(Error::Code::kBadInput, file.string(), "it is a folder", "give a scene's file");
  if (std::filesystem::exists(status) &&
      !std::filesystem::is_regular_file(status))  // a pipe may be waited for for ever
    throw Error(Error::Code::kBadInput, file.string(), "it is no plain file",
                "write the scene to a file, and give that");
  std::ifstream stream(file);
  if (!stream) {
    throw Error(Error::Code::kNotFound, file.string(), "the scene file cannot be opened",
                "check the path and its permissions");
  }
  readSceneText(std::string(std::istreambuf_iterator<char>(stream), {}), file.string(), file.parent_path(), scene);
}

void readSceneText(std::string_view text, const std::string& file, const std::filesystem::path& folder, Scene& scene) {
  Scene read = scene;
  read.volume.clear();  // what is there afterwards is the file's
  read.path_file.clear();
  read.recording.clear();
  const std::size_t given_before = read.objects.size();
  try {
    setKeys(toml::parse(text, file), "", file, read);
  } catch (const toml::parse_error& error) {
    throw Error(Error::Code::kBadInput,
                fmt::format("{}:{}:{}", file, error.source().begin.line, error.source().begin.column),
                std::string(error.description()), "mend the TOML there");
  }
  resolve(folder, read.volume);
  resolve(folder, read.path_file);
  resolve(folder, read.recording);
  if (read.volume.empty()) read.volume = scene.volume;
  if (read.path_file.empty()) read.path_file = scene.path_file;
  if (read.recording.empty()) read.recording = scene.recording;
  for (std::size_t i = given_before; i < read.objects.size(); ++i) resolve(folder, read.objects[i].file);
  scene = read;
}

}  // namespace palpate
