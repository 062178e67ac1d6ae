// SPDX-License-Identifier: Apache-2.0
#include "engine/session/tool_brush.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr double kStiffness = 500;

ToolPose poseAt(double x_m, bool in_contact, double depth_m = 1e-3) {
  ToolPose pose;
  pose.position_W = {x_m, 0, 0};
  pose.at_surface = in_contact;
  pose.surface_W = pose.position_W + Vec3(0, 0, in_contact ? depth_m : 0);
  return pose;
}

ToolBrush brush(const char* text) {
  return {toolBrushSpec(text), kStiffness, 8};
}

TEST(ToolBrush, StrokesShareTheirEndsAtAnySpeed) {
  for (const double speed : {0.01, 0.1, 1.0, 10.0}) {
    ToolBrush tool = brush("remove:radius=2mm");
    std::vector<EditCommand> strokes;
    for (int tick = 0; tick <= 100; ++tick) {
      if (auto stroke = tool.look(poseAt(speed * tick * 1e-3, true), tick * kTick_ns)) strokes.push_back(*stroke);
    }
    ASSERT_GE(strokes.size(), 8U);
    EXPECT_EQ(strokes[0].from_W.x(), 0);
    for (std::size_t i = 1; i < strokes.size(); ++i) {
      // A slow tool is not followed more often than its brush sees.
      EXPECT_LE((strokes[i].from_W - strokes[i - 1].to_W).norm(), 0.05 * 2e-3 + 1e-12) << speed;
    }
    EXPECT_NEAR(strokes.back().to_W.x(), speed * 0.1, 0.05 * 2e-3 + speed * 4e-3 + 1e-12);
  }
}

TEST(ToolBrush, OnlyATouchingToolEdits) {
  ToolBrush tool = brush("remove:radius=2mm");
  for (int tick = 0; tick < 98; ++tick) EXPECT_FALSE(tool.look(poseAt(tick * 1e-3, false), tick * kTick_ns));
  // A touch between two edits is enough.
  EXPECT_FALSE(tool.look(poseAt(0.1, true), 98 * kTick_ns));
  EXPECT_TRUE(tool.look(poseAt(0.1, false), 100 * kTick_ns));
}

TEST(ToolBrush, AToolThatStandsIsNotRepeatedUnlessItsBrushGoesOn) {
  const auto countOf = [](const char* text) {
    ToolBrush tool = brush(text);
    int count = 0;
    for (int tick = 0; tick <= 100; ++tick) count += tool.look(poseAt(0, true), tick * kTick_ns) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(countOf("remove:radius=2mm"), 1);
  EXPECT_EQ(countOf("remove:radius=2mm:strength=0.5"), 25);
  EXPECT_EQ(countOf("smooth:radius=2mm"), 25);
  EXPECT_EQ(countOf("remove:radius=2mm:strength=0.5:period=10"), 10);
}

// 1 - exp(-rate F t): F = K depth = 0.5 N for 4 ms; strengths of pieces compose to that of the whole time.
TEST(ToolBrush, RateTakesForceAndTime) {
  ToolBrush tool = brush("remove:radius=2mm:rate=100");
  double left = 1;
  for (int tick = 0; tick <= 40; ++tick) {
    const auto stroke = tool.look(poseAt(0, true, 1e-3), tick * kTick_ns);
    if (!stroke) continue;
    EXPECT_NEAR(stroke->strength, 1 - std::exp(-100 * 0.5 * 4e-3), 1e-12);
    left *= 1 - stroke->strength;
  }
  EXPECT_NEAR(left, std::exp(-100 * 0.5 * 40e-3), 1e-12);
  // A deep tool presses with no more than the device's limit.
  ToolBrush deep = brush("remove:radius=2mm:rate=1");
  for (int tick = 0; tick < 4; ++tick) EXPECT_FALSE(deep.look(poseAt(0, true, 1), tick * kTick_ns));
  EXPECT_NEAR(deep.look(poseAt(0, true, 1), 4 * kTick_ns)->strength, 1 - std::exp(-8 * 4e-3), 1e-12);
}

TEST(ToolBrush, ReadsItsText) {
  const ToolBrushSpec spec =
      toolBrushSpec("remove:radius=500um:strength=0.25:falloff=0.5:rate=3:soft=100:hard=900:drop=0.8:period=8");
  EXPECT_EQ(spec.brush.kind, EditKind::kRemove);
  EXPECT_DOUBLE_EQ(spec.brush.radius_m, 0.5e-3);
  EXPECT_EQ(spec.brush.strength, 0.25);
  EXPECT_EQ(spec.brush.falloff, 0.5);
  EXPECT_EQ(spec.rate_per_Ns, 3);
  ASSERT_TRUE(spec.brush.material);
  EXPECT_EQ(spec.brush.material->high_density, 900);
  EXPECT_EQ(spec.brush.material->drop, 0.8);
  EXPECT_DOUBLE_EQ(spec.period_s, 8e-3);
  EXPECT_EQ(toolBrushSpec("paint:value=12:radius=3").brush.value, 12);
  EXPECT_DOUBLE_EQ(toolBrushSpec("add:radius=0.2cm").brush.radius_m, 2e-3);
}

TEST(ToolBrush, RefusesTextsThatMakeNoBrush) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "there is no brush ''"},
      {"carve:radius=2mm", "use remove, add"},
      {"remove", "no radius"},
      {"remove:radius", "has no value"},
      {"remove:radius=2furlongs", "no length"},
      {"remove:radius=0mm", "no length above 0"},
      {"remove:radius=-2mm", "no length above 0"},
      {"remove:radius=nanmm", "is no number"},
      {"remove:radius=2mm:strength=0", "give 1e-06 to 1"},
      {"remove:radius=2mm:strength=2", "give 1e-06 to 1"},
      {"remove:radius=2mm:falloff=-1", "give 0 to 1"},
      {"remove:radius=2mm:size=3", "there is no 'size'"},
      {"remove:radius=2mm:soft=5:hard=4", "give soft below hard"},
      {"add:radius=2mm:drop=0.5", "add has no 'drop'"},
      {"remove:radius=2mm:radius=3mm", "given twice"},
      {"remove:radius=2mm:at=1,2,3", "remove has no 'at'"},
      {"cut:radius=2mm", "there is no brush 'cut'"},
      {"undo", "there is no brush 'undo'"},
      {"remove:radius=2mm:rate=x", "is no number"},
  };
  for (const auto& [text, words] : cases) {
    try {
      static_cast<void>(toolBrushSpec(text));
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_THAT(error.what(), HasSubstr(words)) << text;
    }
  }
}

}  // namespace
}  // namespace palpate
