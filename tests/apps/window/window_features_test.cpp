// SPDX-License-Identifier: Apache-2.0
// What the window can do beside strokes: pictures of itself, recordings, the keyboard alone, other isovalues, cuts,
// other sizes.
#include <algorithm>
#include <chrono>
#include <thread>

#include <cairo/cairo.h>

#include "apps/path/path_csv.hpp"
#include "apps/sculpt/brush_choice.hpp"
#include "apps/sculpt/session_folders.hpp"
#include "engine/journal/volume_identity.hpp"
#include "sculpt_window.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace window_features_test {

// The only file of the folder with this suffix.
std::filesystem::path fileIn(const std::filesystem::path& folder, const std::string& suffix) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == suffix) found.push_back(entry.path());
  }
  return found.size() == 1 ? found[0] : std::filesystem::path();
}

// With a row for each tick.
std::vector<TimedPoint> recordedPath(const std::filesystem::path& file) {
  std::vector<TimedPoint> path = readPathCsv(file);
  EXPECT_GT(path.size(), 500U);
  EXPECT_EQ(path.front().time_s, 0);
  EXPECT_NEAR(path.back().time_s, static_cast<double>(path.size() - 1) * 1e-3, 1e-9);
  return path;
}

TEST_F(OnADesktop, WritesAPictureOfItself) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  desktop->does({"key", "F12"});
  ASSERT_TRUE(waitUntil([&] { return !fileIn(home(), ".png").empty(); })) << program->said();
  cairo_surface_t* picture = cairo_image_surface_create_from_png(fileIn(home(), ".png").c_str());
  ASSERT_EQ(cairo_image_surface_get_width(picture), kWidth);
  ASSERT_EQ(cairo_image_surface_get_height(picture), kHeight);
  int differing = 0;
  for (int y = 0; y < kUpper.height; ++y) {
    const unsigned char* row = cairo_image_surface_get_data(picture) + y * cairo_image_surface_get_stride(picture);
    for (int x = 0; x < kUpper.x + kUpper.width; ++x) {
      const auto on_screen = before.at(x, y);
      for (int i = 0; i < 3; ++i)
        differing += std::abs(row[4 * x + i] - on_screen[static_cast<std::size_t>(2 - i)]) > 2;
    }
  }
  cairo_surface_destroy(picture);
  EXPECT_EQ(differing, 0);
  endsWell();
}

// The tool hovers across the ball; what was recorded is a path that crosses it. That of a stroke is looked at below.
TEST_F(OnADesktop, RecordsTheToolsWay) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  desktop->moves(kMiddleX - 100, kMiddleY);
  ASSERT_TRUE(isStill());
  desktop->does({"key", "F9"});
  for (int x = -100; x <= 100; x += 20) {
    desktop->moves(kMiddleX + x, kMiddleY);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  ASSERT_TRUE(isStill());
  desktop->does({"key", "F9"});
  endsWell();  // the file is whole by then
  const std::filesystem::path file = fileIn(home(), ".csv");
  ASSERT_FALSE(file.empty());
  const std::vector<TimedPoint> path = recordedPath(file);
  EXPECT_GT((path.back().p_W - path.front().p_W).norm(), 5e-3);
}

// What was drilled, and where: the middle of what changed, weighted by how much [m].
struct Hollow {
  double amount = 0;
  Vec3 middle_W = Vec3::Zero();
};
Hollow hollow(const Volume& before, const Volume& after) {
  Hollow out;
  const std::vector<float> a = before.toDense(), b = after.toDense();
  const Vec3i size = before.size();
  std::size_t at = 0;
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); ++x, ++at) {
        const double change = std::abs(static_cast<double>(b[at]) - a[at]);
        out.amount += change;
        out.middle_W += change * before.lattice().toWorld(Vec3(x, y, z));
      }
    }
  }
  out.middle_W /= out.amount;
  return out;
}

// What was drilled while it was recorded is drilled again by `palpate touch`, in the same place. How deep depends on
// how far the real servo's windows lagged behind the hand, by half on a busy machine: the replay's do not lag. The
// place may differ by what the hand yields to the force and by that lag: by less than the brush's radius. The record is
// a path with a row for each tick, from below the ball onto it.
TEST_F(OnADesktop, RecordsStrokesThatAreReplayed) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  desktop->does({"key", "F9"});
  ASSERT_TRUE(drills());
  desktop->does({"key", "F9"});
  endsWell();
  const std::filesystem::path file = fileIn(home(), ".csv");
  ASSERT_FALSE(file.empty());
  const std::vector<TimedPoint> path = recordedPath(file);
  double farthest_m = 0;
  for (const TimedPoint& point : path) farthest_m = std::max(farthest_m, (point.p_W - path.front().p_W).norm());
  EXPECT_GT(farthest_m, 5e-3);
  const Volume ball = loadVolume(kBall);
  const std::string out = (folder.path() / "again.nrrd").string();
  Started again("", home(),
                {"touch", kBall, "--path", file.string(), "--clock", "simulated", "--picture", "off", "--save", out,
                 "--out", (folder.path() / "out").string()});
  ASSERT_EQ(again.ends(), 0) << again.said();
  const Hollow by_hand = hollow(ball, replayed(journal())), by_replay = hollow(ball, loadVolume(out));
  ASSERT_GT(by_hand.amount, 0);
  EXPECT_GT(by_replay.amount, 0.25 * by_hand.amount);
  EXPECT_LT(by_replay.amount, 4 * by_hand.amount);
  EXPECT_LT((by_replay.middle_W - by_hand.middle_W).norm(), BrushChoice().radius_m);
}

// Without a mouse: the pointer begins in the middle of the picture.
TEST_F(OnADesktop, DrillsAndTurnsByTheKeyboardAlone) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  desktop->does({"mousemove", "100", "680"});
  ASSERT_TRUE(isStill());
  desktop->does({"keydown", "space"});
  ASSERT_TRUE(waitUntil([&] { return desktop->look().at(kFirstEditX, kFirstEditY)[2] > 90; }));  // an edit in the list
  desktop->does({"keydown", "Right"});
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  desktop->does({"keyup", "Right", "keyup", "space"});
  ASSERT_TRUE(movesOff());
  const Screen drilled = desktop->look();
  EXPECT_GT(differing(before, drilled, {kMiddleX - 60, kMiddleY - 60, 200, 120}), 100);
  desktop->does({"key", "ctrl+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  desktop->does({"key", "ctrl+shift+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kUpper) == 0; }));
  desktop->does({"keydown", "ctrl", "keydown", "Left"});
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  desktop->does({"keyup", "Left", "keyup", "ctrl"});
  ASSERT_TRUE(movesOff());
  EXPECT_GT(differing(drilled, desktop->look(), kUpper), 100);  // the groove is elsewhere
  desktop->does({"key", "1"});
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kUpper) == 0; }));
  endsWell();
}

// A groove is deeper where the force is larger, and where the brush is stronger. One that is mirrored is there twice.
TEST_F(OnADesktop, DrillsAsItsSlidersSay) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  constexpr int kRim = 70;  // of a brush in the middle
  const Rectangle left{kPicture.x, 0, kMiddleX - kPicture.x - kRim, kUpper.height};
  const Rectangle right{kMiddleX + kRim, 0, kPicture.x + kPicture.width - kMiddleX - kRim, kUpper.height};
  const auto groove = [&](const Rectangle& within) {
    EXPECT_TRUE(drills());
    const int pixels = differing(before, desktop->look(), within);
    desktop->does({"key", "ctrl+z"});
    EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
    return pixels;
  };
  const int as_it_is = groove(kUpper);
  EXPECT_GT(as_it_is, 100);
  sets(kStiffnessX, kStiffnessY, "20");
  EXPECT_LT(groove(kUpper), 0.7 * as_it_is);
  sets(kStiffnessX, kStiffnessY, "500");
  sets(kStrengthX, kStrengthY, "0.02");
  EXPECT_LT(groove(kUpper), 0.7 * as_it_is);
  sets(kStrengthX, kStrengthY, "0.5");
  EXPECT_LT(groove(left), 10);
  desktop->does({"key", "x"});
  ASSERT_TRUE(drills());
  const Screen mirrored = desktop->look();
  EXPECT_GT(differing(before, mirrored, left), 100);
  EXPECT_GT(differing(before, mirrored, right), 100);
  endsWell();
}

// A second surface outside the first is seen around the ball, and gone again.
TEST_F(OnADesktop, ShowsASecondSurface) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  desktop->does({"mousemove", std::to_string(kSecondX), std::to_string(kSecondY), "click", "1"});
  const Rectangle beside{kMiddleX + 255, kMiddleY - 5, 6, 10};
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), beside) == beside.width * beside.height; }));
  desktop->does({"mousemove", std::to_string(kSecondX), std::to_string(kSecondY), "click", "1"});
  ASSERT_TRUE(movesOff());
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  endsWell();
}

TEST_F(OnADesktop, GoesToAnotherIsovalue) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const int before = ballPixels(desktop->look());
  enters(kIsovalueX, kIsovalueY, "500");  // two voxels below the ball's surface
  ASSERT_TRUE(movesOff());
  EXPECT_TRUE(waitUntil([&] { return ballPixels(desktop->look()) < 0.95 * before; }));
  endsWell();
}

// Half of the ball is cut away; what is left is as it was, but for the shade of hollows beside the cut.
TEST_F(OnADesktop, CutsTheBall) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  desktop->does({"mousemove", "150", "600", "click", "--repeat", "20", "--delay", "20", "5"});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  desktop->does({"mousemove", "150", "612", "click", "1"});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  desktop->does({"click", "--repeat", "20", "--delay", "20", "5"});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  desktop->does({"mousemove", "87", "496", "click", "1"});
  EXPECT_TRUE(waitUntil([&] { return ballPixels(desktop->look()) < 0.6 * ballPixels(before); }));
  ASSERT_TRUE(movesOff());
  const Screen cut = desktop->look();
  const Rectangle left{kUpper.x, 0, kMiddleX - kUpper.x - 120, kUpper.height};
  const Rectangle right{kMiddleX + 120, 0, kUpper.x + kUpper.width - kMiddleX - 120, kUpper.height};
  const bool left_stays = ballPixels(cut, left) > 0;
  EXPECT_EQ(ballPixels(cut, left_stays ? right : left), 0);
  const Rectangle left_half{kUpper.x, 0, kMiddleX - kUpper.x, kUpper.height};
  const Rectangle right_half{kMiddleX, 0, kUpper.x + kUpper.width - kMiddleX, kUpper.height};
  const int half = ballPixels(before, left_stays ? left_half : right_half);
  EXPECT_NEAR(ballPixels(cut), half, 0.03 * half);
  EXPECT_EQ(differing(before, cut, left_stays ? left : right), 0);
  endsWell();
}

TEST_F(OnADesktop, IsDrawnAnewAtAnotherSize) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  const auto sized = [&](const std::string& width, const std::string& height) {
    desktop->does({"search", "--onlyvisible", "--name", "Palpate", "windowsize", width, height});
  };
  sized("1000", "500");
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) > 1000; }));
  desktop->moves(500, 380);
  ASSERT_TRUE(isStill());
  EXPECT_GT(ballPixels(desktop->look(), {300, 0, 400, 380}), 1000);
  sized("1280", "720");
  ASSERT_TRUE(movesOff());
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  desktop->does({"search", "--onlyvisible", "--name", "Palpate", "windowunmap"});
  std::this_thread::sleep_for(std::chrono::seconds(1));
  ASSERT_TRUE(program->runs()) << program->said();
  desktop->does({"search", "--name", "Palpate", "windowmap"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  sized("1100", "660");
  ASSERT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) > 1000; }));
  endsWell();
  EXPECT_THAT(settings(), testing::AllOf(testing::HasSubstr("\"width\": 1100"), testing::HasSubstr("\"height\": 660")));
}

TEST_F(OnADesktop, LosesNothingWhenItIsEndedInTheMiddleOfAStroke) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  desktop->moves(kMiddleX, kMiddleY);
  desktop->does({"mousedown", "1"});
  ASSERT_TRUE(waitUntil([&] { return desktop->look().at(kFirstEditX, kFirstEditY)[2] > 90; }));  // an edit in the list
  endsWell();
  const std::vector<LeftSession> left = leftSessions(journals());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_GT(left[0].edits, 0U);
  EXPECT_EQ(left[0].damage, "");
  EXPECT_NE(contentHash(replayed(left[0].folder)), contentHash(loadVolume(kBall)));
}

}  // namespace window_features_test
}  // namespace palpate
