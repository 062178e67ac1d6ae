// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/hri_paper.hpp: HRI as the paper's Figure 2 prints it, so that its results can be repeated.
//
// To the letter, with what that brings: the counter renews a plane every n + 1 ticks (it goes 0, 1 ... n and renews in
// the tick after it has reached n) and is not reset when contact makes a plane; the plane is on the line from VHIP to
// HIP, also where both are inside (then the interpolation extrapolates); F = K d - B v_d may pull. Density and normal
// come from the window's samples, whose gradients are the engine's central differences (the paper takes them at p).
// Where Figure 2 says nothing: a HIP beyond the window gets no force and a fault; a plane that cannot be computed
// (equal densities, zero gradient, p beyond the window) is no plane, with kZeroGradient; a VHIP beyond the volume has
// density -infinity, and the interpolation takes its limit, p = HIP. Source: the paper, Figure 2, equations 1 to 3.
// The VHIP of the line is the one on the plane, not what contact effects make of it.
// Sign of d as in algorithm.hpp. Thread: the servo's. Cost: one fetch in free space and without renewal none, two or
// three with. Errors: faults only.
#pragma once

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"
#include "servo/window/window_sampler.hpp"

namespace palpate {

class HriPaperSurface {
 public:
  static constexpr bool kMayPull = true;

  explicit HriPaperSurface(const AlgorithmParameters& parameters) noexcept
      : isovalue_(parameters.isovalue), n_(parameters.plane_renewal_ticks) {}
  void reset(const Vec3& hip_W) noexcept;
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] ContactPlane plane() const noexcept { return {p_W_, normal_W_, has_plane_ ? age_ticks_ : 0}; }

 private:
  void updatePlane(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  void makePlane(const WindowSampler& sampler, const Fetch& at_vhip, const Fetch& at_hip, const Vec3& hip_W,
                 std::uint32_t& faults) noexcept;

  double isovalue_;
  int n_;
  Vec3 vhip_W_ = Vec3::Zero();
  Vec3 p_W_ = Vec3::Zero();
  Vec3 normal_W_ = Vec3::Zero();
  bool has_plane_ = false;  // VirtualPlane != (0, 0)
  int c_ = 0;               // the paper's counter [tick]
  std::int32_t age_ticks_ = 0;
};

using HriPaper = VhipAlgorithm<HriPaperSurface>;

}  // namespace palpate
