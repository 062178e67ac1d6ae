// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/haptization.hpp: every density is felt: a force down the gradient and a viscosity, by a transfer
// function.
//
// Source: Iwata and Noma, "Volume haptization" (1993); the paper, section 2.1. With rho and g the density and its
// gradient at the HIP,
//   F = -f(rho) w(|g|) g / |g|  -  b(rho) v
// with f, b and w from the tables of a TransferFunction. The force points down the gradient, from dense to thin,
// wherever there is a gradient. The viscosity acts on motion in every direction, in flat regions too. So tissues
// without a boundary between them still differ. K, B and n of the scene mean nothing here.
// There is no surface: the VHIP is the HIP, and there are no contact effects. in_contact means that the force without
// viscosity is not zero; the normal then is -g / |g|. If the gradient is zero or not finite, there is no such force and
// no fault: flat regions are ordinary here.
// An edit adds force and viscosity at the place where the tool was when the edit came. These are taken in over time
// (edit_ease.hpp). What an edit takes away is gone at once.
// The method's weaknesses: no wall is stiffer than the table's force over the width of the boundary, and a hand that
// pushes harder passes through. The force at a density does not know on which side of a wall the tool is.
// Frame W: world. Thread: the servo's. Cost: one fetch, one more with an edit. Errors: faults.
#pragma once

#include <optional>

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/transfer_function.hpp"
#include "servo/contact/edit_ease.hpp"

namespace palpate {

class Haptization final : public Algorithm {
 public:
  // Throws Error(kBadInput) on tables that TransferFunction refuses.
  Haptization(const AlgorithmParameters& parameters, TransferTables tables)
      : transfer_(std::move(tables)),
        ease_force_(parameters.rate_hz),
        ease_viscosity_(parameters.rate_hz),
        field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept override;
  void tick(const TickInput& in, TickOutput& out) noexcept override;

 private:
  struct Felt {
    double force_N = 0;                                                        // along the normal
    double viscosity_Ns_per_m = 0;                                             // [N s/m]
    Vec3 normal_W = Vec3::Zero();                                              // zero where there is no force
    [[nodiscard]] Vec3 push_W() const noexcept { return force_N * normal_W; }  // [N]
  };
  [[nodiscard]] Felt feltAt(const Fetch& f) const noexcept;
  void takeEdit(const IsoField& field, const SampleWindow& window, const Felt& here, const Felt& shown) noexcept;

  TransferFunction transfer_;
  EditEase ease_force_;      // of its magnitude [N]
  EditEase ease_viscosity_;  // [N s/m]
  std::optional<std::uint64_t> edit_version_;
  Vec3 last_hip_W_ = Vec3::Zero();
  Felt last_;  // as shown in the last tick
  FieldCache field_;
};

}  // namespace palpate
