// SPDX-License-Identifier: Apache-2.0
// The window on a desktop, with a person's mouse and keys. Under the validation layer.
#include "sculpt_window.hpp"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/sculpt/session_folders.hpp"
#include "engine/journal/volume_identity.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace sculpt_window_test {

using testing::HasSubstr;

TEST_F(OnADesktop, ShowsTheVolumeAndEndsAsItIsTold) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  EXPECT_TRUE(std::filesystem::exists(journals()));
  endsWell();
  EXPECT_TRUE(std::filesystem::is_empty(journals()));  // nothing was edited
  EXPECT_TRUE(std::filesystem::exists(home() / ".config/palpate/sculpt.json"));
}

// A stroke changes the picture where it was made and nowhere else; undo brings the old one back, to the pixel; the
// saved file is what the journal leads to, also where another file could not be written before, which is said.
TEST_F(OnADesktop, DrillsUndoesAndSaves) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  // The brush, and as far again as hollows are shaded: 8 voxels of some 12 pixels.
  const Rectangle stroke{kMiddleX - 160, kMiddleY - 160, 380, 320};
  ASSERT_TRUE(drills());
  const Screen drilled = desktop->look();
  // The tool is drawn where the pointer is, before and after.
  const Rectangle upper{kPicture.x, 0, kPicture.width, kPicture.height - 80};
  EXPECT_GT(differing(before, drilled, stroke), 200);
  EXPECT_EQ(differing(before, drilled, upper, stroke), 0);

  desktop->does({"key", "ctrl+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), upper) == 0; }));
  desktop->does({"key", "ctrl+shift+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), upper) == 0; }));

  const Screen unsaved = desktop->look();
  enters(kFileX, kSaveY, "/nowhere/a.vdb");
  EXPECT_TRUE(saysSomething(unsaved)) << program->said();
  const std::string file = (folder.path() / "drilled.vdb").string();
  enters(kFileX, kSaveY, file);
  ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); })) << program->said();
  const std::filesystem::path session = journal();
  ASSERT_FALSE(session.empty());
  EXPECT_EQ(contentHash(loadVolume(file)), contentHash(replayed(session)));
  endsWell();
  EXPECT_FALSE(std::filesystem::exists(session));  // all of it is saved
  EXPECT_TRUE(std::filesystem::exists(home() / ".config/palpate/sculpt.json"));
}

// Dragging with the right button takes the groove elsewhere, and a key brings it back; the wheel makes the ball
// smaller, and another key as it was.
TEST_F(OnADesktop, TurnsAndZooms) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  ASSERT_TRUE(drills());
  const Screen before = desktop->look();
  desktop->drags(kMiddleX - 150, kMiddleY + 200, kMiddleX - 60, kMiddleY + 220, 3);
  ASSERT_TRUE(movesOff());
  EXPECT_GT(differing(before, desktop->look(), {300, 0, 690, 540}), 200);
  desktop->does({"key", "1"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), {300, 0, 690, 540}) == 0; }));
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
TEST_F(OnADesktop, IsRecoveredAfterItWasKilled) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  ASSERT_TRUE(drills());
  program->signals(SIGKILL);
  EXPECT_EQ(program->ends(), 256 + SIGKILL);
  const std::vector<LeftSession> left = leftSessions(journals());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].volume, kBall);
  const std::uint64_t content = contentHash(replayed(left[0].folder));

  // The question is in the middle of the window, and its first button in the question. The killed one's window goes
  // first.
  const Rectangle question{440, 320, 100, 80};
  ASSERT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) > 10000; }));
  const Screen bare = desktop->look();
  start();
  Screen asked = bare;
  ASSERT_TRUE(waitUntil([&] {
    const Screen last = std::exchange(asked, desktop->look());
    return !program->runs() || (differing(asked, bare, question) > 500 && differing(asked, last, question) == 0);
  }));
  desktop->does({"mousemove", "505", "374", "click", "1"});
  ASSERT_TRUE(waitUntil([&] { return differing(asked, desktop->look(), question) > 500; })) << program->said();
  ASSERT_TRUE(showsBall()) << program->said();
  EXPECT_GT(differing(before, desktop->look(), {kMiddleX - 40, kMiddleY - 40, 140, 80}), 200);
  EXPECT_TRUE(leftSessions(journals()).empty());  // the new session has them
  endsWell();
  const std::vector<LeftSession> again = leftSessions(journals());  // nothing was saved
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(contentHash(replayed(again[0].folder)), content);
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
