// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/brush_choice.hpp"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "engine/edit/brush_profile.hpp"

namespace palpate {
namespace brush_choice_test {

TEST(BrushChoice, EveryBrushHasItsEditItsInverseAndItsWords) {
  const std::map<BrushKind, std::pair<EditKind, EditKind>> edits = {
      {BrushKind::kDrill, {EditKind::kRemove, EditKind::kAdd}},
      {BrushKind::kAdd, {EditKind::kAdd, EditKind::kRemove}},
      {BrushKind::kSmooth, {EditKind::kSmooth, EditKind::kSmooth}},
      {BrushKind::kInflate, {EditKind::kInflate, EditKind::kDeflate}},
      {BrushKind::kFlatten, {EditKind::kFlatten, EditKind::kFlatten}}};
  EXPECT_EQ(brushes().size(), edits.size());
  for (const BrushEntry& entry : brushes()) {
    const BrushChoice choice{.kind = entry.kind};
    EXPECT_EQ(toolBrush(choice, {}).brush.kind, edits.at(entry.kind).first) << entry.name;
    EXPECT_EQ(toolBrush(choice, {.inverts = true}).brush.kind, edits.at(entry.kind).second) << entry.name;
    EXPECT_EQ(toolBrush(choice, {.smooths = true}).brush.kind, EditKind::kSmooth);
    EXPECT_EQ(toolBrush(choice, {.inverts = true, .smooths = true}).brush.kind, EditKind::kSmooth);
    EXPECT_EQ(std::string(entry.inverse).empty(), edits.at(entry.kind).first == edits.at(entry.kind).second);
    EXPECT_STREQ(brushEntry(entry.kind).name, entry.name);
    EXPECT_GT(std::string(entry.help).size(), 10U);
  }
}

// Voxels of 2 mm: a radius of 0.9 mm is below half of one. Each brush that comes to rest is told of once.
TEST(BrushAdvice, IsTheWarningOfABrushTooSmallForTheVoxels) {
  const Lattice lattice{Vec3::Zero(), Mat3::Identity(), Vec3::Constant(2e-3)};
  BrushAdvice advice;
  BrushChoice choice{.radius_m = 5.5e-3};
  EXPECT_EQ(advice.take(choice, lattice, true), "");
  choice.radius_m = 0.9e-3;
  EXPECT_EQ(advice.take(choice, lattice, false), "");  // still dragged
  const std::string words = advice.take(choice, lattice, true);
  EXPECT_EQ(words, "Drill: " + fineBrushWarning(toolBrush(choice, {}).brush, lattice, Strokes::kMany));
  EXPECT_NE(words.find("its radius of 0.9 mm is below half a voxel"), std::string::npos) << words;
  EXPECT_EQ(advice.take(choice, lattice, true), "");
  choice.strength = 1;
  EXPECT_EQ(advice.take(choice, lattice, true), "");  // no other size
  for (const BrushKind kind : {BrushKind::kAdd, BrushKind::kSmooth, BrushKind::kInflate, BrushKind::kFlatten}) {
    choice.kind = kind;
    EXPECT_TRUE(advice.take(choice, lattice, true).starts_with(brushEntry(kind).name));
  }
  choice.kind = BrushKind::kAdd;
  choice.radius_m = 4e-3;  // 2 voxels, within which less than half is added
  EXPECT_NE(advice.take(choice, lattice, true).find("of what is within, it adds some 4"), std::string::npos);
  choice.kind = BrushKind::kFlatten;
  choice.radius_m = 1.1e-3;  // flatten makes no surface of its own
  EXPECT_EQ(advice.take(choice, lattice, true), "");
  choice.radius_m = 0.9e-3;
  EXPECT_NE(advice.take(choice, lattice, true), "");  // anew
}

TEST(BrushChoice, HandsOnSizeStrengthAndMirror) {
  const BrushChoice choice{.radius_m = 2.5e-3, .strength = 0.25, .mirror_axis = 1};
  const ToolBrushSpec spec = toolBrush(choice, {});
  EXPECT_EQ(spec.brush.radius_m, 2.5e-3);
  EXPECT_EQ(spec.mirror_axis, 1);
  EXPECT_DOUBLE_EQ(spec.rate_per_Ns, 5);  // a quarter of the 20 that 0.05 s mean
  EXPECT_GT(spec.period_s, 0);
}

TEST(BrushChoice, StaysWithinItsLimits) {
  BrushChoice choice;
  for (int i = 0; i < 100; ++i) choice.scaleRadius(2);
  EXPECT_EQ(choice.radius_m, BrushChoice::kMostRadius_m);
  for (int i = 0; i < 100; ++i) choice.scaleRadius(0.5);
  EXPECT_EQ(choice.radius_m, BrushChoice::kLeastRadius_m);
  choice.addStrength(-7);
  EXPECT_EQ(choice.strength, 0.01);
  choice.addStrength(0.3);
  EXPECT_NEAR(choice.strength, 0.31, 1e-12);
  choice.addStrength(7);
  EXPECT_EQ(choice.strength, 1);
}

}  // namespace brush_choice_test
}  // namespace palpate
