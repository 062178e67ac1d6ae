// SPDX-License-Identifier: Apache-2.0
// `palpate sculpt` with a device in a hand: an emulated Polhem at its own pace, through hidapi.
#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "apps/sculpt/session_folders.hpp"
#include "engine/field/statistics.hpp"
#include "engine/journal/journal_reader.hpp"
#include "sculpt_window.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace window_device_test {

// The servo is in the window's process, or in one of its own.
class WithAnArm : public OnADesktop, public testing::WithParamInterface<bool> {
 protected:
  void SetUp() override {
    OnADesktop::SetUp();
    if (IsSkipped()) return;
    // A hand that goes 2 mm below the ball's surface and out again, every four seconds.
    const Volume ball = loadVolume(kBall);
    const double isovalue = defaultIsovalue(ball);
    double surface_y = -20e-3;
    while (ball.density(Vec3(0, surface_y, 0)).value_or(-1e30) < isovalue) surface_y += 1e-5;
    inside_W = Vec3(0, surface_y + kDeep_m, 0);
    const std::string way = (folder.path() / "way.csv").string();
    std::ofstream csv(way);
    csv << "time_s,x_m,y_m,z_m\n";
    for (int t_s = 0; t_s < 600; t_s += 2)
      csv << fmt::format("{},0,{},0\n", t_s, t_s % 4 == 0 ? surface_y - 5e-3 : inside_W.y());
    csv.close();
    arm = {"--paced", "--path", way, "--at", "0,0,0"};
    more = {{"XDG_RUNTIME_DIR", folder.path().string()}};
    options = {"--device",        "polhem-v1", "--place-at", "0,0,0", "--place-scale", "1", "--calibrated",
               "--current-limit", "3",         "--edge",     "0"};
    if (GetParam()) options.emplace_back("--service");
  }
  void startWithArm(const std::vector<std::string>& how = {}) {
    runner = {PALPATE_EMULATE_HID};
    runner.insert(runner.end(), arm.begin(), arm.end());
    runner.insert(runner.end(), how.begin(), how.end());
    runner.emplace_back("--");
    start();
  }
  // The brush is held by the keyboard over the picture, for two of the hand's ways in and out and more, or until it has
  // drilled in the only session that is open.
  bool drillsInAnotherVolume() {
    const std::filesystem::path first = journal();
    enters(kFileX, kOpenY, "phantom:sphere?size=48&seed=2");
    EXPECT_TRUE(waitUntil([&] { return !journal().empty() && journal() != first; })) << program->said();
    EXPECT_TRUE(showsBallBesideTheTool()) << program->said();
    desktop->moves(kPicture.x + 20, 20);
    desktop->does({"click", "3", "keydown", "space"});
    bool drilled = false;
    for (int i = 0; i < 90 && !drilled; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      drilled = !readJournal(journal()).records.empty();
    }
    desktop->does({"keyup", "space"});
    return drilled;
  }
  // The tool is always on its way, so that nothing is ever still.
  bool showsBallBesideTheTool() {
    return waitUntil([&] {
             if (!program->runs()) return true;
             const auto pixel = desktop->look().at(kMiddleX - 120, kMiddleY - 120);
             return pixel[0] > 90 && pixel[0] > pixel[2] + 10;
           }) &&
           program->runs();
  }
  static constexpr double kDeep_m = 2e-3;
  Vec3 inside_W = Vec3::Zero();
  std::vector<std::string> arm;  // how it is emulated
};

INSTANTIATE_TEST_SUITE_P(Servo, WithAnArm, testing::Bool(),
                         [](const auto& one) { return one.param ? "InItsOwnProcess" : "Here"; });

// The mouse's pointer stays at the picture's edge, and its button holds the brush: the tool is where the arm is.
TEST_P(WithAnArm, DrillsWhereTheArmIs) {
  startWithArm();
  ASSERT_TRUE(showsBallBesideTheTool()) << program->said();
  desktop->moves(kPicture.x + 20, 20);
  desktop->does({"mousedown", "1"});
  const auto edits = [&] { return readJournal(journal()).records.size(); };
  EXPECT_TRUE(waitUntil([&] { return edits() >= 20; })) << program->said();
  desktop->does({"mouseup", "1"});
  const std::filesystem::path kept = journal();
  endsWell();
  // Each where the arm was: on its way, and no further than it goes; the hand's spring gives way by less than its
  // depth.
  double deepest_y = -1;
  for (const LastingEdit& edit : lastingEdits(readJournal(kept))) {
    for (const EditCommand& command : edit.commands) {
      EXPECT_LT(std::hypot(command.to_W.x(), command.to_W.z()), 5e-4);
      EXPECT_LT(command.to_W.y(), inside_W.y() + 1e-4);
      deepest_y = std::max(deepest_y, command.to_W.y());
    }
  }
  EXPECT_GT(deepest_y, inside_W.y() - kDeep_m);
}

// One device for all volumes, which knows whether it is calibrated.
TEST_P(WithAnArm, GoesOnWithAnotherVolume) {
  startWithArm();
  ASSERT_TRUE(showsBallBesideTheTool()) << program->said();
  EXPECT_TRUE(drillsInAnotherVolume()) << program->said();
  endsWell();
}

// The same, but the cable was pulled for a moment: it counts from anywhere then, and exerts no force, whatever was said
// of it at the start. But in a long run, with one servo: with that from whose process the window hears of it.
TEST_P(WithAnArm, ThatWasUnpluggedIsNotTakenForCalibratedWithAnotherVolume) {
  const bool has_own_process = GetParam();
  if (!has_own_process) PALPATE_LONG_ONLY();
  startWithArm({"--unplug-after", "3000", "--replug-ms", "300"});
  ASSERT_TRUE(showsBallBesideTheTool()) << program->said();
  std::this_thread::sleep_for(std::chrono::seconds(5));
  EXPECT_FALSE(drillsInAnotherVolume()) << program->said();
  endsWell();
}

// With the cable out no other volume is opened: the one that is open stays, and the window says why. But in a long run,
// with one servo.
TEST_P(WithAnArm, ThatIsUnpluggedLeavesTheVolumeOpen) {
  const bool has_own_process = GetParam();
  if (has_own_process) PALPATE_LONG_ONLY();
  startWithArm({"--unplug-after", "3000"});
  ASSERT_TRUE(showsBallBesideTheTool()) << program->said();
  std::this_thread::sleep_for(std::chrono::seconds(5));
  ASSERT_TRUE(movesOff());
  const Screen before = desktop->look();
  const std::filesystem::path first = journal();
  enters(kFileX, kOpenY, "phantom:box?size=32");
  EXPECT_TRUE(saysSomething(before)) << program->said();
  ASSERT_TRUE(movesOff());
  EXPECT_EQ(differing(before, desktop->look(), kUpper), 0);
  EXPECT_EQ(journal(), first);
  endsWell();
}

// Without an arm: the words that say what is missing, before any window.
TEST_F(OnADesktop, SaysThatNoDeviceIsThere) {
  options = {"--device", "spacemouse"};
  start();
  EXPECT_EQ(program->ends(), 3) << program->said();
  EXPECT_THAT(program->said(), testing::HasSubstr("spacemouse"));
}

TEST_F(OnADesktop, SaysThatTheServosProcessFindsNoDevice) {
  options = {"--device", "spacemouse", "--service"};
  start();
  EXPECT_EQ(program->ends(), 3) << program->said();
  EXPECT_THAT(program->said(), testing::HasSubstr("spacemouse"));
}

// Flags of a real device are not ignored in silence.
TEST_F(OnADesktop, TellsFlagsThatOnlyARealDeviceHas) {
  options = {"--calibrated", "--current-limit", "3"};
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  endsWell();
  EXPECT_THAT(program->said(), testing::HasSubstr("--current-limit has no effect: only a real --device has it"));
  EXPECT_THAT(program->said(), testing::HasSubstr("--calibrated has no effect"));
}

TEST_F(OnADesktop, PlaysNoRecording) {
  options = {"--device", "recorded"};
  start();
  EXPECT_EQ(program->ends(), 2);
  EXPECT_THAT(program->said(), testing::HasSubstr("--device recorded: a window plays no recording back"));
}

}  // namespace window_device_test
}  // namespace palpate
