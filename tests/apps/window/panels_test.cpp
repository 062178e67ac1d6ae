// SPDX-License-Identifier: Apache-2.0
// Panels without a display: Dear ImGui lays them out, and nobody draws. Nothing that is only shown may change anything.
#include "apps/window/panels.hpp"

#include <gtest/gtest.h>
#include <imgui.h>

#include "tests/apps/sculpt/still_side.hpp"
#include "tests/support/any_settings.hpp"

namespace palpate {
namespace panels_test {

// Counts what would change anything.
class Shown final : public StillSide {
 public:
  Shown() {
    volume_.statistics.histogram.counts = {1, 2, 3};
    volume_.statistics.histogram.bin_width = 1;
    volume_.object.points_W = {Vec3::Zero(), Vec3::Ones()};
    volume_.size = Vec3i::Constant(64);
    volume_.name = "v";
  }
  void press(const ToolBrushSpec&) override { ++changes; }
  void release() override { ++changes; }
  void undo() override { ++changes; }
  void redo() override { ++changes; }
  void goTo(std::size_t) override { ++changes; }
  void change(const RigSettings&) override { ++changes; }
  [[nodiscard]] RigSettings settings() const override { return now; }
  void save(const std::string&) override { ++changes; }

  RigSettings now;
  int changes = 0;
};

class Panels : public testing::Test {
 protected:
  Panels() {
    context_ = ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = ImVec2(1280, 4000);  // every section is in sight
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
  }
  ~Panels() override { ImGui::DestroyContext(context_); }

  static void frame(WindowModel& model) {
    ImGui::NewFrame();
    static_cast<void>(showPanels(model, 1));
    ImGui::Render();
  }

 private:
  ImGuiContext* context_ = nullptr;
};

// Settings that a service may have, whether a slider reaches them or not.
TEST_F(Panels, ShowingSettingsChangesNone) {
  Seeded random(5);
  for (int i = 0; i < 100; ++i) {
    Shown session;
    session.now = anySettings(random);
    WindowModel model{.session = session, .settings = {}, .view = OrbitView(session.volume().object, 640, 480)};
    const ViewChoice sight = model.sight;
    const SculptSettings kept = model.settings;
    for (int k = 0; k < 3; ++k) frame(model);
    EXPECT_EQ(session.changes, 0) << i;
    EXPECT_EQ(model.settings.brush.radius_m, kept.brush.radius_m);
    EXPECT_EQ(model.settings.brush.strength, kept.brush.strength);
    EXPECT_EQ(model.settings.reach.depth_m, kept.reach.depth_m);
    EXPECT_EQ(model.sight.second_opacity, sight.second_opacity);
    EXPECT_TRUE(model.messages.empty()) << model.messages.back();
  }
}

}  // namespace panels_test
}  // namespace palpate
