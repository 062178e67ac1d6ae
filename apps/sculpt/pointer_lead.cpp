// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/pointer_lead.hpp"

namespace palpate {
namespace {

double growthOf(const EditCommand& brush) {
  return brush.kind == EditKind::kRemove || brush.kind == EditKind::kDeflate ? 0 : brush.radius_m;
}

// Behind a cut the tool meets what is not drawn. It presses on that no harder than on what is.
PointerTarget heldBack(PointerTarget target, const TickRecord& tick, double reach_m, double deepest_m) {
  if (!tick.in_contact || target.from_W) return target;
  const Vec3 normal_W = asVec3(tick.normal_W);
  const double depth_m = normal_W.dot(asVec3(tick.vhip_W) - target.hip_W);
  if (depth_m > deepest_m) target.hip_W += (depth_m - reach_m) * normal_W;
  return target;
}

}  // namespace

void PointerLead::lead(SculptSide& session, const ToolRequest& request, Gestures::Kind kind, const PointerInput& input,
                       const PointerReach& reach, const TickRecord& tick) {
  if (request.ends) {
    session.release();
    grows_m_ = 0;
  }
  const ViewFrame& frame = session.frame();
  const bool leads = kind == Gestures::Kind::kStroke || (kind == Gestures::Kind::kNone && input.over);
  // Before the first tick the tool is nowhere: it then is as if it had not been seen.
  const Vec3 tool_W = tick.tick < 0 ? frame.camera.position_W : asVec3(tick.hip_W);
  const auto target = leads ? tool_.follow(frame, input.x, input.y, request.presses, reach, tool_W, grows_m_)
                            : tool_.rest(frame, tool_W);
  if (target) session.aim(heldBack(*target, tick, reach.depth_m, PointerTool::kDeepest * reach.depth_m + grows_m_));
  if (!request.begins) return;
  session.press(*request.begins);
  grows_m_ = growthOf(request.begins->brush);
}

}  // namespace palpate
