// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/sculpt/touch_sliders.hpp"
#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {

// Only what the person moves is changed: the rest may be set by a scene, a service or another window.
void showTouchSection(WindowModel& model) {
  if (!section("Touch")) return;
  RigSettings servo = model.session.settings();
  const RigSettings before = servo;
  leaveRoomForLabel();
  if (ImGui::BeginCombo("Algorithm", servo.algorithm.c_str())) {
    for (const AlgorithmEntry& entry : algorithms()) {
      if (ImGui::Selectable(std::string(entry.name).c_str(), entry.name == servo.algorithm))
        servo.algorithm = entry.name;
      tip(std::string(entry.description));
    }
    ImGui::EndCombo();
  }
  for (const TouchSlider& one : touchSliders()) {
    slider(one.label, one.of(servo), one.lowest(servo), one.highest(servo), one.unit, one.form, one.logarithmic);
    tip(optionOfKey(one.key)->help);
  }
  leaveRoomForLabel();
  ImGui::SliderInt("Renewal", &servo.parameters.plane_renewal_ticks, 1, kMostRenewal_ticks, "%d ticks",
                   ImGuiSliderFlags_Logarithmic);
  tip("The plane under the tool is found anew after so many ticks");
  int texture = static_cast<int>(servo.effects.texture);
  leaveRoomForLabel();
  if (ImGui::Combo("Texture", &texture, "none\0procedural\0density\0"))
    servo.effects.texture = static_cast<TextureKind>(texture);
  tip("Fine relief: made up, or from the density's fine structure");
  mutedText(fmt::format("device: {}", model.session.device()));
  if (!(servo == before)) orSay(model, [&] { model.session.change(servo); });
}

}  // namespace palpate
