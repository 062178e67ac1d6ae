// SPDX-License-Identifier: Apache-2.0
// `palpate sculpt` of a ball on a desktop of 1280 x 720, under the validation layer.
#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "desktop.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/replay.hpp"

namespace palpate {

inline constexpr const char* kBall = "phantom:sphere?size=48";
inline constexpr int kWidth = 1280, kHeight = 720;
// Where the picture is, and its middle.
inline constexpr Rectangle kPicture{300, 0, 690, 634};
inline constexpr int kMiddleX = 645, kMiddleY = 317;
// The picture without its lowest rows, where the pointer rests.
inline constexpr Rectangle kUpper{kPicture.x, 0, kPicture.width, kPicture.height - 80};
// Words at the bottom.
inline constexpr Rectangle kMessage{0, 662, 980, 50};
// Fields and buttons, while nothing is folded or scrolled.
inline constexpr int kFileX = 100, kSaveY = 63, kOpenY = 92;
inline constexpr int kIsovalueX = 95, kIsovalueY = 449;
inline constexpr int kStrengthX = 95, kStrengthY = 266;
inline constexpr int kStiffnessX = 1078, kStiffnessY = 79;
inline constexpr int kSecondX = 21, kSecondY = 622;
inline constexpr int kFirstEditX = 1100, kFirstEditY = 423;  // of the list: blue once there is one

inline int ballPixels(const Screen& screen, const Rectangle& within = kUpper) {
  int pixels = 0;
  for (int y = within.y; y < within.y + within.height; ++y) {
    for (int x = within.x; x < within.x + within.width; ++x) pixels += screen.at(x, y)[0] > 60;
  }
  return pixels;
}

class OnADesktop : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Desktop::missing(); !why.empty()) GTEST_SKIP() << why;
    desktop = std::make_unique<Desktop>(kWidth, kHeight);
  }
  [[nodiscard]] std::filesystem::path home() const { return folder.path() / "home"; }
  [[nodiscard]] std::filesystem::path journals() const { return home() / ".local/state/palpate/journals"; }
  void start() {
    std::vector<std::string> words = {"sculpt"};
    words.insert(words.end(), shows.begin(), shows.end());
    words.insert(words.end(), options.begin(), options.end());
    program = std::make_unique<Started>(desktop->display(), home(), words, more, runner);
  }
  // The file of settings.
  [[nodiscard]] std::string settings() const {
    std::ifstream file(home() / ".config/palpate/sculpt.json");
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  // The only session's journal.
  [[nodiscard]] std::filesystem::path journal() const {
    std::vector<std::filesystem::path> sessions;
    for (const auto& entry : std::filesystem::directory_iterator(journals())) sessions.push_back(entry.path());
    return sessions.size() == 1 ? sessions[0] : std::filesystem::path();
  }
  // What the ball is after the journal's edits.
  [[nodiscard]] static Volume replayed(const std::filesystem::path& journal) {
    Volume volume = loadVolume(kBall);
    replay(readJournal(journal), volume);
    return volume;
  }
  // A groove to the right of the middle.
  bool drills() {
    desktop->drags(kMiddleX, kMiddleY, kMiddleX + 60, kMiddleY, 1);
    return movesOff();
  }
  // Clicks at a field, and fills it.
  void enters(int x, int y, const std::string& text) const {
    desktop->does({"mousemove", std::to_string(x), std::to_string(y), "click", "1", "key", "ctrl+a"});
    desktop->does({"type", "--delay", "20", text});
    desktop->does({"key", "Return"});
  }
  // A slider's value by keyboard.
  void sets(int x, int y, const std::string& value) const {
    desktop->does({"mousemove", std::to_string(x), std::to_string(y), "keydown", "ctrl"});
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    desktop->does({"click", "1", "keyup", "ctrl"});
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    desktop->does({"key", "ctrl+a", "type", "--delay", "20", value});
    desktop->does({"key", "Return"});
  }
  // Until the ball fills the middle of the picture, and nothing moves any more.
  bool showsBall() {
    return waitUntil([&] {
             if (!program->runs()) return true;
             const Screen screen = desktop->look();
             const auto pixel = screen.at(kMiddleX - 80, kMiddleY);  // beside what the tests drill, which is darker
             return pixel[0] > 90 && pixel[0] > pixel[2] + 10;       // bone, and no panel
           }) &&
           program->runs() && movesOff();
  }
  // Off the ball; the tool is drawn where the pointer is.
  bool movesOff() {
    desktop->moves(kMiddleX, kPicture.height - 5);
    return isStill();
  }
  // Words, beside those of this screen.
  bool saysSomething(const Screen& before) {
    return waitUntil([&] { return !program->runs() || differing(before, desktop->look(), kMessage) > 50; }) &&
           program->runs();
  }
  // On a busy machine a picture can come a second after the last one: still is also that the program has nothing to do
  // in most of the looks. In some it has, as its figures are drawn ten times a second.
  bool isStill() {
    Screen before = desktop->look();
    int still = 0, busy = 0;
    return waitUntil([&] {
      Screen now = desktop->look();
      const bool same = differing(before, now, kPicture) == 0;
      still = same ? still + 1 : 0;
      busy = same ? busy + static_cast<int>(program->computes()) : 0;
      before = std::move(now);
      if (still < 20) return false;
      if (busy <= 10) return true;
      still = busy = 0;
      return false;
    });
  }
  // Ends as a user's `kill` does, and nothing was wrong.
  void endsWell() {
    program->signals(SIGTERM);
    EXPECT_EQ(program->ends(), 0) << program->said();
    EXPECT_THAT(program->said(), testing::Not(testing::HasSubstr("alidation")));
    EXPECT_THAT(program->said(), testing::Not(testing::HasSubstr("VUID")));
  }

  TemporaryFolder folder;
  std::unique_ptr<Desktop> desktop;
  std::unique_ptr<Started> program;
  Environment more = {};  // of the program
  std::vector<std::string> shows = {kBall};
  std::vector<std::string> options = {};  // of `palpate sculpt`
  std::vector<std::string> runner = {};   // that starts it
};

}  // namespace palpate
