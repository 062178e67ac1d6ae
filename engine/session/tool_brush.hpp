// SPDX-License-Identifier: Apache-2.0
// engine/session/tool_brush.hpp: the servo's tool as a brush: turns the tool's poses into edit commands.
//
// Call dueStroke() with every new pose of the tool. Once a period it returns a stroke along the tool's path in that
// period, if the tool touched the surface meanwhile. The centre of the brush is the HIP. Successive strokes share an
// end, so they leave no gap, however fast the tool moves; only where the tool has leapt there is none between. A tool
// at rest yields only one stroke if its brush has its full effect at once. A flatten brush flattens to the plane that
// the tool touched when the contact began. A mirror repeats every stroke on the other side of the volume's middle.
//
// Frame W: world [m]. Thread: one. Deterministic: the same poses give the same commands.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/edit/edit_command.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

struct ToolBrushSpec {
  EditCommand brush;       // kind, radius, strength, falloff, value, material; its place comes from the tool
  double rate_per_Ns = 0;  // the strength is multiplied by 1 - exp(-rate * force * time); 0: by 1 [1/(N s)]
  double period_s = 4e-3;  // between two edits [s]
  std::optional<int> mirror_axis = std::nullopt;  // of the volume's lattice, 0 to 2
};

// Parses "remove:radius=2mm:strength=0.5:falloff=0.3" (engine/edit/edit_text.hpp, kinds and keys of a tool). Throws
// Error(kBadInput) that says what is wrong and what may be given. The first edit checks limits that depend on the
// volume.
[[nodiscard]] ToolBrushSpec toolBrushSpec(const std::string& text);
// A text from which toolBrushSpec() makes this brush again, to the bit but for lengths and times, which it gives in
// millimetres and milliseconds.
[[nodiscard]] std::string toolBrushText(const ToolBrushSpec& spec);

class ToolBrush {
 public:
  // `size`, `lattice`: the volume's.
  ToolBrush(const ToolBrushSpec& spec, const Vec3i& size, const Lattice& lattice);

  // The edit that is due now, or nothing: a stroke and, with a mirror, its mirror image. Pass both to one
  // Editor::apply(). `time_ns` is on the pose's clock.
  [[nodiscard]] std::vector<EditCommand> dueStroke(const ToolPose& pose, std::int64_t time_ns);
  // No tool is there. The next stroke begins where it comes back.
  void lift() noexcept;
  // Call it if the last stroke was not applied. A tool at rest then yields that stroke again.
  void refused() noexcept { last_edit_W_.reset(); }

 private:
  [[nodiscard]] double strengthFor(double seconds) const;
  void touch(const ToolPose& pose, std::int64_t time_ns);

  ToolBrushSpec spec_;
  Vec3i size_;  // of the volume
  Lattice lattice_;
  std::optional<Vec3> from_W_;  // the tool's position when the period began
  std::int64_t begin_ns_ = 0;   // of the period
  std::uint32_t leaps_ = 0;     // ToolPose::leaps of the last call
  double impulse_Ns_ = 0;       // of the force that pressed in this period
  std::int64_t last_call_ns_ = 0;
  bool touched_ = false;             // in this period
  bool touching_ = false;            // at the last call
  Vec3 plane_W_ = Vec3::Zero();      // surface point where the contact began
  Vec3 normal_W_ = Vec3::UnitZ();    // the surface normal there
  std::optional<Vec3> last_edit_W_;  // end of the last stroke
};

}  // namespace palpate
