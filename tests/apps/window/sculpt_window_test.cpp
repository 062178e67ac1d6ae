// SPDX-License-Identifier: Apache-2.0
// The window on a desktop, with a person's mouse and keys. Under the validation layer.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/sculpt/session_folders.hpp"
#include "desktop.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/replay.hpp"
#include "engine/journal/volume_identity.hpp"

namespace palpate {
namespace sculpt_window_test {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kBall = "phantom:sphere?size=48";
constexpr int kWidth = 1280, kHeight = 720;
// Where the picture is, and its middle.
constexpr Rectangle kPicture{300, 0, 690, 634};
constexpr int kMiddleX = 645, kMiddleY = 317;

class SculptWindow : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Desktop::missing(); !why.empty()) GTEST_SKIP() << why;
    desktop = std::make_unique<Desktop>(kWidth, kHeight);
  }
  [[nodiscard]] std::filesystem::path home() const { return folder.path() / "home"; }
  [[nodiscard]] std::filesystem::path journals() const { return home() / ".local/state/palpate/journals"; }
  void start() {
    program = std::make_unique<Started>(desktop->display(), home(), std::vector<std::string>{"sculpt", kBall});
  }
  // Until the ball fills the middle of the picture, and nothing moves any more.
  bool showsBall() {
    return waitUntil([&] {
             if (!program->runs()) return true;
             const Screen screen = desktop->look();
             const auto pixel = screen.at(kMiddleX, kMiddleY);
             return pixel[0] > 90 && pixel[0] > pixel[2] + 10;  // bone, and no panel
           }) &&
           program->runs() && movesOff();
  }
  // Off the ball; the tool is drawn where the pointer is.
  bool movesOff() {
    desktop->moves(kMiddleX, kPicture.height - 5);
    return isStill();
  }
  bool isStill() {
    Screen before = desktop->look();
    int still = 0;
    return waitUntil([&] {
      Screen now = desktop->look();
      still = differing(before, now, kPicture) == 0 ? still + 1 : 0;
      before = std::move(now);
      return still >= 20;
    });
  }
  // Ends as a user's `kill` does, and nothing was wrong.
  void endsWell() {
    program->signals(SIGTERM);
    EXPECT_EQ(program->ends(), 0) << program->said();
    EXPECT_THAT(program->said(), Not(HasSubstr("alidation")));
    EXPECT_THAT(program->said(), Not(HasSubstr("VUID")));
  }

  TemporaryFolder folder;
  std::unique_ptr<Desktop> desktop;
  std::unique_ptr<Started> program;
};

TEST_F(SculptWindow, ShowsTheVolumeAndEndsAsItIsTold) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  EXPECT_TRUE(std::filesystem::exists(journals()));
  endsWell();
  EXPECT_TRUE(std::filesystem::is_empty(journals()));  // nothing was edited
  EXPECT_TRUE(std::filesystem::exists(home() / ".config/palpate/sculpt.json"));
}

// A stroke changes the picture where it was made and nowhere else; undo brings the old one back, to the pixel; the
// saved file is what the journal leads to.
TEST_F(SculptWindow, DrillsUndoesAndSaves) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  // The brush, and as far again as hollows are shaded: 8 voxels of some 12 pixels.
  const Rectangle stroke{kMiddleX - 160, kMiddleY - 160, 380, 320};
  const auto drill = [&] {
    desktop->drags(kMiddleX, kMiddleY, kMiddleX + 60, kMiddleY, 1);
    desktop->moves(kMiddleX, kPicture.height - 5);
    return isStill();
  };
  ASSERT_TRUE(drill());
  const Screen drilled = desktop->look();
  // The tool is drawn where the pointer is, before and after.
  const Rectangle upper{kPicture.x, 0, kPicture.width, kPicture.height - 80};
  EXPECT_GT(differing(before, drilled, stroke), 200);
  EXPECT_EQ(differing(before, drilled, upper, stroke), 0);

  desktop->does({"key", "ctrl+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), upper) == 0; }));
  desktop->does({"key", "ctrl+shift+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), upper) == 0; }));

  const std::string file = (folder.path() / "drilled.vdb").string();
  desktop->does({"mousemove", "100", "64", "click", "1"});
  desktop->does({"type", "--delay", "20", file});
  desktop->does({"key", "Return"});
  ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); })) << program->said();
  std::vector<std::filesystem::path> sessions;
  for (const auto& entry : std::filesystem::directory_iterator(journals())) sessions.push_back(entry.path());
  ASSERT_EQ(sessions.size(), 1U);
  Volume replayed = loadVolume(kBall);
  replay(readJournal(sessions[0]), replayed);
  EXPECT_EQ(contentHash(loadVolume(file)), contentHash(replayed));
  endsWell();
  EXPECT_FALSE(std::filesystem::exists(sessions[0]));  // all of it is saved
  EXPECT_TRUE(std::filesystem::exists(home() / ".config/palpate/sculpt.json"));
}

// Dragging with the right button turns the ball's light but not its outline; the wheel makes it larger.
TEST_F(SculptWindow, TurnsAndZooms) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  const auto ball = [](const Screen& screen) {
    int pixels = 0;
    for (int y = 0; y < kPicture.height; y += 4) {
      for (int x = kPicture.x; x < kPicture.x + kPicture.width; x += 4) pixels += screen.at(x, y)[0] > 60;
    }
    return pixels;
  };
  desktop->moves(kMiddleX, kMiddleY);
  desktop->does({"click", "--repeat", "3", "--delay", "50", "5"});
  desktop->moves(kMiddleX, kPicture.height - 5);
  EXPECT_TRUE(waitUntil([&] { return ball(desktop->look()) < 0.7 * ball(before); }));
  desktop->does({"key", "Home"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), {300, 0, 690, 540}) == 0; }));
  endsWell();
}

// Killed in the middle of a stroke: the next start offers the edits, and makes them again.
TEST_F(SculptWindow, IsRecoveredAfterItWasKilled) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  desktop->drags(kMiddleX, kMiddleY, kMiddleX + 60, kMiddleY, 1);
  desktop->moves(kMiddleX, kPicture.height - 5);
  ASSERT_TRUE(isStill());
  program->signals(SIGKILL);
  EXPECT_EQ(program->ends(), 256 + SIGKILL);
  const std::vector<LeftSession> left = leftSessions(journals());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].volume, kBall);
  Volume replayed = loadVolume(kBall);
  replay(readJournal(left[0].folder), replayed);

  start();
  // The question is in the middle of the window; its first button is reached by the keyboard.
  ASSERT_TRUE(waitUntil([&] {
    const Screen screen = desktop->look();
    return !program->runs() || differing(screen, before, {440, 320, 100, 80}) > 500;
  }));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  desktop->does({"mousemove", "505", "374", "click", "1"});
  ASSERT_TRUE(showsBall()) << program->said();
  EXPECT_GT(differing(before, desktop->look(), {kMiddleX - 40, kMiddleY - 40, 140, 80}), 200);
  EXPECT_TRUE(leftSessions(journals()).empty());  // the new session has them
  endsWell();
  const std::vector<LeftSession> again = leftSessions(journals());  // nothing was saved
  ASSERT_EQ(again.size(), 1U);
  Volume twice = loadVolume(kBall);
  replay(readJournal(again[0].folder), twice);
  EXPECT_EQ(contentHash(twice), contentHash(replayed));
}

// One line that says what to use instead; the volume is not even looked for.
TEST(SculptWithoutADisplay, SaysWhatToUseInstead) {
  const TemporaryFolder folder;
  Started program("", folder.path() / "home", {"sculpt", "no such file.nii"});
  EXPECT_GT(program.ends(), 0);
  EXPECT_THAT(program.said(),
              testing::AllOf(HasSubstr("no display"), HasSubstr("palpate touch"), HasSubstr("palpate render")));
}

}  // namespace sculpt_window_test
}  // namespace palpate
