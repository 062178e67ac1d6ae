// SPDX-License-Identifier: Apache-2.0
// `palpate sculpt --connect` without its window: what it sees, leads and edits is a service's.
#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "apps/sculpt/brush_choice.hpp"
#include "apps/sculpt/orbit_view.hpp"
#include "apps/sculpt/pointer_tool.hpp"
#include "apps/sculpt/served_session.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "service_processes.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace onlook_test {

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kBall = "phantom:sphere?size=40";
constexpr std::size_t kMiddle = 45 * 120 + 60;

// Up to a minute: no time is asserted.
bool waitFor(const std::function<bool()>& done) {
  for (int i = 0; i < 30'000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

// Who looks on, with a pointer.
struct Person {
  Progress silent{nullptr};
  ServedSession session;
  OrbitView orbit;
  PointerTool tool{0.1};
  std::vector<std::string> heard;

  explicit Person(const std::string& socket) : session(socket, silent), orbit(session.volume().object, 120, 90) {
    session.start();
    session.show({orbit.camera(), {}, DrawOrder::kCoarseFirst});
  }
  SculptState look() {
    SculptState state = session.look();
    heard.insert(heard.end(), state.messages.begin(), state.messages.end());
    return state;
  }
  // The distance in the middle of a picture that has every edit.
  std::optional<float> seen() {
    const SculptState state = look();
    const ViewFrame& frame = session.frame();
    if (!frame.whole || frame.edit_version != state.edits.content_version) return std::nullopt;
    return frame.pixels.at(kMiddle).distance_m;
  }
  bool sees(const std::function<bool(float distance_m)>& is_so) {
    const bool does = waitFor([&] {
      const auto distance_m = seen();
      return distance_m && is_so(*distance_m);
    });
    if (!does) {
      const ViewFrame& frame = session.frame();
      ADD_FAILURE() << "picture " << frame.number << " of version " << frame.edit_version << " of "
                    << look().edits.content_version << (frame.whole ? ", whole" : "") << ", "
                    << (frame.number > 0 ? frame.pixels.at(kMiddle).distance_m : 0);
    }
    return does;
  }
  // Puts the tool where the pointer is, and waits until it is there.
  bool point(bool presses) {
    const auto hip_W = tool.hip_W(session.frame(), 60, 45, presses, {.depth_m = 1.5e-3, .lift_m = 3e-3});
    if (!hip_W) return false;
    session.aim(*hip_W);
    return waitFor([&] { return (Vec3(session.tick().hip_W) - *hip_W).norm() < 1e-5; });
  }
  // On a busy machine the force may have faded; then the tool is taken out and put back, as a person would.
  bool presses(const std::function<bool()>& done) {
    for (int tries = 0; tries < 20; ++tries) {
      if (done()) return true;
      if (!point(false) || !point(true)) return false;
      for (int i = 0; i < 1000 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return done();
  }
};

class Onlook : public ServiceTest {
 protected:
  void serveBall(const Words& more = {}) { serveFromTheJournal(Words{kBall, "--device", "mouse"} + more); }
  [[nodiscard]] std::string socket() const { return file("run/palpate/service.sock").string(); }
  [[nodiscard]] std::unique_ptr<Person> comes() const { return std::make_unique<Person>(socket()); }
};

TEST_F(Onlook, SeesFeelsDrillsUndoesAndSaves) {
  serveBall();
  ASSERT_TRUE(awaitService());
  const auto person = comes();
  EXPECT_EQ(person->session.volume().name, kBall);
  EXPECT_EQ(person->session.volume().size, Vec3i(40, 40, 40));
  EXPECT_FALSE(person->session.volume().statistics.histogram.counts.empty());
  EXPECT_FALSE(person->session.plan().empty());
  EXPECT_TRUE(person->session.keepsJournal());
  EXPECT_FALSE(person->session.deviceIsHeld());
  float before = 0;
  ASSERT_TRUE(person->sees([&](float distance_m) {
    before = distance_m;
    return std::isfinite(distance_m);
  }));
  EXPECT_FALSE(person->look().running);
  EXPECT_THAT(person->look().missing_servo, HasSubstr("start 'palpate servo'"));
  join();
  ASSERT_TRUE(waitFor([&] { return person->look().running; }));

  // 1.5 mm below a surface of 500 N/m are 0.75 N.
  ASSERT_TRUE(person->point(false));
  EXPECT_TRUE(person->presses([&] {
    const TickRecord& tick = person->session.tick();
    return tick.in_contact && std::abs(asVec3(tick.force_W).norm() - 0.75) < 0.1;
  }));
  std::vector<TickRecord> ticks;
  ASSERT_TRUE(waitFor([&] {
    person->session.takeTicks(ticks);
    return ticks.size() > 200;
  }));
  for (std::size_t i = 1; i < ticks.size(); ++i) ASSERT_GT(ticks[i].tick, ticks[i - 1].tick);

  BrushChoice drill{.radius_m = 3e-3, .strength = 1};
  person->session.press(toolBrush(drill, {}));
  EXPECT_NE(person->session.heldBrush(), "");
  EXPECT_TRUE(person->presses(
      [&] { return person->look().edits.edits >= 1 && asVec3(person->session.tick().force_W).norm() < 1e-3; }));
  person->session.release();
  ASSERT_TRUE(person->sees([&](float distance_m) { return distance_m > before + 1e-3F; }));
  EXPECT_EQ(person->look().edits.done, 1U);
  ASSERT_EQ(person->look().edits.steps.size(), 1U);
  EXPECT_EQ(person->look().edits.steps[0].kind, EditKind::kRemove);
  EXPECT_FALSE(person->look().unsaved);  // the service keeps it

  const std::string drilled = file("drilled.vdb").string();
  person->session.save(drilled);
  ASSERT_TRUE(waitFor([&] { return person->look().errands == 0; }));
  EXPECT_THAT(person->heard, Contains(HasSubstr("drilled.vdb")));
  EXPECT_NE(contentHash(loadVolume(drilled)), contentHash(loadVolume(kBall)));
  EXPECT_NE(refusalOf([&] { person->session.save(file("picture.png").string()); }), "");

  person->session.undo();
  EXPECT_TRUE(person->sees([&](float distance_m) { return distance_m == before; }));
  EXPECT_TRUE(person->look().edits.canRedo());
  person->session.goTo(1);
  EXPECT_TRUE(person->sees([&](float distance_m) { return distance_m > before + 1e-3F; }));
  person->session.redo();
  ASSERT_TRUE(waitFor([&] { return !person->look().messages.empty() || person->heard.size() > 1; }));
  EXPECT_THAT(person->heard, Contains(HasSubstr("redo")));  // there is none
}

TEST_F(Onlook, ChangesSettingsAndIsToldOfOthersChanges) {
  serveBall();
  join();
  ASSERT_TRUE(awaitServo());
  const auto person = comes();
  float before = 0;
  ASSERT_TRUE(person->sees([&](float distance_m) {
    before = distance_m;
    return true;
  }));
  RigSettings settings = person->session.settings();
  settings.parameters.stiffness_N_per_m = 800;
  person->session.change(settings);
  EXPECT_EQ(person->session.settings(), settings);  // at once
  EXPECT_TRUE(waitFor([&] {
    return ctl({"get", "servo.stiffness_N_per_m"}).out == "servo.stiffness_N_per_m = 800\n";
  }));
  EXPECT_TRUE(person->presses([&] {
    const TickRecord& tick = person->session.tick();
    return tick.in_contact && std::abs(asVec3(tick.force_W).norm() - 1.2) < 0.1;
  }));
  settings.parameters.isovalue -= 300;
  person->session.change(settings);
  EXPECT_TRUE(person->sees([&](float distance_m) { return distance_m < before; }));
  RigSettings refused = settings;
  refused.parameters.isovalue = 1e9;
  person->session.change(refused);
  ASSERT_TRUE(waitFor([&] { return !person->look().messages.empty() || !person->heard.empty(); }));
  EXPECT_THAT(person->heard, testing::ElementsAre(HasSubstr("isovalue")));
  EXPECT_TRUE(waitFor([&] {
    static_cast<void>(person->look());
    return person->session.settings() == settings;
  }));
  expectSuccess(ctl({"set", "servo.n", "9"}));
  EXPECT_TRUE(waitFor([&] {
    static_cast<void>(person->look());
    return person->session.settings().parameters.plane_renewal_ticks == 9;
  }));
  EXPECT_EQ(person->heard.size(), 1U);
}

// Two windows and a client: each sees what any of them does; whoever goes lets go of its brush.
TEST_F(Onlook, SeesWhatOthersDo) {
  serveBall();
  join();
  ASSERT_TRUE(awaitServo());
  const auto one = comes();
  auto two = comes();
  float before = 0;
  ASSERT_TRUE(one->sees([&](float distance_m) {
    before = distance_m;
    return true;
  }));
  ASSERT_TRUE(two->sees([&](float distance_m) { return distance_m == before; }));
  two->session.press(toolBrush({.radius_m = 3e-3, .strength = 1}, {}));
  ASSERT_TRUE(two->presses([&] { return two->look().edits.edits >= 1; }));
  EXPECT_TRUE(waitFor([&] { return one->session.frame().pixels.at(kMiddle).distance_m > before + 1e-3F; }));
  two.reset();  // with its brush held
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["clients"] <= 2 && now["waiting"] == 0; }));
  const int edits = status()["edits"];
  ASSERT_TRUE(one->presses([&] { return one->session.tick().in_contact; }));
  EXPECT_EQ(status()["edits"], edits);  // nothing is drilled
  expectSuccess(ctl({"render", "now.png", "--width", "64", "--height", "48"}));
  one->session.goTo(0);
  EXPECT_TRUE(one->sees([&](float distance_m) { return distance_m == before; }));
}

// The engine is killed in the middle: the window keeps its picture, says so, and finds the next one with every edit.
TEST_F(Onlook, OutlivesTheEngineAndTheServo) {
  serveBall();
  join();
  ASSERT_TRUE(awaitServo());
  const auto person = comes();
  float before = 0;
  ASSERT_TRUE(person->sees([&](float distance_m) {
    before = distance_m;
    return true;
  }));
  person->session.press(toolBrush({.radius_m = 3e-3, .strength = 1}, {}));
  ASSERT_TRUE(person->presses([&] { return person->look().edits.edits >= 1; }));
  person->session.release();
  ASSERT_TRUE(person->point(false));  // nothing is drilled any more
  float drilled = 0;
  ASSERT_TRUE(person->sees([&](float distance_m) {
    drilled = distance_m;
    return distance_m > before + 1e-3F;
  }));
  const std::uint64_t frames = person->session.frame().number;
  engine.end(SIGKILL);
  // Not only silent, as a service on a busy machine can be: what is asked for then waits for its answer.
  const auto isGone = [&] {
    const bool can_edit = person->look().can_edit;
    return !can_edit && testing::Matches(Contains(HasSubstr("the service is gone")))(person->heard);
  };
  ASSERT_TRUE(waitFor(isGone));
  EXPECT_EQ(person->session.frame().pixels.at(kMiddle).distance_m, drilled);
  person->session.undo();  // nobody hears it
  EXPECT_THAT(person->look().messages, Contains(HasSubstr("the service does not answer")));
  serveBall();
  ASSERT_TRUE(waitFor([&] { return person->look().can_edit; }));
  EXPECT_THAT(person->heard, Contains(HasSubstr("the service is back")));
  ASSERT_TRUE(waitFor([&] { return person->session.frame().number > frames; }));
  EXPECT_TRUE(person->sees([&](float distance_m) { return distance_m == drilled; }));
  ASSERT_TRUE(waitFor([&] { return person->look().running; }));
  servo.end(SIGKILL);
  ASSERT_TRUE(waitFor([&] { return !person->look().running; }));
  join();
  ASSERT_TRUE(waitFor([&] { return person->look().running; }));
  EXPECT_EQ(person->look().edits.steps.size(), 1U);
  person->session.undo();  // the whole stroke, also after the crash
  EXPECT_TRUE(person->sees([&](float distance_m) { return distance_m == before; }));
}

// A service that is stopped for a while does not answer, and goes on as it was.
TEST_F(Onlook, WaitsForAServiceThatHangs) {
  serveBall();
  ASSERT_TRUE(awaitService());
  const auto person = comes();
  ASSERT_TRUE(person->sees([](float) { return true; }));
  engine.send(SIGSTOP);
  ASSERT_TRUE(waitFor([&] { return !person->look().can_edit; }));
  EXPECT_THAT(person->look().missing_servo, HasSubstr("the service does not answer"));
  engine.send(SIGCONT);
  ASSERT_TRUE(waitFor([&] { return person->look().can_edit; }));
}

// A file that was asked for and is not there is told; what the window asks by itself is not.
TEST_F(Onlook, ToldOfAFileThatTheServiceLeftUndone) {
  serveBall();
  ASSERT_TRUE(awaitService());
  const auto person = comes();
  ASSERT_TRUE(person->sees([](float) { return true; }));
  engine.send(SIGSTOP);
  person->session.save(file("undone.vdb").string());
  EXPECT_EQ(person->look().errands, 1U);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it is sent, and so is a question of the window's own
  engine.end(SIGKILL);
  ASSERT_TRUE(waitFor([&] {
    static_cast<void>(person->look());
    return testing::Matches(Contains(HasSubstr("the service is gone")))(person->heard);
  }));
  EXPECT_THAT(person->heard, Contains(HasSubstr("undone.vdb: the service went before it was written; save again")));
  EXPECT_THAT(person->heard, testing::SizeIs(2));
  EXPECT_EQ(person->look().errands, 0U);
  EXPECT_FALSE(std::filesystem::exists(file("undone.vdb")));
}

TEST_F(Onlook, RefusesWhatItCannotShow) {
  EXPECT_THAT(refusalOf([&] { static_cast<void>(comes()); }, Error::Code::kNotFound),
              HasSubstr("no service listens there"));
  serveBall();
  ASSERT_TRUE(awaitService());
  const auto person = comes();
  ASSERT_TRUE(person->sees([](float) { return true; }));
  std::vector<std::unique_ptr<Person>> others;
  for (int i = 0; i < 3; ++i) others.push_back(comes());
  EXPECT_THAT(refusalOf([&] { static_cast<void>(comes()); }, Error::Code::kOutOfMemory), HasSubstr("look on already"));
  others.clear();
  // Another volume at the same place is none of this window's.
  engine.end(SIGKILL);
  std::filesystem::remove_all(file("state"));
  serve({"phantom:knot?size=32"});
  ASSERT_TRUE(waitFor([&] {
    static_cast<void>(person->look());
    return !person->heard.empty() && person->heard.back().find("phantom:knot") != std::string::npos;
  }));
  EXPECT_FALSE(person->look().can_edit);
}

}  // namespace onlook_test
}  // namespace palpate
