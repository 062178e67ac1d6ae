// SPDX-License-Identifier: Apache-2.0
// What is drawn over the picture. What lies behind the surface is drawn faint: the picture's depth decides.
#include <algorithm>
#include <cmath>

#include <imgui.h>

#include "apps/window/panels.hpp"
#include "apps/window/theme.hpp"

namespace palpate {
namespace {

constexpr double kBehind_m = 2e-4;       // a point on the surface itself is in front
constexpr double kNewtonsPerHeight = 8;  // an arrow of the limit's force is half the picture high

class Overlay {
 public:
  Overlay(const ViewFrame& frame, const PictureArea& area, float scale)
      : frame_(frame), area_(area), scale_(scale), draw_(*ImGui::GetBackgroundDrawList()) {
    draw_.PushClipRect(ImVec2(area.x, area.y), ImVec2(area.x + area.width, area.y + area.height));
  }
  ~Overlay() { draw_.PopClipRect(); }
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  void dot(const Vec3& p_W, std::uint32_t colour, float radius) {
    const auto at = place(p_W);
    if (!at) return;
    const std::uint32_t shade = faint(colour, isBehind(p_W));
    draw_.AddCircleFilled(*at, radius * scale_, shade);
    draw_.AddCircle(*at, radius * scale_, faint(overlayColours().outline, isBehind(p_W)), 0, scale_);
  }
  // In pieces, so that each is faint or not.
  void line(const Vec3& from_W, const Vec3& to_W, std::uint32_t colour, float width) {
    constexpr int kPieces = 12;
    for (int i = 0; i < kPieces; ++i) {
      const Vec3 a_W = from_W + (to_W - from_W) * i / kPieces, b_W = from_W + (to_W - from_W) * (i + 1) / kPieces;
      piece(a_W, b_W, colour, width);
    }
  }
  // Of a line in several pieces.
  void piece(const Vec3& from_W, const Vec3& to_W, std::uint32_t colour, float width) {
    const auto a = place(from_W), b = place(to_W);
    if (a && b) draw_.AddLine(*a, *b, faint(colour, isBehind((from_W + to_W) / 2)), width * scale_);
  }
  // Two lines across, where the pointer of the keyboard is [pixel of the picture].
  void cross(double x, double y, std::uint32_t colour) {
    const ImVec2 at(area_.x + static_cast<float>(x) * area_.width / static_cast<float>(frame_.camera.width),
                    area_.y + static_cast<float>(y) * area_.height / static_cast<float>(frame_.camera.height));
    const float arm = 12 * scale_;
    draw_.AddLine(ImVec2(at.x - arm, at.y), ImVec2(at.x + arm, at.y), colour, scale_);
    draw_.AddLine(ImVec2(at.x, at.y - arm), ImVec2(at.x, at.y + arm), colour, scale_);
  }
  // A square of the plane, around a point of it.
  void plane(const Vec3& middle_W, const Vec3& normal_W, double half_m, std::uint32_t colour) {
    const Vec3 side_W = half_m * normal_W.unitOrthogonal(), other_W = normal_W.cross(side_W);
    const Vec3 corners_W[] = {side_W + other_W, side_W - other_W, -side_W - other_W, other_W - side_W};
    for (int i = 0; i < 4; ++i) line(middle_W + corners_W[i], middle_W + corners_W[(i + 1) % 4], colour, 1);
  }
  void ring(const Vec3& middle_W, const Vec3& axis_W, double radius_m, std::uint32_t colour) {
    Vec3 side_W = axis_W.unitOrthogonal();
    const Vec3 other_W = axis_W.cross(side_W);
    constexpr int kPieces = 48;
    const auto point = [&](int i) -> Vec3 {
      const double angle = 2 * M_PI * i / kPieces;
      return middle_W + radius_m * (std::cos(angle) * side_W + std::sin(angle) * other_W);
    };
    for (int i = 0; i < kPieces; ++i) {
      const auto a = place(point(i)), b = place(point(i + 1));
      if (a && b) draw_.AddLine(*a, *b, faint(colour, isBehind(point(i))), 2 * scale_);
    }
  }

 private:
  static std::uint32_t faint(std::uint32_t colour, bool behind) {
    return behind ? (colour & 0x00FFFFFFU) | (colour >> 26U) << 24U : colour;  // a quarter of its opacity
  }
  [[nodiscard]] std::optional<ImVec2> place(const Vec3& p_W) const {
    const auto seen = frame_.camera.project(p_W);
    if (!seen || std::abs(seen->x) > 1e5 || std::abs(seen->y) > 1e5) return std::nullopt;
    return ImVec2(area_.x + static_cast<float>(seen->x) * area_.width / static_cast<float>(frame_.camera.width),
                  area_.y + static_cast<float>(seen->y) * area_.height / static_cast<float>(frame_.camera.height));
  }
  [[nodiscard]] bool isBehind(const Vec3& p_W) const {
    const auto seen = frame_.camera.project(p_W);
    if (!seen) return false;
    const auto surface_W = PointerTool::surface_W(frame_, seen->x, seen->y);
    return surface_W && (*surface_W - frame_.camera.position_W).norm() + kBehind_m < seen->distance_m;
  }

  const ViewFrame& frame_;
  const PictureArea& area_;
  const float scale_;
  ImDrawList& draw_;
};

}  // namespace

void showOverlay(const WindowModel& model, const PictureArea& area, double scale) {
  const ViewFrame& frame = model.session.frame();
  if (frame.number == 0 || model.tick.tick < 0) return;
  const TickRecord& tick = model.tick;
  const OverlayColours& colours = overlayColours();
  Overlay overlay(frame, area, static_cast<float>(scale));
  const Vec3 hip_W = asVec3(tick.hip_W), vhip_W = asVec3(tick.vhip_W);
  const Vec3 axis_W = tick.in_contact ? asVec3(tick.normal_W) : Vec3(-frame.camera.forward_W);
  if (axis_W.norm() > 0.5) {
    overlay.ring(tick.in_contact ? vhip_W : hip_W, axis_W.normalized(), model.settings.brush.radius_m, colours.brush);
  }
  if (tick.in_contact) {
    const double metres_per_N = frame.camera.pixelSize((vhip_W - frame.camera.position_W).dot(frame.camera.forward_W)) *
                                frame.camera.height / (2 * kNewtonsPerHeight);
    overlay.line(vhip_W, vhip_W + metres_per_N * asVec3(tick.force_W), colours.force, 3);
    overlay.line(hip_W, vhip_W, colours.tool, 2);
    overlay.plane(vhip_W, axis_W.normalized(), 1.5 * model.settings.brush.radius_m, colours.surface_point);
    for (std::size_t i = 1; i < model.path_W.size(); ++i)
      overlay.piece(model.path_W[i - 1], model.path_W[i], colours.surface_point, 1.5F);
    overlay.dot(vhip_W, colours.surface_point, 4);
  }
  overlay.dot(hip_W, colours.tool, 5);
  if (model.keys.leads()) overlay.cross(model.pointer.x, model.pointer.y, colours.brush);
}

}  // namespace palpate
