// SPDX-License-Identifier: Apache-2.0
// A volume that is seen, touched and edited by the real clock, without a window.
#include "apps/sculpt/sculpt_session.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "apps/sculpt/brush_choice.hpp"
#include "apps/sculpt/orbit_view.hpp"
#include "apps/sculpt/pointer_tool.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/replay.hpp"
#include "engine/journal/volume_identity.hpp"
#include "temporary_folder.hpp"
#include "tests/apps/palpate/child_process.hpp"
#include "tests/endurance/process_facts.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace sculpt_session_test {

using testing::HasSubstr;

constexpr const char* kBall = "phantom:sphere?size=40";

// Up to a minute: no time is asserted.
bool waitFor(const std::function<bool()>& done) {
  for (int i = 0; i < 60000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

struct Person {
  TemporaryFolder folder;
  Progress silent{nullptr};
  SculptSession session;
  OrbitView orbit;
  PointerTool tool{0.1};
  std::vector<std::string> heard;

  explicit Person(SculptRequest request)
      : session(withJournal(std::move(request)), silent), orbit(session.volume().object, 120, 90) {
    session.start();
    session.view().show({orbit.camera(), {}, DrawOrder::kCoarseFirst});
  }
  SculptRequest withJournal(SculptRequest request) const {
    request.journal = folder.path() / "journal";
    return request;
  }
  SculptState look() {
    SculptState state = session.look();
    heard.insert(heard.end(), state.messages.begin(), state.messages.end());
    return state;
  }
  bool seesAll() {
    return waitFor([&] { return session.view().latest().whole; });
  }
  // Puts the tool where the pointer is, and waits until it is there.
  bool point(double x, double y, bool presses, double depth_m = 1.5e-3) {
    const auto hip_W = tool.hip_W(session.view().latest(), x, y, presses, {.depth_m = depth_m, .lift_m = 3e-3});
    if (!hip_W) return false;
    session.aim(*hip_W);
    return waitFor([&] { return (Vec3(session.tick().hip_W) - *hip_W).norm() < 1e-5; });
  }
  // Presses in the middle until it is done. On a busy machine the force may have faded; then the tool is taken out and
  // put back, as a person would.
  bool presses(const std::function<bool()>& done) {
    for (int tries = 0; tries < 20; ++tries) {
      if (done()) return true;
      if (!point(60, 45, false) || !point(60, 45, true)) return false;
      for (int i = 0; i < 1000 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return done();
  }
};

// That the programs here were built from: "palpate 0.1.0 (0123456789)".
std::string commitOfPrograms() {
  const std::string words = runPalpate({.arguments = {"--version"}}).out;
  const std::size_t begin = words.find('(') + 1;
  return words.substr(begin, words.find(')') - begin);
}

SculptRequest withServosProcess() {
  SculptRequest request{.volume = kBall};
  request.device.service = true;
  request.commit = commitOfPrograms();
  return request;
}

// With the servo in this process, and in one of its own.
class SculptSessions : public testing::TestWithParam<bool> {
 protected:
  static SculptRequest request() { return GetParam() ? withServosProcess() : SculptRequest{.volume = kBall}; }
};
INSTANTIATE_TEST_SUITE_P(Servo, SculptSessions, testing::Bool(),
                         [](const auto& one) { return one.param ? "InItsOwnProcess" : "Here"; });

TEST_P(SculptSessions, IsSeenFeltDrilledUndoneAndSaved) {
  Person person(request());
  ASSERT_TRUE(person.seesAll());
  EXPECT_FALSE(person.look().unsaved);
  const float before = person.session.view().latest().pixels[45 * 120 + 60].distance_m;
  ASSERT_TRUE(std::isfinite(before));

  // 1.5 mm below a surface of 500 N/m are 0.75 N.
  ASSERT_TRUE(person.point(60, 45, false));
  EXPECT_FALSE(person.session.tick().in_contact);
  EXPECT_TRUE(person.presses([&] {
    const TickRecord& tick = person.session.tick();
    return tick.in_contact && std::abs(asVec3(tick.force_W).norm() - 0.75) < 0.1;
  }));

  BrushChoice drill{.radius_m = 3e-3, .strength = 1};
  person.session.press(toolBrush(drill, {}));
  // The soft edge of the brush leaves the surface where it touches the tool with no force.
  EXPECT_TRUE(person.presses(
      [&] { return person.look().edits.edits >= 1 && asVec3(person.session.tick().force_W).norm() < 1e-3; }));
  person.session.release();
  ASSERT_TRUE(waitFor([&] { return person.look().edits.waiting == 0; }));  // the brush is up: no edit comes any more
  ASSERT_TRUE(waitFor([&] {
    const ViewFrame& frame = person.session.view().latest();
    return frame.whole && frame.edit_version == person.look().edits.content_version &&
           frame.pixels[45 * 120 + 60].distance_m > before + 1e-3F;
  }));
  SculptState state = person.look();
  EXPECT_TRUE(state.unsaved);
  EXPECT_EQ(state.edits.done, 1U);

  const std::string file = (person.folder.path() / "drilled.vdb").string();
  const std::string mesh = (person.folder.path() / "drilled.stl").string();
  person.session.save(file);
  person.session.save(mesh);
  ASSERT_TRUE(waitFor([&] { return person.look().errands == 0; }));
  EXPECT_FALSE(person.look().unsaved);
  EXPECT_THAT(person.heard, testing::ElementsAre(HasSubstr("drilled.vdb"), HasSubstr("drilled.stl")));

  // The saved file is what the journal leads to.
  Volume replayed = loadVolume(kBall);
  replay(readJournal(person.folder.path() / "journal"), replayed);
  EXPECT_EQ(contentHash(loadVolume(file)), contentHash(replayed));

  person.session.undo();
  ASSERT_TRUE(waitFor([&] { return person.look().edits.canRedo(); }));
  state = person.look();
  EXPECT_EQ(state.edits.done, 0U);
  EXPECT_TRUE(state.unsaved);
  ASSERT_TRUE(waitFor([&] {
    const ViewFrame& frame = person.session.view().latest();
    return frame.whole && frame.pixels[45 * 120 + 60].distance_m == before;
  }));
  EXPECT_TRUE(state.running);
  person.session.close();
  EXPECT_TRUE(std::filesystem::exists(person.folder.path() / "journal" / "journal.palpate"));  // the undo is unsaved
}

TEST_P(SculptSessions, LeavesNoJournalWhereNothingIsUnsaved) {
  Person person(request());
  EXPECT_TRUE(std::filesystem::exists(person.folder.path() / "journal"));
  person.session.close();
  EXPECT_FALSE(std::filesystem::exists(person.folder.path() / "journal"));
}

TEST_P(SculptSessions, RefusesFilesThatItCannotWrite) {
  Person person(request());
  EXPECT_THROW(person.session.save((person.folder.path() / "picture.png").string()), Error);
  person.session.save((person.folder.path() / "no folder" / "a.vdb").string());
  ASSERT_TRUE(waitFor([&] { return person.look().errands == 0; }));
  EXPECT_THAT(person.heard, testing::ElementsAre(HasSubstr("a.vdb: cannot be created")));
  EXPECT_TRUE(person.look().running);
}

TEST_P(SculptSessions, FollowsAnotherIsovalueAndTellsARefusal) {
  Person person(request());
  ASSERT_TRUE(person.seesAll());
  const float before = person.session.view().latest().pixels[45 * 120 + 60].distance_m;
  RigSettings settings = person.session.settings();
  const double first = settings.parameters.isovalue;
  settings.parameters.isovalue = first - 300;
  person.session.change(settings);
  ASSERT_TRUE(waitFor([&] {
    const ViewFrame& frame = person.session.view().latest();
    return frame.whole && frame.pixels[45 * 120 + 60].distance_m < before;
  }));
  settings.parameters.isovalue = 1e9;
  person.session.change(settings);
  ASSERT_TRUE(waitFor([&] { return !person.look().messages.empty() || !person.heard.empty(); }));
  EXPECT_THAT(person.heard, testing::ElementsAre(HasSubstr("isovalue")));
  EXPECT_EQ(person.session.settings().parameters.isovalue, first - 300);
}

TEST_P(SculptSessions, SavesWhatWasAskedForBeforeItCloses) {
  Person person(request());
  ASSERT_TRUE(person.seesAll());
  person.session.press(toolBrush({.radius_m = 3e-3, .strength = 1}, {}));
  ASSERT_TRUE(person.presses([&] { return person.look().edits.edits >= 1; }));
  person.session.release();
  const std::string file = (person.folder.path() / "last.nrrd").string();
  person.session.save(file);
  person.session.close();
  EXPECT_TRUE(std::filesystem::exists(file));
}

// The servo's settings change while it runs, in whichever process.
TEST_P(SculptSessions, IsFeltAsItIsSet) {
  Person person(request());
  ASSERT_TRUE(person.seesAll());
  const auto isFelt = [&](double force_N) {
    return person.presses([&] {
      const TickRecord& tick = person.session.tick();
      return tick.in_contact && std::abs(asVec3(tick.force_W).norm() - force_N) < 0.1;
    });
  };
  EXPECT_TRUE(isFelt(0.75));
  RigSettings settings = person.session.settings();
  settings.parameters.stiffness_N_per_m = 1000;
  person.session.change(settings);
  EXPECT_TRUE(isFelt(1.5));
  settings.force_limit_N = 0.5;
  person.session.change(settings);
  EXPECT_TRUE(isFelt(0.5));
  // Every tick is told, but for those on a busy machine.
  std::vector<TickRecord> ticks;
  ASSERT_TRUE(waitFor([&] {
    person.session.takeTicks(ticks);
    return ticks.size() > 200;
  }));
  for (std::size_t i = 1; i < ticks.size(); ++i) ASSERT_GT(ticks[i].tick, ticks[i - 1].tick);
}

// Killed: the window says so, and what was edited can still be undone and saved.
TEST(SculptSession, OutlivesItsServosProcess) {
  Person person(withServosProcess());
  ASSERT_TRUE(person.seesAll());
  person.session.press(toolBrush({.radius_m = 3e-3, .strength = 1}, {}));
  ASSERT_TRUE(person.presses([&] { return person.look().edits.edits >= 1; }));
  person.session.release();
  const pid_t servo = childOf(getpid(), "palpate-servo");
  ASSERT_GT(servo, 0);
  kill(servo, SIGKILL);
  ASSERT_TRUE(waitFor([&] { return !person.look().running; }));
  EXPECT_THAT(person.heard, testing::Contains(HasSubstr("the servo's process has ended")));
  person.session.undo();
  ASSERT_TRUE(waitFor([&] { return person.look().edits.canRedo(); }));
  const std::string file = (person.folder.path() / "kept.vdb").string();
  person.session.save(file);
  ASSERT_TRUE(waitFor([&] { return person.look().errands == 0; }));
  EXPECT_EQ(contentHash(loadVolume(file)), contentHash(loadVolume(kBall)));
  EXPECT_NO_THROW(person.session.close());
  EXPECT_EQ(std::ranges::count(person.heard, person.heard.front()), 1);  // told once
}

// The session is closed while the engine still has work: it is done, by one thread, and what is saved has every edit.
TEST(SculptSession, IsClosedInGoodOrderAfterItsServosDeath) {
  Person person(withServosProcess());
  ASSERT_TRUE(person.seesAll());
  person.session.press(toolBrush({.radius_m = 3e-3, .strength = 1}, {}));
  ASSERT_TRUE(person.presses([&] { return person.look().edits.edits >= 20; }));
  const pid_t servo = childOf(getpid(), "palpate-servo");
  ASSERT_GT(servo, 0);
  kill(servo, SIGKILL);
  person.session.release();
  const std::string file = (person.folder.path() / "kept.vdb").string();
  person.session.save(file);
  EXPECT_NO_THROW(person.session.close());
  Volume replayed = loadVolume(kBall);
  if (const auto journal = person.folder.path() / "journal"; std::filesystem::exists(journal)) {
    replay(readJournal(journal), replayed);
    EXPECT_EQ(contentHash(loadVolume(file)), contentHash(replayed));
  } else {  // the file has all of it
    EXPECT_NE(contentHash(loadVolume(file)), contentHash(replayed));
  }
}

// One of another build is no servo of this program.
TEST(SculptSession, RefusesAServoOfAnotherBuild) {
  SculptRequest asked{.volume = kBall};
  asked.device.service = true;
  asked.commit = "another";
  Progress silent(nullptr);
  EXPECT_THAT(refusalOf([&] { const SculptSession session(asked, silent); }), HasSubstr("it was built from"));
}

}  // namespace sculpt_session_test
}  // namespace palpate
