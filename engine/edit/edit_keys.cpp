// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/edit_keys.hpp"

#include <array>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/vec.hpp"

namespace palpate {
namespace {

constexpr double kLeast = 1e-6;  // of what must be above 0

template <typename... Kinds>
constexpr std::uint32_t bits(Kinds... kinds) {
  return (0U | ... | (1U << static_cast<unsigned>(kinds)));
}

constexpr std::uint32_t kStamps = bits(EditKind::kStampAdd, EditKind::kStampRemove);
constexpr std::uint32_t kPlanes = bits(EditKind::kFlatten, EditKind::kCut);
constexpr std::uint32_t kAll = (1U << kEditKinds) - 1;
constexpr std::uint32_t kBrushes = kAll & ~(kStamps | bits(EditKind::kCut));

MaterialRate& material(EditText& text) {
  if (!text.command.material) text.command.material.emplace();
  return *text.command.material;
}

template <typename Choices>
auto choiceOf(const EditValue& value, const Choices& choices, const char* what, const char* remedy) {
  for (const auto& [word, meaning] : choices) {
    if (value.text == word) return meaning;
  }
  throw Error(Error::Code::kBadInput, value.where, fmt::format("'{}' of {} is no {}", value.text, value.key, what),
              remedy);
}

double metresPerUnit(const EditValue& value) {
  constexpr std::array<std::pair<std::string_view, double>, 4> kUnits = {
      {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}, {"in", 25.4e-3}}};
  return choiceOf(value, kUnits, "unit", "use mm, cm, m or in");
}

int axisOf(const EditValue& value) {
  constexpr std::array<std::pair<std::string_view, int>, 3> kAxes = {{{"x", 0}, {"y", 1}, {"z", 2}}};
  return choiceOf(value, kAxes, "axis", "give mirror=x, y or z, an axis of the volume");
}

// clang-format off
constexpr auto kWords = std::to_array<EditWord>({
    {"remove", EditKind::kRemove, true, "clears the brush's ball or capsule: drills"},
    {"add", EditKind::kAdd, true, "fills it"},
    {"paint", EditKind::kPaint, true, "moves the densities in it towards `value`"},
    {"flatten", EditKind::kFlatten, true, "makes the surface in it a plane; a tool: the one that it touched when its contact began"},
    {"smooth", EditKind::kSmooth, true, "evens them out"},
    {"inflate", EditKind::kInflate, true, "moves the surface in it out"},
    {"deflate", EditKind::kDeflate, true, "and in"},
    {"cut", EditKind::kCut, false, "clears all that a plane's normal points to"},
    {"stamp-add", EditKind::kStampAdd, false, "fills a closed mesh"},
    {"stamp-remove", EditKind::kStampRemove, false, "clears it"},
});
static_assert(kWords.size() == kEditKinds);

const std::array<EditKey, 19> kKeys = {{
    {"at", "x,y,z [mm]", kBrushes | kStamps, true, false, "must be given, or `from` and `to`", "the brush's middle; where the mesh file's origin comes to lie", [](const EditValue& v, EditText& t) { t.command.from_W = t.command.to_W = v.place(); }},
    {"from", "x,y,z [mm]", kBrushes, true, false, "`at`", "one end of a stroke", [](const EditValue& v, EditText& t) { t.command.from_W = v.place(); }},
    {"to", "x,y,z [mm]", kBrushes, true, false, "`at`", "the other", [](const EditValue& v, EditText& t) { t.command.to_W = v.place(); }},
    {"radius", "a length [mm]", kBrushes, true, true, "must be given", "of the brush", [](const EditValue& v, EditText& t) { t.command.radius_m = v.length(); }},
    {"strength", "1e-6 to 1", kAll, true, true, "1", "share of the way to the full effect", [](const EditValue& v, EditText& t) { t.command.strength = v.number(kLeast, 1); }},
    {"falloff", "0 to 1", kBrushes, true, true, "0", "share of the radius over which the effect fades to nothing", [](const EditValue& v, EditText& t) { t.command.falloff = v.number(0, 1); }},
    {"value", "a density", bits(EditKind::kPaint), true, true, "0", "what is painted", [](const EditValue& v, EditText& t) { t.command.value = v.number(-kLargestDensity, kLargestDensity); }},
    {"density", "a density", bits(EditKind::kAdd, EditKind::kFlatten, EditKind::kStampAdd), true, true, "the mean above the isovalue", "of what is filled; above the isovalue", [](const EditValue& v, EditText& t) { t.command.object = v.number(-kLargestDensity, kLargestDensity); }},
    {"soft", "a density", bits(EditKind::kRemove), true, true, "0", "up to here material is removed at the full strength", [](const EditValue& v, EditText& t) { material(t).low_density = v.number(-kLargestDensity, kLargestDensity); }},
    {"hard", "a density", bits(EditKind::kRemove), true, true, "1", "from here on at 1 - `drop` of it", [](const EditValue& v, EditText& t) { material(t).high_density = v.number(-kLargestDensity, kLargestDensity); }},
    {"drop", "0 to 1", bits(EditKind::kRemove), true, true, "1", "share of the strength that hard material takes; without any of the three all is alike", [](const EditValue& v, EditText& t) { material(t).drop = v.number(0, 1); }},
    {"point", "x,y,z [mm]", kPlanes, true, false, "must be given; flatten: `from`, or `at`", "a point of the plane", [](const EditValue& v, EditText& t) { t.command.plane_W = v.place(); }},
    {"normal", "x,y,z", kPlanes, true, false, "must be given", "of the plane, out of what stays; any length but 0", [](const EditValue& v, EditText& t) { t.command.normal_W = v.numbers(); }},
    {"mesh", "a file", kStamps, true, false, "must be given", "OBJ, STL or PLY", [](const EditValue& v, EditText& t) { t.mesh_file = v.text; }},
    {"unit", "mm, cm, m or in", kStamps, true, false, "mm", "of the mesh file's coordinates", [](const EditValue& v, EditText& t) { t.metres_per_unit = metresPerUnit(v); }},
    {"turn", "x,y,z [degree]", kStamps, true, false, "0,0,0", "turns the mesh about the world's x axis, then its y axis, then its z axis, around its origin", [](const EditValue& v, EditText& t) { t.command.R_WS = rotationOf(v.numbers()); }},
    {"mirror", "x, y or z", kAll, true, true, "none", "does the same again on the other side of the volume's middle, across this axis of its lattice; one edit, one undo", [](const EditValue& v, EditText& t) { t.mirror_axis = axisOf(v); }},
    {"rate", "1/(N s)", kBrushes, false, true, "none", "the strength of a stroke is 1 - exp(-rate * force * time) of it", [](const EditValue& v, EditText& t) { t.rate_per_Ns = v.number(kLeast, 1e6); }},
    {"period", "0.1 to 1000 [ms]", kBrushes, false, true, "4", "between two edits of a tool", [](const EditValue& v, EditText& t) { t.period_s = v.number(0.1, 1000) * 1e-3; }},
}};
// clang-format on

std::string kindsInWords(std::uint32_t kinds) {
  if (kinds == kAll) return "all";
  if (kinds == kBrushes) return "all but cut and stamps";
  if (kinds == (kBrushes | kStamps)) return "all but cut";

  std::string words;
  for (const EditWord& word : kWords) {
    if ((kinds & bits(word.kind)) != 0) words += (words.empty() ? "" : ", ") + std::string(word.name);
  }
  return words;
}

}  // namespace

std::span<const EditWord> editWords() {
  return kWords;
}
std::span<const EditKey> editKeys() {
  return kKeys;
}

bool hasKey(const EditKey& key, EditKind kind, EditUse use) noexcept {
  return (key.kinds & bits(kind)) != 0 && (use == EditUse::kTool ? key.tool : key.placed);
}

std::string editTextTable() {
  std::string text = "| kind | what it does | a tool too |\n|---|---|---|\n";
  for (const EditWord& word : kWords)
    text += fmt::format("| `{}` | {} | {} |\n", word.name, word.help, word.tool ? "yes" : "no");
  text +=
      "| `undo` | takes back the last edit that lasts | no |\n| `redo` | does again what was undone last | no |\n\n";
  text += "| key | takes | kinds | if not given | meaning | where |\n|---|---|---|---|---|---|\n";
  for (const EditKey& key : kKeys) {
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", key.name, key.takes, kindsInWords(key.kinds),
                        key.default_text, key.help,
                        key.placed && key.tool ? "both"
                        : key.tool             ? "`touch --edit`"
                                               : "`palpate edit`");
  }
  return text;
}

}  // namespace palpate
