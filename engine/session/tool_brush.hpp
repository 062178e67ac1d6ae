// SPDX-License-Identifier: Apache-2.0
// engine/session/tool_brush.hpp: the servo's tool as a brush: from where the tool was and is to edit commands.
//
// look() takes the tool's newest pose as often as there is one; every period it gives the stroke that the tool swept
// since the last look of the period before, if it touched the surface in it. The brush's middle is the HIP. Strokes
// that follow one another share an end, so no gap is left however fast the tool was. A tool that stands and whose
// brush has its full effect at once is not repeated. Frame W: world [m]. Thread: one. Deterministic: the same poses
// give the same commands.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/edit/edit_command.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

struct ToolBrushSpec {
  EditCommand brush;       // kind, radius, strength, falloff, value, material; its place is the tool's
  double rate_per_Ns = 0;  // 0: the strength as it is; else 1 - exp(-rate * force * time) of it [1/(N s)]
  double period_s = 4e-3;  // between two edits [s]
};

// "remove:radius=2mm:strength=0.5:falloff=0.3": engine/edit/edit_text.hpp, the kinds and keys that a tool has. Throws
// Error(kBadInput) with what is wrong and what may be given; ranges that depend on the volume are checked with the
// first edit.
[[nodiscard]] ToolBrushSpec toolBrushSpec(const std::string& text);

class ToolBrush {
 public:
  // `stiffness_N_per_m`, `force_limit_N`: for the force of a pressing tool, K * depth.
  ToolBrush(const ToolBrushSpec& spec, double stiffness_N_per_m, double force_limit_N)
      : spec_(spec), stiffness_N_per_m_(stiffness_N_per_m), force_limit_N_(force_limit_N) {}

  // The edit that is due now, if there is one. `time_ns` on the pose's clock.
  [[nodiscard]] std::optional<EditCommand> look(const ToolPose& pose, std::int64_t time_ns);

 private:
  [[nodiscard]] double strengthFor(double seconds) const;

  ToolBrushSpec spec_;
  double stiffness_N_per_m_, force_limit_N_;
  std::optional<Vec3> from_W_;  // the tool when the period began
  std::int64_t begin_ns_ = 0;   // of the period
  double impulse_Ns_ = 0;       // of the pressing force since then
  std::int64_t last_look_ns_ = 0;
  bool touched_ = false;             // in this period
  std::optional<Vec3> last_edit_W_;  // end of the last stroke
};

}  // namespace palpate
