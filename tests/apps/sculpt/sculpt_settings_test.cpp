// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/sculpt_settings.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "temporary_folder.hpp"

namespace palpate {
namespace sculpt_settings_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Place {
  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "new" / "sculpt.json";
  std::string trouble;
  SculptSettings read() { return readSettings(file, trouble); }
  SculptSettings read(const std::string& text) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return read();
  }
};

TEST(SculptSettings, ComeBackAsTheyWere) {
  Place place;
  SculptSettings settings;
  settings.dark = false;
  settings.scale = 1.5;
  settings.width = 1900;
  settings.height = 1000;
  settings.brush = {.kind = BrushKind::kFlatten, .radius_m = 0.0042, .strength = 0.75};
  settings.reach.depth_m = 0.0021;
  settings.opened("a.nii");
  settings.opened("b \xff.nii");  // no UTF-8
  writeSettings(settings, place.file);
  const SculptSettings again = place.read();
  EXPECT_THAT(place.trouble, IsEmpty());
  EXPECT_FALSE(again.dark);
  EXPECT_EQ(again.scale, 1.5);
  EXPECT_EQ(again.width, 1900);
  EXPECT_EQ(again.height, 1000);
  EXPECT_EQ(again.brush.kind, BrushKind::kFlatten);
  EXPECT_NEAR(again.brush.radius_m, 0.0042, 1e-15);
  EXPECT_EQ(again.brush.strength, 0.75);
  EXPECT_NEAR(again.reach.depth_m, 0.0021, 1e-15);
  ASSERT_EQ(again.recent.size(), 2U);
  EXPECT_EQ(again.recent[1], "a.nii");
}

TEST(SculptSettings, OfAFirstStartAreTheDefaults) {
  Place place;
  const SculptSettings settings = place.read();
  EXPECT_THAT(place.trouble, IsEmpty());
  EXPECT_TRUE(settings.dark);
  EXPECT_EQ(settings.width, 1280);
  EXPECT_THAT(settings.recent, IsEmpty());
}

TEST(SculptSettings, OfADamagedFileAreTheDefaultsAndThatIsSaid) {
  for (const char* text : {"{", "", "[1, 2]", "3", "{\"dark\": fal"}) {
    Place place;
    EXPECT_EQ(place.read(text).width, 1280);
    EXPECT_THAT(place.trouble, testing::AllOf(HasSubstr("sculpt.json"), HasSubstr("damaged"))) << text;
  }
}

// What is out of range or of another kind is left out, and the rest counts.
TEST(SculptSettings, TakeNothingThatIsOutOfRange) {
  Place place;
  const SculptSettings settings = place.read(
      R"({"dark": 3, "scale": 40, "width": 10, "height": 1e9, "brush": "Saw", "radius_mm": -1, "strength": 0,
          "depth_mm": 1e9, "recent": ["x", 7, null, "y"]})");
  const SculptSettings usual;
  EXPECT_THAT(place.trouble, IsEmpty());
  EXPECT_TRUE(settings.dark);
  EXPECT_EQ(settings.scale, usual.scale);
  EXPECT_EQ(settings.width, usual.width);
  EXPECT_EQ(settings.height, usual.height);
  EXPECT_EQ(settings.brush.kind, usual.brush.kind);
  EXPECT_EQ(settings.brush.radius_m, usual.brush.radius_m);
  EXPECT_EQ(settings.brush.strength, usual.brush.strength);
  EXPECT_EQ(settings.reach.depth_m, usual.reach.depth_m);
  EXPECT_THAT(settings.recent, ElementsAre("x", "y"));
}

TEST(SculptSettings, RememberTheNewestVolumesOnce) {
  SculptSettings settings;
  for (int i = 0; i < 15; ++i) settings.opened(std::to_string(i));
  EXPECT_EQ(settings.recent.size(), SculptSettings::kMostRecent);
  EXPECT_EQ(settings.recent.front(), "14");
  settings.opened("10");
  EXPECT_EQ(settings.recent.front(), "10");
  EXPECT_EQ(settings.recent.size(), SculptSettings::kMostRecent);
  EXPECT_EQ(std::count(settings.recent.begin(), settings.recent.end(), "10"), 1);
  settings.opened(settings.recent.back());  // as a click on the list does
  EXPECT_EQ(settings.recent.front(), "5");
  EXPECT_EQ(settings.recent[1], "10");
  EXPECT_EQ(settings.recent.size(), SculptSettings::kMostRecent);
}

}  // namespace sculpt_settings_test
}  // namespace palpate
