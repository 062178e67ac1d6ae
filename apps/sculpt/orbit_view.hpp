// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/orbit_view.hpp: a camera that a person turns around an object with a mouse. Any thread; no cost.
//
// World: LPS [m]. Pixels of the picture, x to the right, y down.
#pragma once

#include "apps/render/fit_camera.hpp"
#include "base/camera.hpp"

namespace palpate {

class OrbitView {
 public:
  // Looks from the front at all of `extent`, which must not be empty.
  OrbitView(SeenExtent extent, int width, int height);

  [[nodiscard]] Camera camera() const;
  void resize(int width, int height);  // at least 1 x 1; the vertical angle of view stays

  // The object turns with the pointer: half a turn for the picture's height. It stops straight above and below.
  void orbit(double right_px, double down_px);
  // What is at `distance_m` along the view's axis moves with the pointer. 0: at the target's.
  void pan(double right_px, double down_px, double distance_m = 0);
  // Nearer by a tenth for each step, further for a negative one. What is at `towards_W` stays where it is in the
  // picture. Not nearer than kNearest of the extent's radius, not further than kFarthest of it.
  void zoom(double steps, const Vec3& towards_W);
  void turnTo(const ViewAngles& angles) { angles_ = angles; }
  void fit();                         // all of the extent, from the side that it is seen from
  void setExtent(SeenExtent extent);  // that fit() shows from now on

  [[nodiscard]] const Vec3& target_W() const noexcept { return target_W_; }
  [[nodiscard]] double distance_m() const noexcept { return distance_m_; }
  [[nodiscard]] const ViewAngles& angles() const noexcept { return angles_; }

  static constexpr double kFov_rad = 0.5;  // vertical
  static constexpr double kNearest = 1e-3, kFarthest = 100;

 private:
  [[nodiscard]] RenderRequest request() const;

  SeenExtent extent_;
  double radius_m_ = 0;  // of the extent
  int width_, height_;
  ViewAngles angles_;
  Vec3 target_W_;
  double distance_m_ = 0;
};

}  // namespace palpate
