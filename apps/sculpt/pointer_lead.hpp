// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/pointer_lead.hpp: leads the tool of a session by a pointer, frame by frame: where it goes, and when its
// brush works. One thread.
#pragma once

#include "apps/sculpt/gestures.hpp"
#include "apps/sculpt/sculpt_side.hpp"

namespace palpate {

class PointerLead {
 public:
  // The tool's first distance from the camera, where nothing was under the pointer yet [m].
  explicit PointerLead(double distance_m) : tool_(distance_m) {}

  // What a frame's gestures ask of the tool, done: it is aimed first, so that a stroke never begins where the pointer
  // was before. `tick`: the servo's newest.
  void lead(SculptSide& session, const ToolRequest& request, Gestures::Kind kind, const PointerInput& input,
            const PointerReach& reach, const TickRecord& tick);

 private:
  PointerTool tool_;
  double grows_m_ = 0;  // how much the brush that is held may put over the tool
};

}  // namespace palpate
