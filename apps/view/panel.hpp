// SPDX-License-Identifier: Apache-2.0
// apps/view/panel.hpp: draws a run over one picture of the surface. Private to apps/view.
//
// What the surface hides (by the picture's depths) is drawn fainter and dashed, since the tool is inside while in
// contact.
#pragma once

#include <string>
#include <vector>

#include "apps/report/label_placer.hpp"
#include "apps/view/canvas.hpp"
#include "apps/view/contact_region.hpp"
#include "apps/view/force_arrows.hpp"
#include "base/camera.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

inline constexpr Color kInk = {0.11, 0.13, 0.16};
inline constexpr Color kSoftInk = {0.36, 0.40, 0.45};
inline constexpr Color kHipColor = {0.07, 0.36, 0.78};
inline constexpr Color kVhipColor = {0.05, 0.05, 0.07};
inline constexpr Color kStartColor = {0.10, 0.60, 0.25};
inline constexpr Color kObjectColor = {0.45, 0.30, 0.62};
inline constexpr Color kEndColor = {0.85, 0.15, 0.15};

class Panel {
 public:
  // The canvas's origin is the panel's corner. `tolerance_m`: how far below the surface still counts as on it;
  // `scale`: size of lines and letters, 1 at 1280x720.
  Panel(Canvas& canvas, const Camera& camera, const RenderedImage& image, double tolerance_m, double scale);

  void drawHipPath(const std::vector<TickRecord>& records);
  void drawVhipPath(const std::vector<TickRecord>& records);
  void drawObjects(const std::vector<std::vector<Vec3>>& outlines_W);
  void drawForces(const ForceArrows& forces, double longest_m);
  // A square around the region that another panel shows, with a caption.
  void drawBox(const ContactRegion& region, const std::string& words);
  // Start and end of the path, or where it enters the picture first and leaves it last. Call it last: the labels keep
  // clear of all that was drawn before.
  void drawEnds(const std::vector<TickRecord>& records);
  void drawScaleBar(const Vec3& at_W);  // true at the distance of this point
  void drawCaption(const std::string& words);

 private:
  struct Place {
    Pixel pixel;
    bool visible = false;
  };
  [[nodiscard]] bool isVisible(const Camera::Projection& p) const;
  [[nodiscard]] std::vector<Place> places(const std::vector<Vec3>& points_W) const;
  void drawPlaces(const std::vector<Place>& places, const Color& color, double line);
  [[nodiscard]] bool isInside(const Vec3& p_W) const;
  void writeInto(const LabelBox& box, const std::string& words, double size, const Color& color);
  void drawWords(const Pixel& at, double gap, const std::string& words, double size, const Color& color);
  Canvas& canvas_;
  const Camera& camera_;
  const RenderedImage& image_;
  double tolerance_m_, scale_;
  LabelPlacer labels_;
};

}  // namespace palpate
