// SPDX-License-Identifier: Apache-2.0
#include "engine/session/tool_brush.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/units.hpp"
#include "engine/edit/edit_text.hpp"

namespace palpate {
namespace {

constexpr double kStandsStill = 0.05;  // share of the radius; a tool that moved less is at rest

}  // namespace

ToolBrushSpec toolBrushSpec(const std::string& text) {
  const EditText parsed = editText(text, EditUse::kTool, "--edit " + text);
  return {parsed.command, parsed.rate_per_Ns, parsed.period_s, parsed.mirror_axis};
}

std::string toolBrushText(const ToolBrushSpec& spec) {
  const EditCommand& brush = spec.brush;
  std::string text = fmt::format("{}:radius={}m:strength={}:falloff={}:period={}", editName(brush.kind), brush.radius_m,
                                 brush.strength, brush.falloff, spec.period_s * 1e3);
  if (spec.rate_per_Ns > 0) text += fmt::format(":rate={}", spec.rate_per_Ns);
  if (brush.kind == EditKind::kPaint) text += fmt::format(":value={}", brush.value);
  if (spec.mirror_axis) text += fmt::format(":mirror={}", "xyz"[*spec.mirror_axis]);
  if (brush.material) {
    const MaterialRate& material = *brush.material;
    text += fmt::format(":soft={}:hard={}:drop={}", material.low_density, material.high_density, material.drop);
  }
  return text;
}

double ToolBrush::strengthFor(double seconds) const {
  if (spec_.rate_per_Ns == 0 || !(seconds > 0)) return spec_.brush.strength;
  return spec_.brush.strength * -std::expm1(-spec_.rate_per_Ns * impulse_Ns_);
}

ToolBrush::ToolBrush(const ToolBrushSpec& spec, const Vec3i& size, const Lattice& lattice)
    : spec_(spec), size_(size), lattice_(lattice) {}

// The pressing force is the part along the normal of what the device was really sent. So a force that rubs does not
// drill.
void ToolBrush::touch(const ToolPose& pose, std::int64_t time_ns) {
  const bool was_touching = std::exchange(touching_, !pose.normal_W.isZero(0));
  if (!touching_) return;
  touched_ = true;
  const double force_N = std::max(0.0, pose.force_W.dot(pose.normal_W));
  impulse_Ns_ += force_N * static_cast<double>(time_ns - last_call_ns_) / kNanosecondsPerSecond;
  if (was_touching) return;
  plane_W_ = pose.at_surface ? pose.surface_W : pose.position_W;
  normal_W_ = pose.normal_W;
}

void ToolBrush::lift() noexcept {
  from_W_.reset();
  last_edit_W_.reset();
  touched_ = touching_ = false;
  impulse_Ns_ = 0;
}

std::vector<EditCommand> ToolBrush::dueStroke(const ToolPose& pose, std::int64_t time_ns) {
  if (std::exchange(leaps_, pose.leaps) != pose.leaps) lift();
  if (!from_W_) {
    from_W_ = pose.position_W;
    begin_ns_ = last_call_ns_ = time_ns;
  }
  touch(pose, time_ns);
  last_call_ns_ = time_ns;
  const double seconds = static_cast<double>(time_ns - begin_ns_) / kNanosecondsPerSecond;
  // Tolerates a nanosecond: both ends are rounded to whole nanoseconds.
  if (seconds < spec_.period_s - 1e-9) return {};

  EditCommand command = spec_.brush;
  command.from_W = *from_W_;
  command.to_W = pose.position_W;
  command.strength = strengthFor(seconds);
  command.plane_W = plane_W_;
  command.normal_W = normal_W_;
  const bool touched = std::exchange(touched_, false);
  from_W_ = pose.position_W;
  begin_ns_ = time_ns;
  impulse_Ns_ = 0;
  // Adding or removing at full strength a second time in the same place would change nothing.
  const bool at_once = (command.kind == EditKind::kAdd || command.kind == EditKind::kRemove) && command.strength >= 1 &&
                       command.falloff == 0 && !command.material;
  const bool stands = last_edit_W_ && (*last_edit_W_ - command.to_W).norm() < kStandsStill * command.radius_m &&
                      (*last_edit_W_ - command.from_W).norm() < kStandsStill * command.radius_m;
  if (!touched || !(command.strength > 0) || (at_once && stands)) return {};
  last_edit_W_ = command.to_W;
  return withMirror(command, spec_.mirror_axis, size_, lattice_);
}

}  // namespace palpate
