// SPDX-License-Identifier: Apache-2.0
// engine/session/tool_brush.hpp: the servo's tool as a brush: from where the tool was and is to edit commands.
//
// look() takes the tool's newest pose as often as there is one; every period it gives the stroke that the tool swept
// since the last look of the period before, if it touched the surface in it. The brush's middle is the HIP. Strokes
// that follow one another share an end, so no gap is left however fast the tool was. A tool that stands and whose
// brush has its full effect at once is not repeated. Flattening makes the surface the plane that the tool touched when
// its contact began. A mirror does every stroke again on the other side of the volume's middle. Frame W: world [m].
// Thread: one. Deterministic: the same poses give the same commands.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/edit/edit_command.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

struct ToolBrushSpec {
  EditCommand brush;       // kind, radius, strength, falloff, value, material; its place is the tool's
  double rate_per_Ns = 0;  // 0: the strength as it is; else 1 - exp(-rate * force * time) of it [1/(N s)]
  double period_s = 4e-3;  // between two edits [s]
  std::optional<int> mirror_axis = std::nullopt;  // of the volume's lattice, 0 to 2
};

// "remove:radius=2mm:strength=0.5:falloff=0.3": engine/edit/edit_text.hpp, the kinds and keys that a tool has. Throws
// Error(kBadInput) with what is wrong and what may be given; ranges that depend on the volume are checked with the
// first edit.
[[nodiscard]] ToolBrushSpec toolBrushSpec(const std::string& text);

class ToolBrush {
 public:
  // `size`, `lattice`: the volume's.
  ToolBrush(const ToolBrushSpec& spec, const Vec3i& size, const Lattice& lattice);

  // The edit that is due now, if there is one: its stroke and, with a mirror, the other, for one apply(). `time_ns` on
  // the pose's clock.
  [[nodiscard]] std::vector<EditCommand> look(const ToolPose& pose, std::int64_t time_ns);
  // The edit that look() gave last was not applied: a tool that stands gives it again.
  void refused() noexcept { last_edit_W_.reset(); }

 private:
  [[nodiscard]] double strengthFor(double seconds) const;
  void touch(const ToolPose& pose, std::int64_t time_ns);

  ToolBrushSpec spec_;
  Vec3i size_;  // of the volume
  Lattice lattice_;
  std::optional<Vec3> from_W_;  // the tool when the period began
  std::int64_t begin_ns_ = 0;   // of the period
  double impulse_Ns_ = 0;       // of the pressing force since then
  std::int64_t last_look_ns_ = 0;
  bool touched_ = false;             // in this period
  bool touching_ = false;            // at the last look
  Vec3 plane_W_ = Vec3::Zero();      // where the contact began
  Vec3 normal_W_ = Vec3::UnitZ();    // and its normal then
  std::optional<Vec3> last_edit_W_;  // end of the last stroke
};

}  // namespace palpate
