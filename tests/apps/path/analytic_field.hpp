// SPDX-License-Identifier: Apache-2.0
// Fields given by a formula: density is the signed distance to the surface [m], positive inside; isovalue 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "apps/path/surface_field.hpp"

namespace palpate {

// Reads a block sample by sample; never reports it as constant.
template <typename Sample>
bool readSamples(const Vec3i& block, const Vec3i& size, float* values, Sample sample) {
  for (int n = 0; n < kFieldBlockSamples; ++n) {
    const Vec3i i =
        kFieldBlock * block + Vec3i(n % kFieldBlock, n / kFieldBlock % kFieldBlock, n / kFieldBlock / kFieldBlock);
    values[n] = (i.array() < size.array()).all() ? static_cast<float>(sample(i)) : 0;
  }
  return false;
}

class AnalyticField : public SurfaceField {
 public:
  using Formula = std::function<double(const Vec3&)>;
  // A cube from -half_m to half_m along each axis, with samples `voxel_m` apart. sample() evaluates the formula itself.
  AnalyticField(Formula formula, double half_m, double voxel_m) : formula_(std::move(formula)), half_m_(half_m) {
    lattice_.origin_W = Vec3::Constant(-half_m);
    lattice_.spacing_m = Vec3::Constant(voxel_m);
    size_ = Vec3i::Constant(static_cast<int>(std::lround(2 * half_m / voxel_m)) + 1);
  }
  bool sample(const Vec3& p_W, double& density, Vec3& gradient_W) const override {
    if (p_W.cwiseAbs().maxCoeff() > half_m_) return false;
    constexpr double kStep_m = 1e-6;
    density = formula_(p_W);
    for (int i = 0; i < 3; ++i) {
      const Vec3 step_W = kStep_m * Vec3::Unit(i);
      gradient_W[i] = (formula_(p_W + step_W) - formula_(p_W - step_W)) / (2 * kStep_m);
    }
    return true;
  }
  [[nodiscard]] double isovalue() const override { return isovalue_; }
  [[nodiscard]] const Lattice& lattice() const override { return lattice_; }
  [[nodiscard]] Vec3i size() const override { return size_; }
  bool readBlock(const Vec3i& block, float* values) const override {
    return readSamples(block, size_, values,
                       [this](const Vec3i& i) { return formula_(lattice_.toWorld(i.cast<double>())); });
  }
  void setIsovalue(double isovalue) { isovalue_ = isovalue; }

 private:
  Formula formula_;
  double half_m_, isovalue_ = 0;
  Lattice lattice_;
  Vec3i size_;
};

// Another field's values at its samples, interpolated as in a volume; gradients by central differences.
class SampledField : public SurfaceField {
 public:
  explicit SampledField(const SurfaceField& field)
      : lattice_(field.lattice()), size_(field.size()), isovalue_(field.isovalue()) {
    Vec3 ignored;
    values_.resize(static_cast<std::size_t>(size_.prod()));
    for (int i = 0; i < size_.prod(); ++i) {
      const Vec3 p_L = Vec3i(i % size_.x(), i / size_.x() % size_.y(), i / size_.x() / size_.y()).cast<double>();
      field.sample(lattice_.toWorld(p_L) * (1 - 1e-12), values_[static_cast<std::size_t>(i)], ignored);
    }
  }
  bool sample(const Vec3& p_W, double& density, Vec3& gradient_W) const override {
    const Vec3 p_L = lattice_.toIndex(p_W);
    if ((p_L.array() < 0).any() || (p_L.array() > size_.array().cast<double>() - 1).any()) return false;
    density = interpolated(p_L);
    for (int i = 0; i < 3; ++i) {
      gradient_W[i] =
          (interpolated(p_L + Vec3::Unit(i)) - interpolated(p_L - Vec3::Unit(i))) / (2 * lattice_.spacing_m[i]);
    }
    return true;
  }
  [[nodiscard]] double isovalue() const override { return isovalue_; }
  [[nodiscard]] const Lattice& lattice() const override { return lattice_; }
  [[nodiscard]] Vec3i size() const override { return size_; }
  bool readBlock(const Vec3i& block, float* values) const override {
    return readSamples(block, size_, values, [this](const Vec3i& i) { return value(i); });
  }
  void setIsovalue(double isovalue) { isovalue_ = isovalue; }

 private:
  [[nodiscard]] double value(Vec3i i) const {
    i = i.cwiseMax(0).cwiseMin(size_ - Vec3i::Ones());
    return values_[i.x() + size_.x() * (i.y() + size_.y() * static_cast<std::size_t>(i.z()))];
  }
  [[nodiscard]] double interpolated(const Vec3& p_L) const {
    const Vec3 floor = p_L.array().floor(), t = p_L - floor;
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i bit(corner & 1, corner >> 1 & 1, corner >> 2);
      double weight = 1;
      for (int k = 0; k < 3; ++k) weight *= bit[k] ? t[k] : 1 - t[k];
      sum += weight * value(floor.cast<int>() + bit);
    }
    return sum;
  }
  Lattice lattice_;
  Vec3i size_;
  double isovalue_;
  std::vector<double> values_;
};

inline double sphereDistance(const Vec3& p, double radius_m) {
  return radius_m - p.norm();
}

inline double boxDistance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return -(q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0));
}

// A slab 40 x 40 x 20 mm, its top at z = 10 mm, with a round hole of radius 5 mm and depth 8 mm from the top, at the
// middle.
inline double slabWithHole(const Vec3& p) {
  const double across = std::hypot(p.x(), p.y()) - 5e-3, down = 2e-3 - p.z();
  const double hole = std::hypot(std::max(across, 0.0), std::max(down, 0.0)) + std::min(std::max(across, down), 0.0);
  return std::min(boxDistance(p, Vec3(20e-3, 20e-3, 10e-3)), hole);
}

}  // namespace palpate
