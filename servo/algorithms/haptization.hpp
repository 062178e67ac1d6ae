// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/haptization.hpp: every density is felt: a force out of the dense and a viscosity, by a transfer
// function.
//
// Source: Iwata and Noma, "Volume haptization" (1993); the paper, section 2.1. With rho and g the density and its
// gradient at the HIP,
//   F = -f(rho) w(|g|) g / |g|  -  b(rho) v
// with f, b and w from the tables of a TransferFunction. The force points down the gradient, out of the dense, wherever
// there is one; the viscosity acts on motion in every direction, in flat regions too, so that tissues without a
// boundary between them still differ. K, B and n of the scene mean nothing here.
// There is no surface: no VHIP (it is the HIP), no contact effects. in_contact: the force part, without viscosity, is
// not zero; the normal then is -g / |g|. Where the gradient is zero or not finite there is no direction and so no
// force part, and no fault: flat regions are ordinary here.
// Weaknesses, which are the method's: no wall is stiffer than the table's force over the width of the boundary, and a
// hand that pushes harder passes through; the force at a density does not know on which side of a wall the tool is.
// Frame W: world. Thread: the servo's. Cost: one fetch. Errors: faults.
#pragma once

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/transfer_function.hpp"

namespace palpate {

class Haptization final : public Algorithm {
 public:
  // Throws Error(kBadInput) on tables that TransferFunction refuses.
  Haptization(const AlgorithmParameters& parameters, TransferTables tables)
      : transfer_(std::move(tables)), field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept override;
  void tick(const TickInput& in, TickOutput& out) noexcept override;

 private:
  TransferFunction transfer_;
  FieldCache field_;
};

}  // namespace palpate
