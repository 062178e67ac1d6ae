// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/hri_paper.hpp: HRI as the paper's Figure 2 prints it, so that its results can be repeated.
//
// It follows the paper to the letter, with these consequences. The counter renews a plane every n + 1 ticks: it goes 0,
// 1 ... n and renews in the tick after it has reached n. It is not reset when contact makes a plane. F = K d - B v_d
// may pull. An edit is felt when the counter is up, and then whole at once. Density and normal come from the window's
// samples, whose gradients are the engine's central differences. (The paper takes central differences at p.)
//
// The paper says two things about the plane point p, and each is a mode:
// - HriPaper: p = LinearInterpolation(VHIP, HIP, tau), as Figure 2 calls it, from the densities at the two ends. If the
//   line leaves the density's ramp (half-width w), the interpolation does not meet the surface. Let the VHIP be e too
//   deep and the HIP at depth D > w. Then the new VHIP is e (1 - (D - e) / (w - e)) too deep. So beyond D = 2 w an
//   error grows from renewal to renewal (docs/hri-mends.md). If both ends are inside, the mode extrapolates.
// - HriPaperLine: "the position where v = tau" (section 3.1), the place on the line where the density is tau. From a
//   VHIP outside it is the first crossing on the way to the HIP. From a VHIP inside it is the first crossing on the
//   line's continuation away from the HIP, up to IsoField::kLongestWayOut. Without a crossing there is no plane, with
//   kSurfaceLost.
//
// Where Figure 2 says nothing:
// - A HIP beyond the window gets no force and a fault. HriPaperLine needs no density at the HIP. So it takes a HIP
//   behind its plane to be inside.
// - A plane that cannot be computed (equal densities, zero gradient, p beyond the window) is no plane, with
//   kZeroGradient.
// - A VHIP beyond the volume has density -infinity, and the interpolation takes its limit, p = HIP. (In HriPaperLine
//   the crossing is the volume's face.)
// - The line begins at the VHIP on the plane, not at the VHIP as moved by contact effects.
// Source: the paper, Figure 2, equations 1 to 3. Sign of d as in algorithm.hpp. Thread: the servo's. Cost: one fetch in
// free space, none in contact without renewal, two or three with renewal; HriPaperLine also takes what
// IsoField::firstEntry and firstExit take. Errors: faults only.
#pragma once

#include <optional>

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/plane_age.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

enum class PaperPoint { kFromTheEnds, kOnTheLine };

class HriPaperSurface {
 public:
  static constexpr bool kMayPull = true;
  static constexpr bool kEasesEdits = false;
  // The sag over n + 1 ticks, and over the way by which a new plane is behind the tool: it is found along the old
  // normal, which lags by an angle; at the depth D that is D / R of the lag, and so on from renewal to renewal.
  [[nodiscard]] static double planeAgeError(const PlaneAge& age) noexcept {
    return age.sag(age.way(age.n + 1) * (1 + age.curvature_per_m * age.depth_m));
  }

  explicit HriPaperSurface(const AlgorithmParameters& parameters, PaperPoint point = PaperPoint::kFromTheEnds) noexcept
      : point_(point), n_(parameters.plane_renewal_ticks), cache_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  void resume(const Vec3& free_W) noexcept { vhip_W_ = free_W; }
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] ContactPlane plane() const noexcept { return {p_W_, normal_W_, has_plane_ ? age_ticks_ : 0}; }

 private:
  void updatePlane(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  void makePlane(const IsoField& field, const Probe& vhip, const Probe& hip, std::uint32_t& faults) noexcept;
  [[nodiscard]] std::optional<Vec3> point(const IsoField& field, const Probe& vhip, const Probe& hip) const noexcept;

  PaperPoint point_;
  int n_;
  FieldCache cache_;
  Vec3 vhip_W_ = Vec3::Zero();
  Vec3 p_W_ = Vec3::Zero();
  Vec3 normal_W_ = Vec3::Zero();
  bool has_plane_ = false;  // VirtualPlane != (0, 0)
  int c_ = 0;               // the paper's counter [tick]
  std::int32_t age_ticks_ = 0;
};

class HriPaperLineSurface : public HriPaperSurface {
 public:
  explicit HriPaperLineSurface(const AlgorithmParameters& parameters) noexcept
      : HriPaperSurface(parameters, PaperPoint::kOnTheLine) {}
};

using HriPaper = VhipAlgorithm<HriPaperSurface>;
using HriPaperLine = VhipAlgorithm<HriPaperLineSurface>;

}  // namespace palpate
