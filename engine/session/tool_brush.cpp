// SPDX-License-Identifier: Apache-2.0
#include "engine/session/tool_brush.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/units.hpp"
#include "engine/edit/edit_text.hpp"

namespace palpate {
namespace {

constexpr double kStandsStill = 0.05;  // of the radius: a nearer place is the same

}  // namespace

ToolBrushSpec toolBrushSpec(const std::string& text) {
  const EditText parsed = editText(text, EditUse::kTool, "--edit " + text);
  return {parsed.command, parsed.rate_per_Ns, parsed.period_s};
}

double ToolBrush::strengthFor(double seconds) const {
  if (spec_.rate_per_Ns == 0 || !(seconds > 0)) return spec_.brush.strength;
  return spec_.brush.strength * -std::expm1(-spec_.rate_per_Ns * impulse_Ns_);
}

std::optional<EditCommand> ToolBrush::look(const ToolPose& pose, std::int64_t time_ns) {
  if (!from_W_) {
    from_W_ = pose.position_W;
    begin_ns_ = last_look_ns_ = time_ns;
  }
  if (pose.at_surface) {
    touched_ = true;
    const double force_N = std::min(force_limit_N_, stiffness_N_per_m_ * (pose.surface_W - pose.position_W).norm());
    impulse_Ns_ += force_N * static_cast<double>(time_ns - last_look_ns_) / kNanosecondsPerSecond;
  }
  last_look_ns_ = time_ns;
  const double seconds = static_cast<double>(time_ns - begin_ns_) / kNanosecondsPerSecond;
  // Half a nanosecond, since ticks are rounded to whole ones.
  if (seconds < spec_.period_s - 1e-9) return std::nullopt;

  EditCommand command = spec_.brush;
  command.from_W = *from_W_;
  command.to_W = pose.position_W;
  command.strength = strengthFor(seconds);
  const bool touched = std::exchange(touched_, false);
  from_W_ = pose.position_W;
  begin_ns_ = time_ns;
  impulse_Ns_ = 0;
  // Adding and removing at full strength, a second time in the same place, would change nothing.
  const bool at_once = (command.kind == EditKind::kAdd || command.kind == EditKind::kRemove) && command.strength >= 1 &&
                       command.falloff == 0 && !command.material;
  const bool stands = last_edit_W_ && (*last_edit_W_ - command.to_W).norm() < kStandsStill * command.radius_m &&
                      (*last_edit_W_ - command.from_W).norm() < kStandsStill * command.radius_m;
  if (!touched || !(command.strength > 0) || (at_once && stands)) return std::nullopt;
  last_edit_W_ = command.to_W;
  return command;
}

}  // namespace palpate
