// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
void showTouchSection(WindowModel& model) {
  if (!section("Touch")) return;
  RigSettings servo = model.session.settings();
  const RigSettings before = servo;
  AlgorithmParameters& p = servo.parameters;
  leaveRoomForLabel();
  if (ImGui::BeginCombo("Algorithm", servo.algorithm.c_str())) {
    for (const AlgorithmEntry& entry : algorithms()) {
      if (ImGui::Selectable(std::string(entry.name).c_str(), entry.name == servo.algorithm))
        servo.algorithm = entry.name;
      tip(std::string(entry.description));
    }
    ImGui::EndCombo();
  }
  slider("Stiffness", p.stiffness_N_per_m, 20, 3000, 1, "%.0f N/m", true);
  slider("Damping", p.damping_Ns_per_m, 0, 5, 1, "%.2f N s/m");
  leaveRoomForLabel();
  ImGui::SliderInt("Renewal", &p.plane_renewal_ticks, 1, 100, "%d ticks", ImGuiSliderFlags_Logarithmic);
  tip("The plane under the tool is found anew after so many ticks");
  slider("Friction", servo.effects.friction.dynamic_ratio, 0, 1, 1, "%.2f");
  servo.effects.friction.static_ratio = 1.2 * servo.effects.friction.dynamic_ratio;
  slider("Recovery", servo.effects.recovery_s, 0, 0.1, 1e-3, "%.0f ms");
  tip("The force goes over from plane to plane in this time; 0: at once");
  int texture = static_cast<int>(servo.effects.texture);
  leaveRoomForLabel();
  if (ImGui::Combo("Texture", &texture, "none\0procedural\0density\0"))
    servo.effects.texture = static_cast<TextureKind>(texture);
  tip("Fine relief: made up, or from the density's fine structure");
  slider("Force limit", servo.force_limit_N, 0.5, 8, 1, "%.1f N");
  mutedText(fmt::format("device: {}", model.session.device()));
  if (!(servo == before)) orSay(model, [&] { model.session.change(servo); });
}

}  // namespace palpate
