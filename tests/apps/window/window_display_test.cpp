// SPDX-License-Identifier: Apache-2.0
// A display that fails: the surface or the device is lost, the window is hidden, minimised or closed by a window
// manager.
#include <chrono>
#include <thread>

#include "apps/sculpt/session_folders.hpp"
#include "base/error.hpp"
#include "engine/journal/volume_identity.hpp"
#include "sculpt_window.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace window_display_test {

class OnABadDesktop : public OnADesktop {
 protected:
  void SetUp() override {
    OnADesktop::SetUp();
    if (IsSkipped()) return;
    std::ofstream(folder.path() / "faults.json")
        << R"({"file_format_version": "1.0.0", "layer": {"name": "VK_LAYER_palpate_faults", "type": "GLOBAL", )"
        << R"("api_version": "1.3.0", "implementation_version": "1", "description": "loses what it shows in", )"
        << R"("library_path": ")" << PALPATE_FAULTS_LAYER << R"("}})";
    more = {{"VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation:VK_LAYER_palpate_faults"},
            {"VK_LAYER_PATH", "/usr/share/vulkan/explicit_layer.d:" + folder.path().string()},
            {"PALPATE_VULKAN_FAULT", fault().string()}};
  }
  [[nodiscard]] std::filesystem::path fault() const { return folder.path() / "fault"; }
  // The next such call fails.
  bool fails(const std::string& call, int result) {
    std::ofstream(folder.path() / "next") << call << ' ' << result;
    std::filesystem::rename(folder.path() / "next", fault());
    return waitUntil([&] { return !std::filesystem::exists(fault()); });
  }
};

constexpr int kTimeout = 2, kSurfaceLost = -1'000'000'000, kOutOfDate = -1'000'001'004, kDeviceLost = -4;

TEST_F(OnABadDesktop, GoesOnWithANewSurface) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  for (const char* call : {"acquire", "present"}) {
    for (const int result : {kSurfaceLost, kOutOfDate}) {
      ASSERT_TRUE(fails(call, result)) << program->said();
      ASSERT_TRUE(movesOff());
      EXPECT_EQ(differing(before, desktop->look(), kUpper), 0) << call << result;
    }
  }
  ASSERT_TRUE(fails("acquire", kTimeout)) << program->said();
  ASSERT_TRUE(drills());
  EXPECT_GT(differing(before, desktop->look(), {kMiddleX - 60, kMiddleY - 60, 200, 120}), 100);
  desktop->does({"key", "ctrl+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  endsWell();
}

// The window cannot go on; what was done in it is there at the next start.
TEST_F(OnABadDesktop, KeepsTheSessionOfALostDevice) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  ASSERT_TRUE(drills());
  ASSERT_TRUE(fails("present", kDeviceLost)) << program->said();
  EXPECT_EQ(program->ends(), exitStatus(Error::Code::kDevice));
  EXPECT_THAT(program->said(), testing::HasSubstr("palpate: the window: "));
  const std::vector<LeftSession> left = leftSessions(journals());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].damage, "");
  EXPECT_NE(contentHash(replayed(left[0].folder)), contentHash(loadVolume(kBall)));
}

TEST_F(OnADesktop, IsMinimisedAndClosed) {
  if (!desktop->manageWindows()) GTEST_SKIP() << "twm is not installed";
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  desktop->does({"search", "--onlyvisible", "--name", "Palpate", "windowminimize"});
  ASSERT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) > 10000; }));  // the bare desktop
  std::this_thread::sleep_for(std::chrono::seconds(1));
  ASSERT_TRUE(program->runs()) << program->said();
  desktop->does({"search", "--name", "Palpate", "windowmap"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  desktop->asksToClose();
  EXPECT_EQ(program->ends(), 0) << program->said();
  EXPECT_TRUE(std::filesystem::is_empty(journals()));
  EXPECT_THAT(settings(), testing::AllOf(testing::HasSubstr("\"width\": 1280"), testing::HasSubstr("\"height\": 720")));
}

}  // namespace window_display_test
}  // namespace palpate
