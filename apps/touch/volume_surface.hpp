// SPDX-License-Identifier: Apache-2.0
// apps/touch/volume_surface.hpp: a volume and its isovalue as the SurfaceField that paths are built from. Any thread.
#pragma once

#include "apps/path/surface_field.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

static_assert(kFieldBlock == kBrickSize);

class VolumeSurface final : public SurfaceField {
 public:
  VolumeSurface(const Volume& volume, double isovalue) : volume_(volume), isovalue_(isovalue) {}

  bool sample(const Vec3& p_W, double& density, Vec3& gradient_W) const override {
    return volume_.sample(p_W, density, gradient_W);
  }
  [[nodiscard]] std::optional<double> density(const Vec3& p_W) const override { return volume_.density(p_W); }
  [[nodiscard]] double isovalue() const override { return isovalue_; }
  [[nodiscard]] const Lattice& lattice() const override { return volume_.lattice(); }
  [[nodiscard]] Vec3i size() const override { return volume_.size(); }
  bool readBlock(const Vec3i& block, float* values) const override { return volume_.readBrick(block, values); }

 private:
  const Volume& volume_;
  double isovalue_;
};

}  // namespace palpate
