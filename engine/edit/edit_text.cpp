// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/edit_text.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "engine/edit/edit_keys.hpp"

namespace palpate {
namespace {

class Parser {
 public:
  Parser(std::string_view text, EditUse use, const std::string& where) : rest_(text), use_(use), where_(where) {}

  EditText parse() {
    const std::string_view name = next();
    if (use_ == EditUse::kPlaced && (name == "undo" || name == "redo")) {
      if (!rest_.empty()) refuse(fmt::format("{} takes no keys", name), "leave them out");
      text_.verb = name == "undo" ? EditText::Verb::kUndo : EditText::Verb::kRedo;
      return text_;
    }
    kind(name);
    while (!rest_.empty()) key(next());
    check();
    return text_;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason, const std::string& remedy) const {
    throw Error(Error::Code::kBadInput, where_, reason, remedy);
  }

  // The next piece, up to a colon; that of a file's name, up to one with a key behind it.
  std::string_view next() {
    std::size_t end = std::min(rest_.find(':'), rest_.size());
    if (rest_.starts_with("mesh=")) {
      while (end < rest_.size() && !beginsWithKey(rest_.substr(end + 1)))
        end = std::min(rest_.find(':', end + 1), rest_.size());
    }
    const std::string_view piece = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return piece;
  }

  [[nodiscard]] bool beginsWithKey(std::string_view text) const {
    const std::string_view name = text.substr(0, text.find('='));
    return name.size() < text.size() &&
           std::ranges::any_of(editKeys(), [&](const EditKey& key) { return key.name == name && has(key); });
  }

  [[nodiscard]] bool has(const EditKey& key) const { return hasKey(key, text_.command.kind, use_); }
  [[nodiscard]] bool given(std::string_view name) const { return std::ranges::find(given_, name) != given_.end(); }

  void kind(std::string_view name) {
    std::vector<std::string> known;
    for (const EditWord& word : editWords()) {
      if (use_ == EditUse::kTool && !word.tool) continue;
      known.emplace_back(word.name);
      if (word.name != name) continue;
      text_.command.kind = word.kind;
      kind_ = word.name;
      return;
    }
    const bool tool = use_ == EditUse::kTool;
    if (tool && name == "cut") refuse("a plane is no brush of a tool", "use flatten, or remove to drill");
    if (tool && name.starts_with("stamp")) refuse("a stamp is no brush of a tool", "use add or remove");
    const std::string_view word = name.substr(0, name.find(' '));
    if (std::ranges::any_of(editWords(), [&](const EditWord& one) { return one.name == word; }) && word != name)
      refuse(fmt::format("there is a blank in '{}'", name), "join a kind and its keys by colons: remove:radius=2mm");
    const std::string remedy = fmt::format("use {}{}", fmt::join(known, ", "), tool ? "" : ", undo or redo");
    if (!tool) {
      known.emplace_back("undo");
      known.emplace_back("redo");
    }
    refuse(fmt::format("there is no {} '{}'", tool ? "brush" : "edit", name), withDidYouMean(name, known, remedy));
  }

  void key(std::string_view piece) {
    const std::size_t equals = piece.find('=');
    const std::string_view name = piece.substr(0, equals);
    std::vector<std::string> allowed;
    const EditKey* key = nullptr;
    bool elsewhere = false;
    for (const EditKey& candidate : editKeys()) {
      elsewhere = elsewhere || candidate.name == name;
      if (!has(candidate)) continue;
      if (candidate.name == name) key = &candidate;
      allowed.emplace_back(candidate.name);
    }
    if (key == nullptr) {
      refuse(elsewhere ? fmt::format("{} has no '{}'", kind_, name) : fmt::format("there is no '{}'", name),
             withDidYouMean(name, allowed, fmt::format("{} takes {}", kind_, fmt::join(allowed, ", "))));
    }
    if (equals == std::string_view::npos || equals + 1 == piece.size())
      refuse(fmt::format("'{}' has no value", name), fmt::format("give {}=, {}", name, key->takes));
    if (given(name)) refuse(fmt::format("'{}' is given twice", name), "give it once");
    given_.push_back(key->name);
    key->set({name, piece.substr(equals + 1), where_}, text_);
  }

  void need(std::string_view name, const char* remedy) const {
    if (!given(name)) refuse(fmt::format("it has no {}", name), remedy);
  }

  void check() {
    EditCommand& command = text_.command;
    const std::optional<MaterialRate>& material = command.material;
    if (material && !(material->low_density < material->high_density))
      refuse("soft material is not less dense than hard", "give soft below hard");
    if (isBrush(command.kind)) need("radius", "give for example radius=2mm");
    if (isStamp(command.kind)) need("mesh", "give mesh=FILE, an OBJ, STL or PLY file");
    if (use_ == EditUse::kTool) return;
    if (isBrush(command.kind)) place();
    if (isStamp(command.kind)) need("at", "give at=x,y,z in mm");
    if (!hasPlane(command.kind)) return;
    need("normal", "give normal=x,y,z, out of what stays");
    if (command.kind == EditKind::kCut) need("point", "give point=x,y,z in mm");
    if (!given("point")) command.plane_W = command.from_W;
    if (!(command.normal_W.norm() > 0)) refuse("its normal is zero", "give a direction: normal=0,0,1");
  }

  void place() const {
    const bool both_ends = given("from") && given("to");
    if (given("at") ? !given("from") && !given("to") : both_ends) return;
    refuse(given("at") ? "it has both a place and a stroke" : "it has no place",
           "give at=x,y,z, or from=x,y,z and to=x,y,z, in mm");
  }

  std::string_view rest_;
  EditUse use_;
  const std::string& where_;
  EditText text_;
  const char* kind_ = "";
  std::vector<std::string_view> given_;
};

}  // namespace

std::vector<EditCommand> withMirror(const EditCommand& command, std::optional<int> mirror_axis, const Vec3i& size,
                                    const Lattice& lattice) {
  if (!mirror_axis) return {command};
  const Vec3 middle_W = lattice.toWorld((size - Vec3i::Ones()).cast<double>() / 2);
  return {command, mirrored(command, middle_W, lattice.R_WL.col(*mirror_axis))};
}

EditText editText(std::string_view text, EditUse use, const std::string& where) {
  return Parser(text, use, where).parse();
}

std::string_view scriptCommand(std::string_view line) noexcept {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  for (std::size_t hash = line.find('#'); hash != std::string_view::npos; hash = line.find('#', hash + 1)) {
    if (hash != 0 && kBlanks.find(line[hash - 1]) == std::string_view::npos) continue;
    line = line.substr(0, hash);
    break;
  }
  const std::size_t first = line.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_last_not_of(kBlanks) + 1 - first);
}

}  // namespace palpate
