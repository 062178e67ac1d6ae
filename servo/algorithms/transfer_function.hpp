// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/transfer_function.hpp: from density and gradient magnitude to a force and a viscosity.
//
// There are two tables: density -> force and viscosity, gradient magnitude -> weight of the force. They are piecewise
// linear between their rows and constant before the first and after the last. Source of the idea: the paper, section
// 2.1, after Iwata and Noma, "Volume haptization" (1993), and the opacity transfer functions of volume rendering, which
// the tables are meant to match. Units: density; gradient [density/m]; force [N]; viscosity [N s/m]; weight [-].
// Thread: made at set-up (allocates, throws), evaluated in the servo. Cost of at(): some ns for tables of a few rows.
// Errors: Error(kBadInput) when made.
#pragma once

#include <vector>

namespace palpate {

struct DensityRow {
  double density = 0;
  double force_N = 0;             // down the gradient; negative: up the gradient
  double viscosity_Ns_per_m = 0;  // 0 or more

  [[nodiscard]] bool operator==(const DensityRow&) const = default;
};

struct GradientRow {
  double gradient_per_m = 0;  // magnitude [density/m]
  double weight = 1;          // factor of the force, 0 or more

  [[nodiscard]] bool operator==(const GradientRow&) const = default;
};

struct TransferTables {
  std::vector<DensityRow> density;
  std::vector<GradientRow> gradient;  // empty: weight 1 everywhere

  [[nodiscard]] bool operator==(const TransferTables&) const = default;
};

// The range of a volume's densities. standard() makes tables from it if a scene gives none.
struct DensityScale {
  double contrast = 1;    // from the isovalue up to the volume's highest density
  double voxel_m = 1e-3;  // smallest side of a voxel
};

class TransferFunction {
 public:
  struct Value {
    double force_N = 0;
    double viscosity_Ns_per_m = 0;
  };

  // The force and viscosity that standard() gives in the densest half of the contrast.
  static constexpr double kStandardForce_N = 3;
  static constexpr double kStandardViscosity_Ns_per_m = 2;

  // Throws Error(kBadInput) on an empty density table, a value that is not finite, densities or gradients that do not
  // ascend, a negative viscosity, gradient or weight.
  explicit TransferFunction(TransferTables tables);

  // Force and viscosity grow from nothing at the isovalue to kStandardForce_N and kStandardViscosity_Ns_per_m at half
  // the contrast above it. The force's weight grows from 0 without a gradient to 1 at a gradient of a twentieth of the
  // contrast per voxel, so that noise in flat regions is not felt. A contrast of 0 or less counts as 1.
  [[nodiscard]] static TransferTables standard(double isovalue, const DensityScale& scale);

  [[nodiscard]] Value at(double density, double gradient_per_m) const noexcept;

 private:
  std::vector<DensityRow> density_;
  std::vector<GradientRow> gradient_;
};

}  // namespace palpate
