// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/servo_ceilings.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "apps/devices/device_table.hpp"
#include "apps/scene/scene.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "apps/servo_side/servo_host.hpp"
#include "servo/devices/device.hpp"
#include "servo/safety/safety_gate.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/as_nobody.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace servo_ceilings_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Told {
  std::vector<std::string> words;
  TellClipped teller() {
    return [this](const std::string& word) { words.push_back(word); };
  }
};

Scene held() {
  Scene scene;
  scene.device = "polhem-v1";
  return scene;
}

TEST(ServoCeilings, WithoutAnyTheSceneStaysAsItIs) {
  Told told;
  Scene scene = held();
  scene.current_limit_A = 6;
  scene.device_calibrated = true;
  const Scene same = within({}, scene, told.teller());
  EXPECT_EQ(same.force_limit_N, scene.force_limit_N);
  EXPECT_EQ(same.slew_limit_N_per_s, scene.slew_limit_N_per_s);
  EXPECT_EQ(same.fade_s, scene.fade_s);
  EXPECT_EQ(same.current_limit_A, scene.current_limit_A);
  EXPECT_TRUE(same.device_calibrated);
  EXPECT_THAT(told.words, IsEmpty());
}

TEST(ServoCeilings, SayWhatWasAskedForAndWhatIsGiven) {
  Told told;
  Scene scene = held();
  scene.force_limit_N = 8;
  scene.slew_limit_N_per_s = 4000;
  scene.fade_s = 0.01;
  scene.current_limit_A = 6;
  scene.device_calibrated = true;
  const Scene given =
      within({.force_N = 2, .current_A = 3, .slew_N_per_s = 500, .least_fade_s = 0.2, .takes_calibrated = false}, scene,
             told.teller());
  EXPECT_EQ(given.force_limit_N, 2);
  EXPECT_EQ(given.slew_limit_N_per_s, 500);
  EXPECT_EQ(given.fade_s, 0.2);
  EXPECT_EQ(given.current_limit_A, 3);
  EXPECT_FALSE(given.device_calibrated);
  EXPECT_THAT(told.words,
              ElementsAre("the engine asks for a force limit at the handle of 8 N, and gets 2 N (--max-force)",
                          "the engine asks for a slew limit at the handle of 4000 N/s, and gets 500 N/s (--max-slew)",
                          "the engine asks for a fade time of 0.01 s, and gets 0.2 s (--least-fade)",
                          "the engine asks for a current limit of 6 A, and gets 3 A (--max-current)",
                          HasSubstr("palpate servo --calibrated")));
}

// Any scene, any ceilings: at the handle no more than they say, also through a scale of forces, and no less than was
// asked for where that was within.
TEST(ServoCeilings, NoSceneExceedsThem) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    Scene scene = random.pick(4) == 0 ? Scene{} : held();
    scene.force_limit_N = random.logBetween(0.01, 1000);
    scene.slew_limit_N_per_s = random.logBetween(1, 1e9);
    scene.fade_s = random.between(0, 10);
    scene.force_scale = random.logBetween(0.01, 100);
    if (random.pick(2) == 0) scene.current_limit_A = random.between(0, 20);
    ServoCeilings ceilings;
    for (const CeilingRow& row : ceilingRows())
      if (random.pick(3) != 0) ceilings.*row.member = random.between(row.lowest, row.highest);
    const double scale = scene.device == "polhem-v1" ? scene.force_scale : 1;
    const Scene given = within(ceilings, scene, {});
    const auto expect = [](double is, double asked, const std::optional<double>& bound) {
      EXPECT_NEAR(is, bound ? std::min(asked, *bound) : asked, 1e-12 * asked);
    };
    expect(given.force_limit_N * scale, scene.force_limit_N * scale, ceilings.force_N);
    expect(given.slew_limit_N_per_s * scale, scene.slew_limit_N_per_s * scale, ceilings.slew_N_per_s);
    EXPECT_EQ(given.fade_s, std::max(scene.fade_s, ceilings.least_fade_s.value_or(0)));
    EXPECT_EQ(given.current_limit_A.has_value(), scene.current_limit_A.has_value());
    if (scene.current_limit_A) expect(*given.current_limit_A, *scene.current_limit_A, ceilings.current_A);
    const double later_N = random.logBetween(0.01, 1000);
    expect(forceWithin(ceilings, scene, later_N, {}) * scale, later_N * scale, ceilings.force_N);
  }
}

// A kind with boards whose amplifiers bear so much each; 0: its table does not say.
DeviceKind boards(const std::vector<double>& currents_A) {
  DeviceKind kind = *deviceKindNamed("polhem-v1");
  kind.usb.clear();
  for (const double current_A : currents_A) {
    UsbId board{.vendor = 1, .product = static_cast<std::uint16_t>(kind.usb.size()), .values = {}};
    if (current_A > 0) board.values["current_limit_A"] = current_A;
    kind.usb.push_back(std::move(board));
  }
  return kind;
}

// Which board is plugged in is known only later, and what is given is that of each: none may get more than the ceiling,
// and none more than it bears.
TEST(ServoCeilings, BoundTheCurrentOfEachBoard) {
  Told told;
  const ServoCeilings ceilings{.current_A = 4};
  EXPECT_EQ(currentWithin(ceilings, boards({3, 6}), told.teller()), 3);
  EXPECT_EQ(currentWithin(ceilings, boards({6, 5}), told.teller()), 4);
  EXPECT_EQ(currentWithin(ceilings, boards({6, 0}), told.teller()), 0) << "nobody has said what the second one bears";
  EXPECT_EQ(currentWithin(ceilings, boards({4, 6}), told.teller()), 4) << "the ceiling decides, where both agree";
  EXPECT_EQ(currentWithin(ceilings, boards({3, 4}), told.teller()), std::nullopt);
  EXPECT_EQ(currentWithin(ceilings, boards({0, 0}), told.teller()), std::nullopt);
  EXPECT_EQ(currentWithin({}, boards({3, 6}), told.teller()), std::nullopt);
  EXPECT_EQ(currentWithin(ceilings, *deviceKindNamed("spacemouse"), told.teller()), std::nullopt);
  const std::string asks = "the engine asks for a current limit of 6 A, and gets ";
  EXPECT_THAT(told.words,
              ElementsAre(asks + "3 A (the weakest board of this kind bears 3 A)", asks + "4 A (--max-current)",
                          asks + "0 A (the table of this kind does not say what each board bears; give "
                                 "--current-limit)",
                          asks + "4 A (--max-current)"));
  for (unsigned seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    std::vector<double> currents_A(static_cast<std::size_t>(1 + random.pick(4)));
    for (double& current_A : currents_A) current_A = random.pick(5) == 0 ? 0 : random.between(0.1, 20);
    const double ceiling_A = random.between(0.1, 20);
    const std::optional<double> given_A = currentWithin({.current_A = ceiling_A}, boards(currents_A), {});
    for (const double current_A : currents_A) {
      EXPECT_LE(given_A.value_or(current_A), ceiling_A);
      EXPECT_LE(given_A.value_or(current_A), current_A);
    }
  }
}

// Of a flag and the file: the tighter of the two.
TEST(ServoCeilings, TheTighterCounts) {
  ServoCeilings flags;
  EXPECT_TRUE(setCeiling(flags, "--max-force", "3"));
  EXPECT_TRUE(setCeiling(flags, "--least-fade", "0.1"));
  EXPECT_TRUE(setCeiling(flags, "--max-slew", "1e3"));
  EXPECT_FALSE(setCeiling(flags, "--max-speed", "3"));
  const ServoCeilings file = readCeilings("max_force_N = 2\nleast_fade_s = 0.3\nmax_current_A = 4.5\n", "servo.toml");
  const ServoCeilings both{.force_N = 2, .current_A = 4.5, .slew_N_per_s = 1000, .least_fade_s = 0.3};
  EXPECT_EQ(tighter(flags, file), both);
  EXPECT_EQ(tighter(file, flags), both);
  EXPECT_FALSE(tighter({.takes_calibrated = false}, {}).takes_calibrated);
}

TEST(ServoCeilings, RefuseWhatIsNone) {
  const auto refusal = [](const std::string& text) {
    return refusalOf([&] { static_cast<void>(readCeilings(text, "a.toml")); });
  };
  EXPECT_EQ(refusal(""), kNoRefusal);
  EXPECT_EQ(refusal("max_force_N = 5"), kNoRefusal);
  EXPECT_THAT(refusal("\nmax_force = 5"), HasSubstr("a.toml:2: max_force: a servo has no such ceiling"));
  EXPECT_THAT(refusal("max_force_N = \"5\""), HasSubstr("it is no number"));
  EXPECT_THAT(refusal("max_force_N = true"), HasSubstr("it is no number"));
  EXPECT_THAT(refusal("max_force_N = -1"), HasSubstr("a.toml:1: max_force_N: -1 cannot be used"));
  EXPECT_THAT(refusal("max_force_N = nan"), HasSubstr("cannot be used"));
  EXPECT_THAT(refusal("max_force_N = "), HasSubstr("a.toml:1:"));
  ServoCeilings ceilings;
  for (const char* value : {"", "x", "3N", "nan", "-3", "1e9"})
    EXPECT_NE(refusalOf([&] { static_cast<void>(setCeiling(ceilings, "--max-force", value)); }), kNoRefusal) << value;
  EXPECT_FALSE(ceilings.force_N);
}

TEST(ServoCeilings, AreThoseOfTheUsersFile) {
  EXPECT_EQ(ceilingsOfFile({}), ServoCeilings{});
  EXPECT_EQ(ceilingsOfFile("/nowhere/servo.toml"), ServoCeilings{});
  const std::string file = testing::TempDir() + "servo_ceilings_test.toml";
  std::ofstream(file) << "max_slew_N_per_s = 900\n";
  EXPECT_EQ(ceilingsOfFile(file).slew_N_per_s, 900);
}

// Where nobody can say whether there are ceilings there may be some. As root every folder can be searched; a folder
// that is a file, links in a ring and a link that leads nowhere are as much in the way.
TEST(ServoCeilings, RefuseAFileOfWhichNothingCanBeSaid) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "max_force_N = 2\n";
  fs::create_symlink("ring", folder.path() / "ring");
  fs::create_symlink("nowhere.toml", folder.path() / "servo.toml");
  fs::create_directory(folder.path() / "closed");
  std::ofstream(folder.path() / "closed" / "servo.toml") << "max_force_N = 2\n";
  fs::permissions(folder.path() / "closed", fs::perms::none);
  const auto refusal = [&](const fs::path& file, Error::Code code) {
    return refusalOf([&] { static_cast<void>(ceilingsOfFile(folder.path() / file)); }, code);
  };
  EXPECT_THAT(refusal("file/servo.toml", Error::Code::kIo), HasSubstr("Not a directory"));
  EXPECT_THAT(refusal("ring/servo.toml", Error::Code::kIo), HasSubstr("Too many levels of symbolic links"));
  EXPECT_THAT(refusal("servo.toml", Error::Code::kNotFound), HasSubstr("cannot be opened"));
  fs::permissions(folder.path(), fs::perms(0755));
  {
    const AsNobody nobody;
    ASSERT_TRUE(nobody.isSet());
    EXPECT_THAT(refusal("closed/servo.toml", Error::Code::kIo), HasSubstr("Permission denied"));
  }
  fs::permissions(folder.path() / "closed", fs::perms::owner_all);
}

// An engine waits for as long as any servo may need: by a file of the servo's own a force may fade for 10 s, and a
// slew of 1 N/s takes 8 s for 8 N.
TEST(ServoCeilings, BoundTheLongestFadeThatAnEngineWaitsFor) {
  EXPECT_EQ(longestFade_s(8, 0.1, 4000), 10 + 8);
  EXPECT_EQ(longestFade_s(8, 12, 0.5), 12 + 16);
  Scene scene = held();  // an arm of 5 N
  EXPECT_EQ(longestFade_s(scene), 10 + 5);
  scene.slew_limit_N_per_s = 2;
  scene.force_scale = 0.1;
  EXPECT_EQ(longestFade_s(scene), 10 + 25);
  EXPECT_EQ(longestFade_s(Scene{}), 10) << "nobody holds it";
  for (const CeilingRow& row : ceilingRows()) {
    ServoCeilings ceilings;
    ceilings.*row.member = row.is_floor ? row.highest : row.lowest;
    const Scene given = within(ceilings, held(), {});
    const double fade_s = given.fade_s + std::min(given.force_limit_N, 5.0) / given.slew_limit_N_per_s;
    EXPECT_LE(fade_s, longestFade_s(held())) << row.flag;
  }
}

// Of the device that the servo's process has told of. The loop's limits are the scene's: with half a newton at the
// handle for one of the scene, 16 N and 2 N/s of the scene are 8 N and 1 N/s there.
TEST(ServoCeilings, BoundTheLongestFadeOfADeviceThatIsThere) {
  DeviceLimits limits;
  limits.force_limit_N = 16;
  limits.is_held = true;
  SafetyParameters safety;
  safety.slew_limit_N_per_s = 2;
  EXPECT_EQ(longestFade_s(limits, 0.5, safety), 10 + 8);
  limits.is_held = false;
  limits.force_limit_N = 1000;
  EXPECT_EQ(longestFade_s(limits, 1, safety), 10) << "it has no hand to bring to rest";
}

// However weak the forces and slow the slew that are asked for: one that hangs is given up after a minute.
TEST(ServoCeilings, NobodyWaitsForMoreThanAMinute) {
  Scene scene = held();
  scene.slew_limit_N_per_s = 1;
  scene.force_scale = 0.001;
  EXPECT_EQ(longestFade_s(scene), kMostFade_s);
  DeviceLimits limits;
  limits.force_limit_N = 1000;
  limits.is_held = true;
  EXPECT_EQ(longestFade_s(limits, 1, SafetyParameters{}), kMostFade_s);
  EXPECT_EQ(longestFade_s(50, 10, 1), kMostFade_s) << "all that a ceiling may ask for an arm of 50 N";
}

// A servo's side in a thread, and an engine that asks for 8 N when it makes the device and the loop, and for 50 N
// later.
TEST(ServoCeilings, BoundWhatAnEngineMakesAndChanges) {
  auto [ours, theirs] = channelPair();
  std::vector<std::string> told;
  std::jthread host([&told, theirs = std::move(theirs)]() mutable {
    ServoHost(false, "", [&told](const std::string& words) { told.push_back(words); },
              {.force_N = 2, .least_fade_s = 0.3})
        .serve(std::move(theirs));
  });
  Scene scene;
  scene.simulated_clock = true;
  scene.force_limit_N = 8;
  {
    RemoteServo servo(std::move(ours), {.scene = scene, .box = {}, .window_samples = 64});
    EXPECT_EQ(servo.device().limits().force_limit_N, 2);
    RigSettings settings;
    settings.force_limit_N = 5;
    LoopParameters loop;
    loop.ticks = 20;
    servo.makeLoop(loop, settings, {}, makeAlgorithm(settings, {}));
    const LoopResult result = servo.runSimulated([&](std::int64_t tick, std::int64_t) {
      if (tick == 5) servo.give({.force_limit_N = 50}, settings);
    });
    EXPECT_EQ(result.ticks_run, 20);
  }
  host.join();
  EXPECT_THAT(
      told,
      ElementsAre(HasSubstr("of 8 N, and gets 2 N (--max-force)"), HasSubstr("of 0.1 s, and gets 0.3 s (--least-fade)"),
                  HasSubstr("of 5 N, and gets 2 N (--max-force)"), HasSubstr("of 50 N, and gets 2 N (--max-force)")));
}

}  // namespace servo_ceilings_test
}  // namespace palpate
