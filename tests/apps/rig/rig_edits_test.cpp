// SPDX-License-Identifier: Apache-2.0
// Edits, undo and redo that are asked for while a rig runs: done in their order, felt, refused without an end.
#include "apps/rig/rig_edits.hpp"

#include <new>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/rig/touch_rig.hpp"
#include "engine/journal/volume_identity.hpp"
#include "engine/phantoms/phantom.hpp"
#include "failing_memory.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/simulated_device.hpp"

namespace palpate {
namespace rig_edits_test {

using testing::HasSubstr;

// A tool at rest a millimetre below the surface of a ball of 20 voxels of a millimetre.
class Edits : public testing::Test {
 protected:
  Edits()
      : volume(makeVolume(*makePhantom("phantom:sphere?size=48"))),
        engine(volume, makePlan({.edits = true}), kIsovalue, ""),
        session(engine, brushProfile(volume, kIsovalue), {}, std::size_t{1} << 30U),
        edits(session, volume.size(), volume.lattice(), [this](const std::string& words) { told.push_back(words); }) {}

  static double isovalueOf() { return makePhantom("phantom:sphere?size=48")->isovalue(); }
  // A dab at the surface, along +x from the middle.
  [[nodiscard]] std::vector<EditCommand> dab(EditKind kind, double radius_m = 3e-3) const {
    EditCommand command;
    command.kind = kind;
    command.from_W = command.to_W = tool_W();
    command.radius_m = radius_m;
    return {command};
  }
  [[nodiscard]] Vec3 tool_W() const {
    Vec3 at_L = 0.5 * (volume.size() - Vec3i::Ones()).cast<double>();
    while (volume.value(at_L.array().round().cast<int>()) > kIsovalue) at_L.x() += 1;
    return volume.lattice().toWorld(at_L - Vec3(2, 0, 0));
  }
  void touch() {
    pose_.position_W = tool_W();
    pose_.normal_W = Vec3::UnitX();
    pose_.at_surface = true;
  }
  void stroke(int looks) {
    for (int i = 0; i < looks; ++i) {
      pose_.position_W.z() += 1e-4;
      look();
    }
  }
  // Two looks away from the surface; from the first to the next at the surface it is so long.
  void awayFor(std::int64_t ns) {
    pose_.normal_W = Vec3::Zero();
    look();
    now_ns_ += ns - 2'000'000;
    look();
    pose_.normal_W = Vec3::UnitX();
  }
  void look() { edits.look(pose_, now_ns_ += 1'000'000); }
  [[nodiscard]] std::uint64_t hash() {
    engine.readBack(volume);
    return contentHash(volume);
  }

  const double kIsovalue = isovalueOf();
  Volume volume;
  Engine engine;
  EditSession session;
  std::vector<std::string> told;
  RigEdits edits;
  ToolPose pose_ = [] {
    ToolPose pose;
    pose.tick = 0;
    return pose;
  }();
  std::int64_t now_ns_ = 0;
};

TEST_F(Edits, AreMadeInTheirOrderOneALook) {
  const std::uint64_t before = hash();
  EXPECT_TRUE(edits.edit(dab(EditKind::kRemove)));
  EXPECT_TRUE(edits.undo());
  EXPECT_TRUE(edits.redo());
  EXPECT_TRUE(edits.edit(dab(EditKind::kAdd)));
  EXPECT_EQ(edits.state().edits, 0U);
  look();
  const std::uint64_t removed = hash();
  EXPECT_NE(removed, before);
  EXPECT_EQ(edits.state().edits, 1U);
  EXPECT_TRUE(edits.state().canUndo());
  EXPECT_FALSE(edits.state().canRedo());
  look();
  EXPECT_EQ(hash(), before);
  EXPECT_FALSE(edits.state().canUndo());
  EXPECT_TRUE(edits.state().canRedo());
  look();
  EXPECT_EQ(hash(), removed);
  look();
  EXPECT_NE(hash(), removed);
  look();  // nothing waits any more
  EXPECT_EQ(edits.state().edits, 4U);
  EXPECT_EQ(edits.state().refused, 0U);
  EXPECT_THAT(told, testing::IsEmpty());
}

TEST_F(Edits, ThatAreRefusedAreToldOnceAndCounted) {
  const std::uint64_t before = hash();
  std::vector<EditCommand> wrong = dab(EditKind::kRemove);
  for (const double radius_m : {-1e-3, -2e-3, -10e-3}) {
    wrong[0].radius_m = radius_m;
    edits.edit(wrong);
  }
  edits.undo();
  for (int i = 0; i < 4; ++i) look();
  EXPECT_EQ(hash(), before);
  EXPECT_EQ(edits.state().refused, 4U);
  EXPECT_EQ(edits.state().edits, 0U);
  EXPECT_TRUE(edits.state().editing);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_THAT(told[0], HasSubstr("an edit was refused: "));
  EXPECT_THAT(told[1], HasSubstr("undo was refused: "));
  const std::vector<std::string> troubles = edits.troubles();
  ASSERT_EQ(troubles.size(), 2U);
  EXPECT_EQ(troubles[0], "3 times, first: " + told[0]);
  EXPECT_EQ(troubles[1], told[1]);
  edits.edit(dab(EditKind::kRemove));  // and editing goes on
  look();
  EXPECT_NE(hash(), before);
}

TEST_F(Edits, WaitInABoundedNumber) {
  for (std::size_t i = 0; i < RigEdits::kMostWaiting; ++i) ASSERT_TRUE(edits.undo()) << i;
  EXPECT_FALSE(edits.undo());
  EXPECT_FALSE(edits.edit(dab(EditKind::kRemove)));
  look();
  EXPECT_TRUE(edits.edit(dab(EditKind::kRemove)));
  EXPECT_FALSE(edits.redo());
  for (std::size_t i = 0; i < RigEdits::kMostWaiting; ++i) look();
  EXPECT_EQ(edits.state().refused, RigEdits::kMostWaiting);  // there was nothing to undo
  EXPECT_EQ(edits.state().edits, 1U);
}

// The brush may change at any time, and go.
TEST_F(Edits, OfTheToolFollowItsBrush) {
  const auto strokes = [&](int looks) {
    const std::uint64_t before = edits.state().edits;
    for (int i = 0; i < looks; ++i) {
      pose_.position_W.z() += 1e-4;
      look();
    }
    return edits.state().edits - before;
  };
  pose_.position_W = tool_W();
  pose_.normal_W = Vec3::UnitX();
  pose_.at_surface = true;
  EXPECT_EQ(strokes(20), 0U);
  ToolBrushSpec spec = toolBrushSpec("remove:radius=1mm");
  spec.period_s = 4e-3;
  edits.setBrush(spec);
  const auto slow = strokes(40);
  EXPECT_GE(slow, 8U);
  EXPECT_LE(slow, 10U);
  spec.period_s = 2e-3;
  edits.setBrush(spec);
  const auto fast = strokes(40);
  EXPECT_GE(fast, 16U);
  EXPECT_LE(fast, 20U);
  pose_.tick = -1;  // no servo ticks: there is no tool
  EXPECT_EQ(strokes(20), 0U);
  pose_.tick = 0;
  edits.dropBrush();
  EXPECT_EQ(strokes(40), 0U);
  EXPECT_THAT(told, testing::IsEmpty());
}

// From its tick on; the last one stays.
TEST_F(Edits, OfTheToolFollowTheBrushesOfAScript) {
  ToolBrushSpec spec = toolBrushSpec("remove:radius=1mm");
  spec.period_s = 1e-3;
  edits.follow({{10, spec}, {20, std::nullopt}, {30, spec}});
  pose_.position_W = tool_W();
  pose_.normal_W = Vec3::UnitX();
  pose_.at_surface = true;
  std::vector<std::uint64_t> made;
  for (int tick = 0; tick < 40; ++tick) {
    pose_.tick = tick;
    pose_.position_W.z() += 1e-4;
    look();
    made.push_back(edits.state().edits);
  }
  EXPECT_EQ(made[9], 0U);
  EXPECT_GT(made[19], 4U);
  EXPECT_EQ(made[29], made[19]);
  EXPECT_GT(made[39], made[29] + 4);
}

// A stroke is undone as one, however long it rests or leaves the surface: it ends with its brush, and with another
// edit, undo or redo.
TEST_F(Edits, OfAStrokeAreUndoneAsOne) {
  touch();
  const ToolBrushSpec spec = toolBrushSpec("remove:radius=1mm");
  const std::uint64_t before = hash();
  edits.setBrush(spec);
  stroke(30);
  EXPECT_GE(edits.state().edits, 5U);
  EXPECT_EQ(edits.state().done, 1U);
  const std::uint64_t once = hash();
  edits.setBrush(spec);
  stroke(30);
  EXPECT_EQ(edits.state().done, 2U);
  now_ns_ += 600'000'000;  // longer than kStrokePause_s: a busy engine
  stroke(30);
  EXPECT_EQ(edits.state().done, 2U);
  awayFor(1'000'000'000);
  stroke(30);
  EXPECT_EQ(edits.state().done, 2U);
  edits.edit(dab(EditKind::kAdd));
  stroke(30);
  EXPECT_EQ(edits.state().done, 4U);  // the dab, and what came after it
  edits.dropBrush();
  look();
  for (int i = 0; i < 3; ++i) edits.undo();
  stroke(3);
  EXPECT_EQ(edits.state().done, 1U);
  EXPECT_EQ(edits.state().steps.size(), 4U);
  EXPECT_EQ(hash(), once);
  edits.undo();
  look();
  EXPECT_EQ(hash(), before);
  EXPECT_EQ(edits.state().content_version, engine.editVersion());
}

// Of a scripted session: nobody lets go of the brush, and half a second away from the surface ends a stroke; time at
// the surface in which nothing was due, or nobody looked, does not.
TEST_F(Edits, OfAScriptEndWithAPauseAwayFromTheSurface) {
  edits.follow({{0, toolBrushSpec("remove:radius=1mm")}});
  touch();
  pose_.tick = 0;
  stroke(30);
  ASSERT_EQ(edits.state().done, 1U);
  now_ns_ += 2'000'000'000;
  stroke(30);
  EXPECT_EQ(edits.state().done, 1U);
  awayFor(499'999'999);
  stroke(30);
  EXPECT_EQ(edits.state().done, 1U);
  awayFor(500'000'000);
  stroke(30);
  EXPECT_EQ(edits.state().done, 2U);
  stroke(30);
  EXPECT_EQ(edits.state().done, 2U);
}

// To any place of the list, a step at a look, and back; a step that does not exist changes nothing.
TEST_F(Edits, GoToAPlaceInTheList) {
  std::vector<std::uint64_t> hashes{hash()};
  const std::vector<EditKind> kinds = {EditKind::kRemove, EditKind::kSmooth, EditKind::kAdd, EditKind::kRemove};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    edits.edit(dab(kinds[i], 3e-3 + 1e-3 * static_cast<double>(i)));
    look();
    hashes.push_back(hash());
  }
  ASSERT_EQ(edits.state().steps.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(edits.state().steps[i].kind, kinds[i]) << i;
    EXPECT_EQ(edits.state().steps[i].edits, 1U) << i;
  }
  for (const std::size_t to : {1U, 4U, 0U, 3U, 3U}) {
    const std::size_t from = edits.state().done;
    edits.goTo(to);
    const std::size_t way = std::max(from, to) - std::min(from, to);
    for (std::size_t i = 0; i < way; ++i) {
      EXPECT_NE(edits.state().done, to);
      look();
    }
    look();
    EXPECT_EQ(edits.state().done, to);
    EXPECT_EQ(edits.state().steps.size(), 4U);
    EXPECT_EQ(hash(), hashes[to]) << to;
  }
  edits.goTo(9);
  look();
  look();
  EXPECT_EQ(edits.state().done, 4U);
  EXPECT_EQ(told.size(), 1U);  // there is nothing more to redo
  edits.goTo(2);
  edits.doWaiting(now_ns_);  // all of it, at the end of a session
  EXPECT_EQ(hash(), hashes[2]);
}

// A brush that fits nowhere, under a tool at rest: its stroke is refused in each period and tried again in the next.
// The first look begins a period of 4 looks, so strokes are due in looks 5, 9, 13 and 17.
TEST_F(Edits, OfARestingToolAreTriedAgainWhileTheyAreRefused) {
  pose_.position_W = tool_W();
  pose_.normal_W = Vec3::UnitX();
  pose_.at_surface = true;
  ToolBrushSpec spec = toolBrushSpec("remove:radius=1mm");
  spec.period_s = 4e-3;
  spec.brush.strength = 2;
  edits.setBrush(spec);
  for (int i = 0; i < 20; ++i) look();
  EXPECT_EQ(edits.state().refused, 4U);
  EXPECT_EQ(edits.state().edits, 0U);
  EXPECT_EQ(told.size(), 1U);
  // One that fits is made once, since the tool rests.
  spec.brush.strength = 1;
  edits.setBrush(spec);
  for (int i = 0; i < 20; ++i) look();
  EXPECT_EQ(edits.state().refused, 4U);
  EXPECT_EQ(edits.state().edits, 1U);
}

// Bricks that are lost on their way to the CPU break the engine. The next edit finds that out: it is told once, what
// waits is dropped, and nothing more is taken.
TEST_F(Edits, EndWhenTheDeviceFails) {
  EXPECT_TRUE(edits.edit(dab(EditKind::kRemove)));
  look();
  ASSERT_GT(engine.changedBricks(), 2U);
  failing_memory::failAfter(4);
  EXPECT_THROW(static_cast<void>(engine.takeChanged(engine.changedBricks())), std::bad_alloc);
  failing_memory::failNoMore();
  ASSERT_TRUE(engine.broken());
  EXPECT_TRUE(edits.undo());
  EXPECT_TRUE(edits.undo());
  EXPECT_TRUE(edits.state().editing);
  for (int i = 0; i < 3; ++i) look();
  EXPECT_FALSE(edits.state().editing);
  EXPECT_EQ(edits.state().edits, 1U);
  EXPECT_EQ(edits.state().refused, 0U);
  EXPECT_FALSE(edits.edit(dab(EditKind::kRemove)));
  EXPECT_FALSE(edits.setBrush(toolBrushSpec("remove:radius=1mm")));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told[0], testing::StartsWith("editing has ended: "));
  EXPECT_EQ(edits.troubles(), told);
}

// A message that comes again is told again, unless it is a refusal's; either is listed once, whatever its numbers.
TEST_F(Edits, TroublesAreListedOnceWithTheirCount) {
  edits.tell("3 of 7 were lost");
  edits.tell("4 of 7 were lost");
  edits.tell("something else");
  EXPECT_THAT(told, testing::ElementsAre("3 of 7 were lost", "4 of 7 were lost", "something else"));
  EXPECT_THAT(edits.troubles(), testing::ElementsAre("2 times, first: 3 of 7 were lost", "something else"));
}

// A service may go on for days.
TEST_F(Edits, KeepsABoundedNumberOfTroubles) {
  std::string name;
  for (std::size_t i = 0; i < 2 * RigEdits::kMostTroubles; ++i) edits.tell(name += 'x');
  EXPECT_EQ(told.size(), 2 * RigEdits::kMostTroubles);
  EXPECT_EQ(edits.troubles().size(), RigEdits::kMostTroubles);
  edits.tell("x");
  EXPECT_EQ(edits.troubles()[0], "2 times, first: x");
}

// On a running rig: what was removed under the tool lets it go, and undo holds it again.
class RigWithEdits : public Edits {
 protected:
  RigWithEdits()
      : path({0, 0.2, 100}, {tool_W() + Vec3(6e-3, 0, 0), tool_W() + Vec3(1e-3, 0, 0), tool_W() + Vec3(1e-3, 0, 0)},
             SampledPath::Interpolation::kLinear) {
    settings.parameters = {.isovalue = kIsovalue, .stiffness_N_per_m = 500, .damping_Ns_per_m = 0};
    loop.real_time = false;
  }
  SampledPath path;
  RigSettings settings;
  LoopParameters loop;
};

TEST_F(RigWithEdits, FeelsThem) {
  loop.ticks = 1400;
  SimulatedDevice device(SimulatedDeviceParameters{}, path, loop.rate_hz);
  TouchRig rig(engine, device, loop, {}, settings, &edits);
  const auto records = rig.runSimulated({},
                                        [&](std::int64_t tick, std::int64_t) {
                                          if (tick == 400) edits.edit(dab(EditKind::kRemove, 6e-3));
                                          if (tick == 700) edits.undo();
                                        })
                           .records;
  EXPECT_TRUE(records[400].in_contact);
  EXPECT_EQ(records[401].edit_version, 1U);  // asked for before tick 400, done before the next
  EXPECT_FALSE(records[410].in_contact);
  EXPECT_FALSE(records[700].in_contact);
  EXPECT_EQ(records[701].edit_version, 2U);
  EXPECT_TRUE(records.back().in_contact);
  EXPECT_NEAR(asVec3(records.back().force_W).norm(), asVec3(records[399].force_W).norm(),
              0.02 * asVec3(records[399].force_W).norm());
}

// By the real clock, from two threads at once: every request that was accepted is made or refused, and nothing else.
TEST_F(RigWithEdits, AreAskedForByAnyThread) {
  loop.ticks = 0;
  loop.record_ticks = 1;
  SimulatedDevice device(SimulatedDeviceParameters{}, path, loop.rate_hz);
  TouchRig rig(engine, device, loop, {}, settings, &edits);
  rig.start();
  std::atomic<std::uint64_t> accepted = 0;
  const auto ask = [&](int seed) {
    for (int i = 0; i < 60; ++i) {
      bool asked = false;
      switch ((i + seed) % 3) {
        case 0:
          asked = edits.edit(dab(i % 2 == 0 ? EditKind::kRemove : EditKind::kAdd));
          break;
        case 1:
          asked = edits.undo();
          break;
        default:
          asked = edits.redo();
      }
      accepted += asked ? 1 : 0;
      static_cast<void>(edits.state());
    }
  };
  std::thread one(ask, 0), other(ask, 1);
  one.join();
  other.join();
  EXPECT_EQ(accepted, 120U);
  const auto done = [&] {
    const RigEdits::State state = edits.state();
    return state.edits + state.refused;
  };
  for (int i = 0; i < 2000 && done() < accepted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  rig.requestStop();
  static_cast<void>(rig.wait());
  EXPECT_EQ(done(), accepted);
  EXPECT_EQ(session.edits(), edits.state().edits);
}

// Whoever asks is told once: that it was made, or why not; also where nobody gets to it any more.
TEST_F(Edits, TellWhoeverAskedWhatBecameOfIt) {
  std::vector<std::string> answers;
  const auto done = [&](const std::optional<Error>& refusal) { answers.push_back(refusal ? refusal->what() : "made"); };
  EXPECT_TRUE(edits.undo(done));
  EXPECT_TRUE(edits.edit(dab(EditKind::kRemove), done));
  EXPECT_TRUE(edits.undo(done));
  EXPECT_TRUE(edits.redo(done));
  EXPECT_TRUE(edits.edit(dab(EditKind::kRemove, 100), done));  // too large
  EXPECT_TRUE(answers.empty());
  for (int i = 0; i < 5; ++i) look();
  ASSERT_EQ(answers.size(), 5U);
  EXPECT_THAT(answers[0], HasSubstr("there is no edit to undo"));
  EXPECT_EQ(answers[1], "made");
  EXPECT_EQ(answers[2], "made");
  EXPECT_EQ(answers[3], "made");
  EXPECT_NE(answers[4], "made");
  EXPECT_EQ(edits.state().refused, 2U);
  EXPECT_TRUE(told.empty());  // nobody else is told
  for (std::size_t i = 0; i < RigEdits::kMostWaiting; ++i) EXPECT_TRUE(edits.undo());
  EXPECT_FALSE(edits.undo(done));
  ASSERT_EQ(answers.size(), 6U);
  EXPECT_THAT(answers[5], HasSubstr("too many edits wait"));
}

TEST_F(Edits, TellWhoeverAskedThatNothingWillBeDone) {
  std::vector<std::string> answers;
  {
    RigEdits ending(session, volume.size(), volume.lattice(), [](const std::string&) {});
    EXPECT_TRUE(ending.undo(
        [&](const std::optional<Error>& refusal) { answers.push_back(refusal ? refusal->what() : "made"); }));
  }
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_THAT(answers[0], HasSubstr("editing has ended"));
}

}  // namespace rig_edits_test
}  // namespace palpate
