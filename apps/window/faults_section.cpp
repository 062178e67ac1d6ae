// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

void showFaultsSection(WindowModel& model) {
  if (!section("Why is there no force?", false)) return;
  const ForceWords words = forceWordsOf(model);
  ImGui::TextWrapped("now: %s", words.state.c_str());
  for (const std::string& reason : words.reasons) ImGui::TextWrapped("- %s", reason.c_str());
  if (words.reasons.empty()) mutedText("nothing takes the force away");
  bool any = false;
  for (const FaultText& fault : faultTable()) {
    const std::uint64_t ticks = model.faults.ticks(fault.fault);
    if (ticks == 0) continue;
    if (!any) mutedText("since the volume was opened:");
    any = true;
    ImGui::BulletText("%s", fmt::format("{}: {} {}", fault.name, ticks, ticks == 1 ? "tick" : "ticks").c_str());
    tip(fmt::format("{}; {}; {}", fault.text, fault.effect, fault.remedy));
  }
}

void showPlanSection(const WindowModel& model) {
  if (!section("What is computed", false)) return;
  for (const bool done : {true, false}) {
    mutedText(done ? "done:" : "left out:");
    for (const PlanLine& line : model.session.plan()) {
      if (line.done != done) continue;
      ImGui::TextWrapped("- %s", line.what.c_str());
      tip(line.why);
    }
  }
}

}  // namespace palpate
