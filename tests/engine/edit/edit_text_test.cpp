// SPDX-License-Identifier: Apache-2.0
// Edits as text against the same commands made by hand; and every refusal.
#include "engine/edit/edit_text.hpp"

#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/vec.hpp"
#include "engine/edit/edit_keys.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace edit_text_test {

using ::testing::HasSubstr;

EditText parse(const std::string& text, EditUse use = EditUse::kPlaced) {
  return editText(text, use, "--do '" + text + "'");
}

// Places and lengths are a decimal number times 1e-3 or 1: the same product, so the same bits.
void expectSame(const EditCommand& a, const EditCommand& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.from_W, b.from_W);
  EXPECT_EQ(a.to_W, b.to_W);
  EXPECT_EQ(a.radius_m, b.radius_m);
  EXPECT_EQ(a.strength, b.strength);
  EXPECT_EQ(a.falloff, b.falloff);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.plane_W, b.plane_W);
  EXPECT_EQ(a.normal_W, b.normal_W);
  EXPECT_EQ(a.object, b.object);
  EXPECT_EQ(a.R_WS, b.R_WS);
  ASSERT_EQ(a.material.has_value(), b.material.has_value());
  if (!a.material) return;
  EXPECT_EQ(a.material->low_density, b.material->low_density);
  EXPECT_EQ(a.material->high_density, b.material->high_density);
  EXPECT_EQ(a.material->drop, b.material->drop);
}

EditCommand brush(EditKind kind) {
  EditCommand command;
  command.kind = kind;
  command.from_W = command.to_W = Vec3(10, -20, 30.5) * 1e-3;
  command.radius_m = 2 * 1e-3;
  return command;
}

TEST(EditText, EveryBrushIsTheCommandOfItsKind) {
  const std::pair<const char*, EditKind> kinds[] = {{"add", EditKind::kAdd},         {"remove", EditKind::kRemove},
                                                    {"paint", EditKind::kPaint},     {"smooth", EditKind::kSmooth},
                                                    {"inflate", EditKind::kInflate}, {"deflate", EditKind::kDeflate}};
  for (const auto& [word, kind] : kinds) {
    EditCommand command = brush(kind);
    expectSame(parse(std::string(word) + ":radius=2mm:at=10,-20,30.5").command, command);
    command.strength = 0.25;
    command.falloff = 0.5;
    expectSame(parse(std::string(word) + ":falloff=0.5:at=10,-20,30.5mm:strength=0.25:radius=2").command, command);
  }
}

TEST(EditText, KeysOfSingleKinds) {
  EditCommand paint = brush(EditKind::kPaint);
  paint.value = -12.5;
  expectSame(parse("paint:radius=2:at=10,-20,30.5:value=-12.5").command, paint);
  EditCommand add = brush(EditKind::kAdd);
  add.object = 900;
  expectSame(parse("add:radius=2:at=10,-20,30.5:density=900").command, add);
  EditCommand drill = brush(EditKind::kRemove);
  drill.material = MaterialRate{100, 900, 0.8};
  expectSame(parse("remove:radius=2:at=10,-20,30.5:soft=100:hard=900:drop=0.8").command, drill);
}

TEST(EditText, AStrokeHasTwoEnds) {
  EditCommand stroke = brush(EditKind::kRemove);
  stroke.to_W = Vec3(1, 2, 3) * 1e-2;
  expectSame(parse("remove:radius=2:from=10,-20,30.5:to=1,2,3cm").command, stroke);
}

TEST(EditText, PlanesOfFlattenAndCut) {
  EditCommand flatten = brush(EditKind::kFlatten);
  flatten.plane_W = flatten.from_W;
  flatten.normal_W = {0, 1, -2};
  expectSame(parse("flatten:radius=2:at=10,-20,30.5:normal=0,1,-2").command, flatten);
  flatten.plane_W = Vec3(1, 2, 3) * 1e-3;
  flatten.object = 50;
  expectSame(parse("flatten:radius=2:at=10,-20,30.5:point=1,2,3:normal=0,1,-2:density=50").command, flatten);
  EditCommand cut;
  cut.kind = EditKind::kCut;
  cut.plane_W = {1, 2, 3};
  cut.normal_W = {0, 0, 2};
  cut.strength = 0.5;
  expectSame(parse("cut:point=1,2,3m:normal=0,0,2:strength=0.5").command, cut);
}

TEST(EditText, StampsNameAMesh) {
  EditCommand stamp;
  stamp.kind = EditKind::kStampAdd;
  stamp.from_W = stamp.to_W = Vec3(1, 2, 3) * 1e-3;
  stamp.object = 900;
  stamp.R_WS = rotationOf({10, 20, 30});
  const EditText text = parse("stamp-add:mesh=a ball.stl:at=1,2,3:turn=10,20,30:density=900:unit=in");
  expectSame(text.command, stamp);
  EXPECT_EQ(text.mesh_file, "a ball.stl");
  EXPECT_EQ(text.metres_per_unit, 25.4e-3);
  EXPECT_FALSE(text.command.stamp);
  EXPECT_EQ(parse("stamp-remove:mesh=x.ply:at=0,0,0").command.kind, EditKind::kStampRemove);
  EXPECT_EQ(parse("stamp-remove:mesh=x.ply:at=0,0,0").metres_per_unit, 1e-3);
  // Colons in a name, up to one that has a key of the kind behind it.
  EXPECT_EQ(parse("stamp-remove:at=0,0,0:mesh=/a:b/c:radius=1:.stl").mesh_file, "/a:b/c:radius=1:.stl");
  EXPECT_EQ(parse("stamp-remove:mesh=a:b.stl:at=0,0,0").mesh_file, "a:b.stl");
}

TEST(EditText, MirrorNamesAnAxis) {
  EXPECT_FALSE(parse("remove:radius=2:at=0,0,0").mirror_axis);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(parse(std::string("remove:radius=2:at=0,0,0:mirror=") + "xyz"[axis]).mirror_axis, axis);
    EXPECT_EQ(parse(std::string("cut:point=0,0,0:normal=1,0,0:mirror=") + "xyz"[axis]).mirror_axis, axis);
  }
}

TEST(EditText, UnitsOfLengthsAndPlaces) {
  const std::tuple<const char*, const char*, double> cases[] = {{"500um", "1,2,3um", 1e-6},
                                                                {"500", "1,2,3", 1e-3},
                                                                {"500mm", "1,2,3mm", 1e-3},
                                                                {"500cm", "1,2,3cm", 1e-2},
                                                                {"500m", "1,2,3m", 1}};
  for (const auto& [radius, place, metres] : cases) {
    const EditCommand command = parse(fmt::format("add:radius={}:at={}", radius, place)).command;
    EXPECT_EQ(command.radius_m, 500 * metres);
    EXPECT_EQ(command.from_W, Vec3(1, 2, 3) * metres);
  }
}

TEST(EditText, UndoAndRedoAreWords) {
  EXPECT_EQ(parse("remove:radius=1:at=0,0,0").verb, EditText::Verb::kEdit);
  EXPECT_EQ(parse("undo").verb, EditText::Verb::kUndo);
  EXPECT_EQ(parse("redo").verb, EditText::Verb::kRedo);
}

// What the tool says itself, and what only a tool has.
TEST(EditText, AToolsBrushHasNoPlaceAndAPlacedEditNoRate) {
  const EditText text = parse("remove:radius=2mm:rate=3:period=8:strength=0.5", EditUse::kTool);
  EXPECT_EQ(text.rate_per_Ns, 3);
  EXPECT_EQ(text.period_s, 8 * 1e-3);
  EXPECT_EQ(text.command.radius_m, 2e-3);
  EXPECT_EQ(parse("flatten:radius=2mm:mirror=z", EditUse::kTool).mirror_axis, 2);
  for (const EditWord& word : editWords()) {
    if (word.tool) continue;
    EXPECT_THROW(static_cast<void>(parse(word.name, EditUse::kTool)), Error) << word.name;
  }
}

struct Refusal {
  const char* text;
  const char* reason;
  EditUse use = EditUse::kPlaced;
};

TEST(EditText, RefusesWithTextReasonAndRemedy) {
  const Refusal cases[] = {
      {"", "there is no edit ''; use remove, add"},
      {"carve:radius=2mm", "there is no edit 'carve'"},
      {"remove radius=2mm at=0,0,0",
       "there is a blank in 'remove radius=2mm at=0,0,0'; join a kind and its keys by colons"},
      {"Remove:radius=2mm", "there is no edit 'Remove'"},
      {"undo:3", "undo takes no keys"},
      {"remove:at=0,0,0", "it has no radius"},
      {"remove:radius=2mm", "it has no place; give at=x,y,z"},
      {"remove:radius=2mm:from=0,0,0", "it has no place"},
      {"remove:radius=2mm:at=0,0,0:to=1,1,1", "both a place and a stroke"},
      {"remove:radius=2mm:at=0,0,0:at=1,1,1", "'at' is given twice"},
      {"remove:radius", "'radius' has no value; give radius=, a length"},
      {"remove:radius=", "'radius' has no value"},
      {"remove:radius=0mm:at=0,0,0", "'0mm' of radius is no length above 0"},
      {"remove:radius=-2mm:at=0,0,0", "no length above 0"},
      {"remove:radius=nan:at=0,0,0", "'nan' of radius is no number"},
      {"remove:radius=inf:at=0,0,0", "is no number"},
      {"remove:radius=1e400:at=0,0,0", "is no number"},
      {"remove:radius=2miles:at=0,0,0", "'2miles' of radius is no length: there is no unit 'miles'; give a number"},
      {"remove:radius=2mm:at=0,0", "'0,0' of at is not three numbers"},
      {"remove:radius=2mm:at=0,0,0,0", "is no place"},
      {"remove:radius=2mm:at=0mm,0,0", "not three numbers"},
      {"remove:radius=2mm:at=0,nan,0", "is no number"},
      {"remove:radius=2mm:at=0,0,0miles", "'0,0,0miles' of at is no place: there is no unit 'miles'; give three"},
      {"remove:radius=2mm:strength=0:at=0,0,0", "strength is 0; give 1e-06 to 1"},
      {"remove:radius=2mm:strength=1.5:at=0,0,0", "strength is 1.5"},
      {"remove:radius=2mm:strength=nan:at=0,0,0", "is no number"},
      {"remove:radius=2mm:strength=1e300:at=0,0,0", "strength is 1e+300"},
      {"remove:radius=2mm:falloff=-0.1:at=0,0,0", "falloff is -0.1; give 0 to 1"},
      {"remove:radius=2mm:size=3", "there is no 'size'; remove takes at, from, to, radius"},
      {"remove:radius=2mm:value=3", "remove has no 'value'"},
      {"smooth:radius=2mm:density=3", "smooth has no 'density'"},
      {"add:radius=2mm:soft=3", "add has no 'soft'"},
      {"remove:radius=2mm:at=0,0,0:rate=3", "remove has no 'rate'"},
      {"remove:radius=2mm:soft=5:hard=4:at=0,0,0", "give soft below hard"},
      {"paint:radius=2mm:at=0,0,0:value=1e31", "value is 1e+31"},
      {"flatten:radius=2mm:at=0,0,0", "it has no normal"},
      {"flatten:at=0,0,0:normal=0,0,1", "it has no radius"},
      {"cut:normal=0,0,1", "it has no point"},
      {"cut:point=0,0,0", "it has no normal"},
      {"cut:point=0,0,0:normal=0,0,0", "its normal is zero"},
      {"cut:point=0,0,0:normal=0,0,1mm", "not three numbers"},
      {"cut:radius=3mm:point=0,0,0:normal=0,0,1", "cut has no 'radius'"},
      {"cut:at=0,0,0", "cut has no 'at'"},
      {"stamp-add:at=0,0,0", "it has no mesh; give mesh=FILE"},
      {"stamp-add:mesh=a.stl", "it has no at"},
      {"stamp-add:mesh=a.stl:at=0,0,0:unit=ft", "'ft' of unit is no unit; use mm"},
      {"stamp-add:mesh=a.stl:at=0,0,0:turn=90", "not three numbers"},
      {"stamp-remove:mesh=a.stl:at=0,0,0:density=3", "stamp-remove has no 'density'"},
      {"remove:radius=2mm:at=0,0,0:mirror=w", "'w' of mirror is no axis; give mirror=x, y or z"},
      {"undo", "there is no brush 'undo'", EditUse::kTool},
      {"cut:point=0,0,0", "a plane is no brush of a tool", EditUse::kTool},
      {"stamp-add:mesh=a.stl", "a stamp is no brush of a tool", EditUse::kTool},
      {"carve:radius=2", "there is no brush 'carve'; use remove, add, paint, flatten", EditUse::kTool},
      {"remove:radius=2mm:at=0,0,0", "remove has no 'at'", EditUse::kTool},
      {"remove:strength=1", "it has no radius", EditUse::kTool},
  };
  for (const Refusal& refusal : cases) {
    SCOPED_TRACE(refusal.text);
    try {
      static_cast<void>(parse(refusal.text, refusal.use));
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_THAT(error.what(), HasSubstr("--do '" + std::string(refusal.text) + "': "));
      EXPECT_THAT(error.what(), HasSubstr(refusal.reason));
      EXPECT_THAT(error.what(), ::testing::ContainsRegex("; .{8,}$"));
    }
  }
}

TEST(EditText, AKindOrAKeyWithATypoIsRecognised) {
  std::vector<std::string> placed = {"undo", "redo"}, brushes;
  for (const EditWord& word : editWords()) {
    placed.emplace_back(word.name);
    if (word.tool) brushes.emplace_back(word.name);
  }
  const auto suggested = [](const std::string& text, EditUse use) {
    return suggestedIn(refusalOf([&] { static_cast<void>(parse(text, use)); }));
  };
  forEachTypo(placed, [&](const std::string& kind, const std::string& typed) {
    EXPECT_THAT(suggested(typed + ":radius=2mm:at=0,0,0", EditUse::kPlaced), HasSubstr(kind)) << typed;
  });
  forEachTypo(brushes, [&](const std::string& kind, const std::string& typed) {
    EXPECT_THAT(suggested(typed + ":radius=2mm", EditUse::kTool), HasSubstr(kind)) << typed;
  });
  EXPECT_EQ(suggested("undoo", EditUse::kTool), "");  // a tool's brush undoes nothing
  EXPECT_EQ(suggested("remove:raduis=2mm:at=0,0,0", EditUse::kPlaced), "radius");
}

// By hand: 5 x 9 x 3 voxels of 1 x 2 x 3 mm have their middle at (2, 8, 3) mm along the axes, which a quarter about z
// turns to (-8, 2, 3): in the world (2, 2, 3) mm. The lattice's first axis is the world's y, its second the world's -x.
// Some ten roundings at 10 mm, 1e-18 m each.
TEST(EditText, AMirrorIsTheMiddleOfTheVolume) {
  Lattice lattice;
  lattice.origin_W = {10e-3, 0, 0};
  lattice.spacing_m = {1e-3, 2e-3, 3e-3};
  lattice.R_WL << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EditCommand command;
  command.from_W = command.to_W = {1e-3, 5e-3, 7e-3};
  EXPECT_EQ(withMirror(command, std::nullopt, {5, 9, 3}, lattice).size(), 1U);
  const Vec3 mirrors_W[] = {{1e-3, -1e-3, 7e-3}, {3e-3, 5e-3, 7e-3}, {1e-3, 5e-3, -1e-3}};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<EditCommand> both = withMirror(command, axis, {5, 9, 3}, lattice);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0].from_W, command.from_W);
    EXPECT_LE((both[1].from_W - mirrors_W[axis]).norm(), 1e-17) << both[1].from_W.transpose();
  }
}

TEST(EditText, LinesOfAScript) {
  const std::pair<const char*, const char*> cases[] = {{"", ""},
                                                       {"   \t\r", ""},
                                                       {"# a comment", ""},
                                                       {"  # one", ""},
                                                       {"undo", "undo"},
                                                       {"  undo  \r", "undo"},
                                                       {"undo # the last", "undo"},
                                                       {"undo\t# the last", "undo"},
                                                       {"stamp-add:mesh=a#b.stl", "stamp-add:mesh=a#b.stl"},
                                                       {"stamp-add:mesh=a#b.stl # x # y", "stamp-add:mesh=a#b.stl"}};
  for (const auto& [line, command] : cases) EXPECT_EQ(scriptCommand(line), command) << line;
}

// Any bytes give a command or an Error, nothing else.
TEST(EditText, SurvivesAnyBytes) {
  std::uint32_t state = 1;
  const auto next = [&](std::uint32_t bound) { return (state = state * 1664525U + 1013904223U) / 65536U % bound; };
  const std::string base = "stamp-add:mesh=a.stl:at=1,2,3mm:turn=1,2,3:mirror=x:strength=0.5:density=4";
  for (int i = 0; i < 20'000; ++i) {
    std::string text = base.substr(0, next(80));
    for (std::uint32_t change = next(4); change > 0 && !text.empty(); --change)
      text[next(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(next(256));
    try {
      static_cast<void>(parse(text));
    } catch (const Error&) {
    }
  }
}

TEST(EditText, TheDocumentHasTheTable) {
  std::ifstream in(PALPATE_DOCS "/edits.md");
  std::ostringstream document;
  document << in.rdbuf();
  EXPECT_THAT(document.str(), HasSubstr(editTextTable())) << "copy the output of `palpate edit --commands` there";
}

}  // namespace edit_text_test
}  // namespace palpate
