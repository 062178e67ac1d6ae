// SPDX-License-Identifier: Apache-2.0
#include "engine/session/tool_brush.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace tool_brush_test {

using ::testing::HasSubstr;

constexpr std::int64_t kTick_ns = 1'000'000;

ToolPose poseAt(double x_m, bool in_contact, double force_N = 0.5) {
  ToolPose pose;
  pose.position_W = {x_m, 0, 0};
  pose.at_surface = in_contact;
  pose.surface_W = pose.position_W;
  if (!in_contact) return pose;
  pose.surface_W += Vec3(0, 0, 1e-3);
  pose.normal_W = Vec3::UnitZ();
  pose.force_W = force_N * pose.normal_W + Vec3(0.3, 0, 0);  // and it rubs
  return pose;
}

const Lattice kLattice{Vec3(1e-3, 2e-3, 3e-3), Mat3::Identity(), Vec3(1e-3, 2e-3, 3e-3)};
const Vec3i kSize(11, 21, 31);

ToolBrush brush(const char* text) {
  return {toolBrushSpec(text), kSize, kLattice};
}

TEST(ToolBrush, StrokesShareTheirEndsAtAnySpeed) {
  for (const double speed : {0.01, 0.1, 1.0, 10.0}) {
    ToolBrush tool = brush("remove:radius=2mm");
    std::vector<EditCommand> strokes;
    for (int tick = 0; tick <= 100; ++tick) {
      const auto due = tool.dueStroke(poseAt(speed * tick * 1e-3, true), tick * kTick_ns);
      strokes.insert(strokes.end(), due.begin(), due.end());
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

// It touches here, and 40 mm further on, and was put there: no stroke leads from one to the other, however seldom the
// engine looks.
TEST(ToolBrush, NoStrokeGoesWhereTheToolLeapt) {
  for (const int period : {1, 3, 7, 50}) {
    ToolBrush tool = brush("remove:radius=2mm");
    int strokes = 0;
    for (int tick = 0; tick <= 200; tick += period) {
      ToolPose pose = poseAt((tick < 100 ? 0 : 0.04) + tick * 1e-5, true);
      pose.leaps = tick < 100 ? 3 : 4;
      for (const EditCommand& stroke : tool.dueStroke(pose, tick * kTick_ns)) {
        ++strokes;
        EXPECT_LE((stroke.to_W - stroke.from_W).norm(), 2e-3) << period;
      }
    }
    EXPECT_GT(strokes, 1) << period;
  }
}

TEST(ToolBrush, OnlyATouchingToolEdits) {
  ToolBrush tool = brush("remove:radius=2mm");
  for (int tick = 0; tick < 98; ++tick)
    EXPECT_TRUE(tool.dueStroke(poseAt(tick * 1e-3, false), tick * kTick_ns).empty());
  // A touch between two edits is enough.
  EXPECT_TRUE(tool.dueStroke(poseAt(0.1, true), 98 * kTick_ns).empty());
  EXPECT_EQ(tool.dueStroke(poseAt(0.1, false), 100 * kTick_ns).size(), 1U);
}

TEST(ToolBrush, AToolThatStandsIsNotRepeatedUnlessItsBrushGoesOn) {
  const auto countOf = [](const char* text) {
    ToolBrush tool = brush(text);
    int count = 0;
    for (int tick = 0; tick <= 100; ++tick)
      count += static_cast<int>(tool.dueStroke(poseAt(0, true), tick * kTick_ns).size());
    return count;
  };
  EXPECT_EQ(countOf("remove:radius=2mm"), 1);
  EXPECT_EQ(countOf("remove:radius=2mm:strength=0.5"), 25);
  EXPECT_EQ(countOf("smooth:radius=2mm"), 25);
  EXPECT_EQ(countOf("remove:radius=2mm:strength=0.5:period=10"), 10);
  EXPECT_EQ(countOf("add:radius=2mm"), 1);
  EXPECT_EQ(countOf("add:radius=2mm:falloff=0.5"), 25);
  EXPECT_EQ(countOf("paint:radius=2mm:value=12"), 25);
  EXPECT_EQ(countOf("remove:radius=2mm:soft=100:hard=900:drop=0.8"), 25);
}

// The tool has been away and comes back within a period to where it made its last stroke: its way there is a stroke.
TEST(ToolBrush, AToolThatComesBackIsNotAtRest) {
  ToolBrush tool = brush("remove:radius=2mm");
  EXPECT_TRUE(tool.dueStroke(poseAt(0, true), 0).empty());
  EXPECT_EQ(tool.dueStroke(poseAt(0, true), 4 * kTick_ns).size(), 1U);
  EXPECT_TRUE(tool.dueStroke(poseAt(0.01, false), 8 * kTick_ns).empty());
  const auto back = tool.dueStroke(poseAt(0, true), 12 * kTick_ns);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].from_W, Vec3(0.01, 0, 0));
  EXPECT_EQ(back[0].to_W, Vec3(0, 0, 0));
  EXPECT_TRUE(tool.dueStroke(poseAt(0, true), 16 * kTick_ns).empty());
}

// At rest is who stays within 0.05 radii, here 0.1 mm, of the end of the last stroke.
// The tool was gone, with its device: no stroke goes from where it was to where it comes back.
TEST(ToolBrush, BeginsAnewWhereTheToolComesBack) {
  ToolBrush tool = brush("remove:radius=2mm");
  std::vector<EditCommand> strokes;
  const auto go = [&](double x_m, int from_tick, int to_tick) {
    for (int tick = from_tick; tick < to_tick; ++tick) {
      const auto due = tool.dueStroke(poseAt(x_m + 1e-3 * (tick - from_tick), true), tick * kTick_ns);
      strokes.insert(strokes.end(), due.begin(), due.end());
    }
  };
  go(0, 0, 10);
  const std::size_t before = strokes.size();
  ASSERT_GT(before, 0U);
  tool.lift();
  go(0.1, 10, 20);
  ASSERT_GT(strokes.size(), before);
  EXPECT_EQ(strokes[before].from_W.x(), 0.1);
}

TEST(ToolBrush, ATwentiethOfTheRadiusIsAWay) {
  for (const auto& [way_m, strokes] : {std::pair(0.099e-3, 0U), std::pair(0.101e-3, 1U)}) {
    ToolBrush tool = brush("remove:radius=2mm");
    EXPECT_TRUE(tool.dueStroke(poseAt(0, true), 0).empty());
    EXPECT_EQ(tool.dueStroke(poseAt(0, true), 4 * kTick_ns).size(), 1U);
    EXPECT_EQ(tool.dueStroke(poseAt(way_m, true), 8 * kTick_ns).size(), strokes) << way_m;
  }
}

TEST(ToolBrush, AToolThatStandsTriesAgainWhatWasRefused) {
  ToolBrush tool = brush("remove:radius=2mm");
  int count = 0;
  for (int tick = 0; tick <= 100; ++tick) {
    if (tool.dueStroke(poseAt(0, true), tick * kTick_ns).empty()) continue;
    if (++count <= 3) tool.refused();
  }
  EXPECT_EQ(count, 4);
}

// 1 - exp(-rate F t): the device was sent 0.5 N along the normal for 4 ms, whatever rubs; strengths of pieces compose
// to that of the whole time. A force that pulls drills nothing.
TEST(ToolBrush, RateTakesTheForceThatWasSentAndTime) {
  ToolBrush tool = brush("remove:radius=2mm:rate=100");
  double left = 1;
  for (int tick = 0; tick <= 40; ++tick) {
    const auto stroke = tool.dueStroke(poseAt(0, true, 0.5), tick * kTick_ns);
    if (stroke.empty()) continue;
    EXPECT_NEAR(stroke[0].strength, 1 - std::exp(-100 * 0.5 * 4e-3), 1e-12);
    left *= 1 - stroke[0].strength;
  }
  EXPECT_NEAR(left, std::exp(-100 * 0.5 * 40e-3), 1e-12);
  ToolBrush pulled = brush("remove:radius=2mm:rate=100");
  for (int tick = 0; tick <= 40; ++tick) EXPECT_TRUE(pulled.dueStroke(poseAt(0, true, -0.5), tick * kTick_ns).empty());
}

// Of a brush of half strength: half of what the force and the time make.
TEST(ToolBrush, RateTakesAShareOfTheStrength) {
  ToolBrush tool = brush("remove:radius=2mm:rate=100:strength=0.5");
  EXPECT_TRUE(tool.dueStroke(poseAt(0, true, 2.0), 0).empty());
  const auto stroke = tool.dueStroke(poseAt(0, true, 2.0), 4 * kTick_ns);
  ASSERT_EQ(stroke.size(), 1U);
  EXPECT_NEAR(stroke[0].strength, 0.5 * (1 - std::exp(-100 * 2.0 * 4e-3)), 1e-12);
}

// An algorithm without a VHIP says no surface, but it has contact: its tool edits too.
TEST(ToolBrush, AToolWithoutAVhipEditsToo) {
  ToolBrush tool = brush("remove:radius=2mm");
  ToolPose pose = poseAt(0, true);
  pose.at_surface = false;
  EXPECT_TRUE(tool.dueStroke(pose, 0).empty());
  EXPECT_EQ(tool.dueStroke(pose, 4 * kTick_ns).size(), 1U);
  ToolBrush flattens = brush("flatten:radius=2mm");
  EXPECT_TRUE(flattens.dueStroke(pose, 0).empty());
  const auto strokes = flattens.dueStroke(pose, 4 * kTick_ns);
  ASSERT_EQ(strokes.size(), 1U);
  EXPECT_EQ(strokes[0].plane_W, pose.position_W);  // which it takes for the surface
  EXPECT_EQ(strokes[0].normal_W, pose.normal_W);
}

// A stroke's period begins where the last one ended, and only what was pressed in it counts.
TEST(ToolBrush, EachPeriodHasItsOwnForce) {
  ToolBrush tool = brush("remove:radius=2mm:rate=100");
  std::vector<double> strengths;
  for (int tick = 0; tick <= 12; ++tick) {
    for (const EditCommand& stroke : tool.dueStroke(poseAt(tick * 1e-3, true,
                                                           tick <= 4   ? 1.0
                                                           : tick <= 8 ? 0.0
                                                                       : 2.0),
                                                    tick * kTick_ns))
      strengths.push_back(stroke.strength);
  }
  ASSERT_EQ(strengths.size(), 2U);  // in the second nobody pressed
  EXPECT_NEAR(strengths[0], 1 - std::exp(-100 * 1.0 * 4e-3), 1e-12);
  EXPECT_NEAR(strengths[1], 1 - std::exp(-100 * 2.0 * 4e-3), 1e-12);
}

// The plane is that of the moment when the contact began, until another begins.
TEST(ToolBrush, FlattensToThePlaneWhereTheContactBegan) {
  ToolBrush tool = brush("flatten:radius=2mm");
  std::vector<EditCommand> strokes;
  for (int tick = 0; tick <= 40; ++tick) {
    ToolPose pose = poseAt(tick * 1e-3, tick != 20);
    if (tick > 0) pose.surface_W.z() += 1e-3;
    if (tick > 20) pose.normal_W = Vec3::UnitX();
    const auto due = tool.dueStroke(pose, tick * kTick_ns);
    strokes.insert(strokes.end(), due.begin(), due.end());
  }
  ASSERT_EQ(strokes.size(), 10U);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const bool first = i < 5;  // the stroke that ends in tick 20 touched before
    EXPECT_EQ(strokes[i].kind, EditKind::kFlatten);
    EXPECT_EQ(strokes[i].plane_W, first ? Vec3(0, 0, 1e-3) : Vec3(21e-3, 0, 2e-3)) << i;
    EXPECT_EQ(strokes[i].normal_W, first ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitX())) << i;
  }
}

// Of every kind that a tool may be, with any of its keys. Lengths, times and rates are within a rounding or two.
TEST(ToolBrush, IsReadBackFromItsText) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.001, 1);
  for (int trial = 0; trial < 500; ++trial) {
    constexpr EditKind kKinds[] = {EditKind::kAdd,    EditKind::kRemove,  EditKind::kPaint,  EditKind::kFlatten,
                                   EditKind::kSmooth, EditKind::kInflate, EditKind::kDeflate};
    ToolBrushSpec spec;
    spec.brush.kind = kKinds[random() % std::size(kKinds)];
    spec.brush.radius_m = 5e-3 * share(random);
    spec.brush.strength = share(random);
    spec.brush.falloff = share(random);
    spec.period_s = 0.5 * share(random);
    if (random() % 2 == 0) spec.rate_per_Ns = 100 * share(random);
    if (random() % 2 == 0) spec.mirror_axis = static_cast<int>(random() % 3);
    if (spec.brush.kind == EditKind::kPaint) spec.brush.value = 1000 * share(random) - 500;
    if (spec.brush.kind == EditKind::kRemove && random() % 2 == 0)
      spec.brush.material = MaterialRate{-100 * share(random), 900 * share(random), share(random)};
    const ToolBrushSpec read = toolBrushSpec(toolBrushText(spec));
    EXPECT_EQ(read.brush.kind, spec.brush.kind);
    EXPECT_DOUBLE_EQ(read.brush.radius_m, spec.brush.radius_m);
    EXPECT_EQ(read.brush.strength, spec.brush.strength);
    EXPECT_EQ(read.brush.falloff, spec.brush.falloff);
    EXPECT_EQ(read.brush.value, spec.brush.value);
    EXPECT_DOUBLE_EQ(read.period_s, spec.period_s);
    EXPECT_EQ(read.rate_per_Ns, spec.rate_per_Ns);
    EXPECT_EQ(read.mirror_axis, spec.mirror_axis);
    ASSERT_EQ(read.brush.material.has_value(), spec.brush.material.has_value());
    if (!spec.brush.material) continue;
    EXPECT_EQ(read.brush.material->low_density, spec.brush.material->low_density);
    EXPECT_EQ(read.brush.material->high_density, spec.brush.material->high_density);
    EXPECT_EQ(read.brush.material->drop, spec.brush.material->drop);
  }
}

// The volume's middle is at (6, 22, 48) mm.
TEST(ToolBrush, AMirrorDoesTheStrokeOnTheOtherSideToo) {
  const Vec3 middle_W(6e-3, 22e-3, 48e-3);
  for (const auto& [text, axis] :
       {std::pair("flatten:radius=2mm:mirror=x", 0), std::pair("flatten:mirror=y:radius=2mm", 1),
        std::pair("flatten:radius=2mm:mirror=z", 2)}) {
    ToolBrush tool = brush(text);
    EXPECT_TRUE(tool.dueStroke(poseAt(1e-3, true), 0).empty());
    const auto strokes = tool.dueStroke(poseAt(2e-3, true), 4 * kTick_ns);
    ASSERT_EQ(strokes.size(), 2U);
    const auto other = [&middle_W, along = axis](Vec3 p_W) {
      p_W[along] = 2 * middle_W[along] - p_W[along];
      return p_W;
    };
    EXPECT_LT((strokes[1].from_W - other(Vec3(1e-3, 0, 0))).norm(), 1e-15);
    EXPECT_LT((strokes[1].to_W - other(Vec3(2e-3, 0, 0))).norm(), 1e-15);
    EXPECT_LT((strokes[1].plane_W - other(Vec3(1e-3, 0, 1e-3))).norm(), 1e-15);
    EXPECT_EQ(strokes[1].normal_W, axis == 2 ? Vec3(0, 0, -1) : Vec3(0, 0, 1));
    EXPECT_EQ(strokes[1].radius_m, strokes[0].radius_m);
  }
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
  EXPECT_EQ(spec.brush.material->low_density, 100);
  EXPECT_EQ(spec.brush.material->high_density, 900);
  EXPECT_EQ(spec.brush.material->drop, 0.8);
  EXPECT_DOUBLE_EQ(spec.period_s, 8e-3);
  EXPECT_FALSE(spec.mirror_axis);
  EXPECT_EQ(toolBrushSpec("add:radius=2mm:mirror=z").mirror_axis, 2);
  EXPECT_EQ(toolBrushSpec("paint:value=12:radius=3").brush.value, 12);
  EXPECT_DOUBLE_EQ(toolBrushSpec("add:radius=0.2cm").brush.radius_m, 2e-3);
}

TEST(ToolBrush, RefusesTextsThatMakeNoBrush) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "there is no brush ''"},
      {"carve:radius=2mm", "use remove, add"},
      {"cut:radius=2mm", "use flatten, or remove"},
      {"stamp-add:radius=2mm", "use add or remove"},
      {"remove:radius=2mm:mirror=w", "give mirror=x, y or z"},
      {"remove:radius=2mm:mirror=xy", "is no axis"},
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

}  // namespace tool_brush_test
}  // namespace palpate
