// SPDX-License-Identifier: Apache-2.0
// A field given sample by sample, on a lattice of any spacing, interpolated as a volume is; isovalue 0, background -1.
#pragma once

#include <vector>

#include "analytic_field.hpp"

namespace palpate {

class GridField : public SurfaceField {
 public:
  GridField(const Vec3i& size, const Vec3& spacing_m)
      : size_(size), values_(static_cast<std::size_t>(size.prod()), -1.0F) {
    lattice_.spacing_m = spacing_m;
    lattice_.origin_W = -0.5 * (size.cast<double>() - Vec3::Ones()).cwiseProduct(spacing_m);
  }
  // The formula's value at every sample: a signed distance, positive inside, in metres.
  template <typename Formula>
  GridField(const Vec3i& size, const Vec3& spacing_m, Formula formula) : GridField(size, spacing_m) {
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i i(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      set(i, static_cast<float>(formula(lattice_.toWorld(i.cast<double>()))));
    }
  }
  void set(const Vec3i& i, float value) { values_[at(i)] = value; }
  void fill(const Vec3i& first, const Vec3i& last, float value) {
    for (int k = first.z(); k <= last.z(); ++k) {
      for (int j = first.y(); j <= last.y(); ++j) {
        for (int i = first.x(); i <= last.x(); ++i) set({i, j, k}, value);
      }
    }
  }
  [[nodiscard]] float value(const Vec3i& i) const { return values_[at(i.cwiseMax(0).cwiseMin(size_ - Vec3i::Ones()))]; }

  // As Volume::sample(): central differences at the samples, interpolated as the density is.
  bool sample(const Vec3& p_W, double& density, Vec3& gradient_W) const override {
    const Vec3 p_L = lattice_.toIndex(p_W), last_L = size_.cast<double>() - Vec3::Ones();
    if ((p_L.array() < -1e-9).any() || (p_L.array() > last_L.array() + 1e-9).any()) return false;
    const Vec3 floor = p_L.array().floor(), t = p_L - floor;
    density = 0;
    gradient_W = Vec3::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i bit(corner & 1, corner >> 1 & 1, corner >> 2), i = floor.cast<int>() + bit;
      double weight = 1;
      for (int k = 0; k < 3; ++k) weight *= bit[k] ? t[k] : 1 - t[k];
      density += weight * value(i);
      for (int k = 0; k < 3; ++k) {
        const Vec3i step = Vec3i::Unit(k);
        const double way = i[k] <= 0 || i[k] >= size_[k] - 1 ? 1 : 2;
        gradient_W[k] += weight * (value(i + step) - value(i - step)) / (way * lattice_.spacing_m[k]);
      }
    }
    return true;
  }
  [[nodiscard]] double isovalue() const override { return 0; }
  [[nodiscard]] const Lattice& lattice() const override { return lattice_; }
  [[nodiscard]] Vec3i size() const override { return size_; }
  // Samples beyond the size are object. A block at the border is constant if its samples within the size are equal.
  bool readBlock(const Vec3i& block, float* values) const override {
    const Vec3i first = kFieldBlock * block;
    bool is_constant = true;
    for (int n = 0; n < kFieldBlockSamples; ++n) {
      const Vec3i i = first + Vec3i(n % kFieldBlock, n / kFieldBlock % kFieldBlock, n / kFieldBlock / kFieldBlock);
      const bool is_inside = (i.array() < size_.array()).all();
      values[n] = is_inside ? value(i) : 1.0F;
      is_constant = is_constant && (!is_inside || values[n] == values[0]);
    }
    return is_constant;
  }

 private:
  [[nodiscard]] std::size_t at(const Vec3i& i) const {
    return i.x() + size_.x() * (i.y() + size_.y() * static_cast<std::size_t>(i.z()));
  }
  Lattice lattice_;
  Vec3i size_;
  std::vector<float> values_;
};

}  // namespace palpate
