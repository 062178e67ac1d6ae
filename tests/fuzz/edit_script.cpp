// SPDX-License-Identifier: Apache-2.0
// Edit scripts. Reading a script as a file and line by line must give the same orders. From each order, for a script or
// for a tool, a text is made of all that was understood. Read again, that text must give the same command.
#include <fmt/format.h>

#include "apps/edit/script_reader.hpp"
#include "engine/edit/edit_keys.hpp"
#include "engine/journal/journal_format.hpp"
#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string placeOf(const Vec3& p_W) {
  return fmt::format("{:.17g},{:.17g},{:.17g}m", p_W.x(), p_W.y(), p_W.z());
}

const char* wordOf(EditKind kind) {
  for (const EditWord& word : editWords()) {
    if (word.kind == kind) return word.name;
  }
  fuzz::fail("a kind without a word");
}

// Whether the text of a key can be made from the command. `turn` cannot: many angles give the same rotation.
std::string valueOf(std::string_view key, const EditText& text) {
  const EditCommand& c = text.command;
  const bool dab = c.from_W == c.to_W;
  if (key == "at") return isStamp(c.kind) || dab ? placeOf(c.from_W) : "";
  if (key == "from") return dab ? "" : placeOf(c.from_W);
  if (key == "to") return dab ? "" : placeOf(c.to_W);
  if (key == "radius") return fmt::format("{:.17g}m", c.radius_m);
  if (key == "strength") return fmt::format("{:.17g}", c.strength);
  if (key == "falloff") return fmt::format("{:.17g}", c.falloff);
  if (key == "value") return fmt::format("{:.17g}", c.value);
  if (key == "density") return c.object ? fmt::format("{:.17g}", *c.object) : "";
  if (key == "soft") return c.material ? fmt::format("{:.17g}", c.material->low_density) : "";
  if (key == "hard") return c.material ? fmt::format("{:.17g}", c.material->high_density) : "";
  if (key == "drop") return c.material ? fmt::format("{:.17g}", c.material->drop) : "";
  if (key == "point") return placeOf(c.plane_W);
  if (key == "normal") return fmt::format("{:.17g},{:.17g},{:.17g}", c.normal_W.x(), c.normal_W.y(), c.normal_W.z());
  if (key == "mesh") return text.mesh_file;
  if (key == "unit")
    return text.metres_per_unit == 1      ? "m"
           : text.metres_per_unit == 1e-2 ? "cm"
           : text.metres_per_unit == 1e-3 ? "mm"
                                          : "in";
  if (key == "mirror") return text.mirror_axis ? std::string(1, "xyz"[*text.mirror_axis]) : "";
  if (key == "rate") return text.rate_per_Ns > 0 ? fmt::format("{:.17g}", text.rate_per_Ns) : "";
  return "";  // turn; and period, since seconds times 1000 is not exact
}

std::string textOf(const EditText& text, EditUse use) {
  if (text.verb != EditText::Verb::kEdit) return text.verb == EditText::Verb::kUndo ? "undo" : "redo";
  std::string words = wordOf(text.command.kind);
  for (const EditKey& key : editKeys()) {
    const std::string value = hasKey(key, text.command.kind, use) ? valueOf(key.name, text) : "";
    if (!value.empty()) words += fmt::format(":{}={}", key.name, value);
  }
  return words;
}

// The command as a journal's bytes, without its rotation. Equal bytes mean equal commands.
std::string bytesOf(EditCommand command) {
  command.R_WS.setIdentity();
  const std::uint32_t no_stamp = 0;
  return editContent({&command, 1}, {&no_stamp, 1});
}

void requireNumbers(const EditCommand& c) {
  const MaterialRate material = c.material.value_or(MaterialRate{});
  for (const Vec3& v :
       {c.from_W, c.to_W, c.plane_W, c.normal_W, Vec3(c.R_WS.rowwise().norm()), Vec3(c.radius_m, c.strength, c.falloff),
        Vec3(c.value, c.object.value_or(0), material.drop), Vec3(material.low_density, material.high_density, 0)})
    fuzz::require(v.allFinite(), "a number of the command is none");
  fuzz::require(c.strength > 0 && c.strength <= 1 && c.falloff >= 0 && c.falloff <= 1, "a share is none");
}

void checkText(std::string_view text, EditUse use) {
  EditText read;
  try {
    read = editText(text, use, "place");
  } catch (const Error& error) {
    return fuzz::requireMessage(error, "place");
  }
  requireNumbers(read.command);
  const std::string words = textOf(read, use);
  fuzz::mustAccept("its own words are refused: " + words, [&] {
    const EditText again = editText(words, use, "place");
    const bool same = again.verb == read.verb && bytesOf(again.command) == bytesOf(read.command) &&
                      again.mesh_file == read.mesh_file && again.metres_per_unit == read.metres_per_unit &&
                      again.mirror_axis == read.mirror_axis && again.rate_per_Ns == read.rate_per_Ns;
    fuzz::require(same, "it reads otherwise from " + words);
  });
}

// Reads the script in the simplest way, without buffers.
std::vector<std::string> placesIn(std::string_view script, const std::string& name) {
  std::vector<std::string> places;
  for (std::size_t number = 1; !script.empty(); ++number) {
    const std::size_t end = std::min(script.find('\n'), script.size());
    std::string_view line = script.substr(0, end);
    script.remove_prefix(std::min(end + 1, script.size()));
    const bool too_long = line.size() > kLongestLine;
    if (number == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    const std::string_view command = scriptCommand(line);
    if (!too_long && !command.empty()) {
      fuzz::require(scriptCommand(command) == command, "a command is not its own command");
      for (const EditUse use : {EditUse::kPlaced, EditUse::kTool}) checkText(command, use);
    }
    if (too_long || !command.empty()) places.push_back(fmt::format("{} line {}", name, number));
  }
  return places;
}

void check(const std::string& script) {
  static const fuzz::ScratchFile file("script.txt");
  file.write(script);
  const std::vector<std::string> places = placesIn(script, file.path());
  EditQueue queue(script.size() + 1);
  fuzz::mustAccept("a script cannot be read", [&] { ScriptReader(file.path()).giveTo(queue, [] { return false; }); });
  queue.close();
  std::size_t n = 0;
  while (const auto order = queue.pop()) {
    fuzz::require(n < places.size() && order->where.starts_with(places[n]),
                  "an order is from elsewhere: " + order->where);
    if (order->refusal) {
      fuzz::requireMessage(*order->refusal, places[n]);
      fuzz::verdict = fuzz::Verdict::kRefused;
    }
    ++n;
  }
  fuzz::require(n == places.size(), "orders are lost");
  if (n > 0 && fuzz::verdict == fuzz::Verdict::kNone) fuzz::verdict = fuzz::Verdict::kAccepted;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
