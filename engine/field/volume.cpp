// SPDX-License-Identifier: Apache-2.0
#include "engine/field/volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/module.hpp"
#include "base/units.hpp"
#include "engine/field/field_grid.hpp"
#include "engine/field/raw_values.hpp"

namespace palpate {

std::string Rounding::words() const {
  if (count == 0) return "";
  return fmt::format("{} of its {} values are no 32-bit floats and were rounded, by {:.3g} at most", count, of, most);
}

namespace {

// A cell of eight voxels, and a place in it.
struct Cell {
  Vec3i first;
  Vec3 fraction;  // in [0, 1]
};

// The cell that holds a point of index space; the domain's last face belongs to the last cell. Empty outside the domain
// and for NaN.
std::optional<Cell> cellAt(const Vec3& p_L, const Vec3i& size) {
  const auto last = size.cast<double>().array() - 1;
  if (!((p_L.array() >= 0).all() && (p_L.array() <= last).all())) return std::nullopt;
  const Vec3i first = p_L.array().floor().cast<int>().matrix().cwiseMin(size - Vec3i::Constant(2)).cwiseMax(0);
  return Cell{first, p_L - first.cast<double>()};
}

// The voxels of a cell and `beside` voxels on each side of them, as far as the domain goes.
template <int beside>
class Neighbourhood {
 public:
  Neighbourhood(const FieldGrid& field, const Vec3i& cell, const Vec3i& last)
      : first_((cell - Vec3i::Constant(beside)).cwiseMax(0)),
        size_((cell + Vec3i::Constant(1 + beside)).cwiseMin(last) - first_ + Vec3i::Ones()) {
    field.readBox(first_, size_, values_.data());
  }
  // A voxel beyond the end of an axis of one voxel is that voxel.
  [[nodiscard]] double at(const Vec3i& voxel) const {
    const Vec3i place = (voxel - first_).cwiseMin(size_ - Vec3i::Ones());
    return values_[static_cast<std::size_t>((std::ptrdiff_t{place.z()} * size_.y() + place.y()) * size_.x() +
                                            place.x())];
  }

 private:
  static constexpr std::size_t kWide = 2 + 2 * beside;
  Vec3i first_, size_;
  std::array<float, kWide * kWide * kWide> values_;
};

double cornerWeight(const Vec3& fraction, int corner) {
  double weight = 1;
  for (const int axis : {0, 1, 2}) weight *= (corner >> axis & 1) != 0 ? fraction[axis] : 1 - fraction[axis];
  return weight;
}

Vec3i cornerOf(const Cell& cell, int corner) {
  return cell.first + Vec3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
}

}  // namespace

Volume::Volume(std::unique_ptr<Grid> grid) : grid_(std::move(grid)) {}
Volume::Volume(Volume&&) noexcept = default;
Volume& Volume::operator=(Volume&&) noexcept = default;
Volume::~Volume() = default;

Volume Volume::fromDense(const Vec3i& size, const Lattice& lattice, const std::vector<float>& values,
                         VolumeFacts facts) {
  if (size.minCoeff() > 0 && values.size() != static_cast<std::size_t>(size.cast<long long>().prod())) {
    throw Error(
        Error::Code::kBadInput, facts.source,
        fmt::format("{} values were given for {} x {} x {} voxels", values.size(), size.x(), size.y(), size.z()),
        "give one value a voxel");
  }
  const std::span<const char> raw(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  BrickSource source = rawBricks(raw, ValueType::kFloat32, size);
  return Volume(loadModule<FieldModule>().buildByLayers(size, lattice, std::move(facts), [&](int) { return source; }));
}

Volume Volume::fromBricks(const Vec3i& size, const Lattice& lattice, VolumeFacts facts, const BrickSource& source) {
  return Volume(loadModule<FieldModule>().build(size, lattice, std::move(facts), source));
}

Volume Volume::fromLayers(const Vec3i& size, const Lattice& lattice, VolumeFacts facts, const LayerSource& layers) {
  return Volume(loadModule<FieldModule>().buildByLayers(size, lattice, std::move(facts), layers));
}

const Vec3i& Volume::size() const noexcept {
  return grid_->size;
}
const Lattice& Volume::lattice() const noexcept {
  return grid_->lattice;
}
const VolumeFacts& Volume::facts() const noexcept {
  return grid_->facts;
}
float Volume::minimum() const noexcept {
  return grid_->minimum;
}
float Volume::maximum() const noexcept {
  return grid_->maximum;
}
const Volume::Grid& Volume::grid() const noexcept {
  return *grid_;
}

float Volume::value(const Vec3i& index) const {
  const Vec3i inside = index.cwiseMin(size() - Vec3i::Ones()).cwiseMax(0);
  return grid_->field->value(inside);
}

Vec3i Volume::brickCount() const noexcept {
  return (size() + Vec3i::Constant(kBrickSize - 1)) / kBrickSize;
}

bool Volume::readBrick(const Vec3i& brick, float* values) const {
  return grid_->field->readBrick(brick, values);
}

void Volume::setBrick(const Vec3i& brick, const float* values) {
  const auto [lowest, highest] = std::minmax_element(values, values + kBrickVoxels);
  grid_->minimum = std::min(grid_->minimum, *lowest);
  grid_->maximum = std::max(grid_->maximum, *highest);
  grid_->field->setBrick(size(), brick, values);
}

void Volume::setConstantBrick(const Vec3i& brick, float value) {
  grid_->minimum = std::min(grid_->minimum, value);
  grid_->maximum = std::max(grid_->maximum, value);
  grid_->field->setConstantBrick(brick, value);
}

void Volume::remark(const std::string& words) {
  std::string& all = grid_->facts.remark;
  all += (all.empty() ? "" : "; ") + words;
}

void Volume::noteRounding(Rounding rounded) noexcept {
  grid_->facts.rounded = std::move(rounded);
}

void Volume::rename(std::string source) noexcept {
  grid_->facts.source = std::move(source);
}

void Volume::keepIsovalue(double isovalue) noexcept {
  grid_->facts.kept_isovalue = isovalue;
}

std::vector<float> Volume::toDense() const {
  std::vector<float> dense(static_cast<std::size_t>(size().cast<long long>().prod()));
  std::vector<float> brick_values(kBrickVoxels);
  const Vec3i bricks = brickCount();
  for (int n = 0; n < bricks.prod(); ++n) {
    const Vec3i brick(n % bricks.x(), n / bricks.x() % bricks.y(), n / bricks.x() / bricks.y());
    if (readBrick(brick, brick_values.data())) std::fill(brick_values.begin(), brick_values.end(), brick_values[0]);
    const Vec3i first = brick * kBrickSize;
    const Vec3i inside = (size() - first).cwiseMin(Vec3i::Constant(kBrickSize));
    for (int k = 0; k < inside.z(); ++k) {
      for (int j = 0; j < inside.y(); ++j) {
        const float* from = brick_values.data() + (std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize;
        const std::size_t row = static_cast<std::size_t>(first.z() + k) * static_cast<std::size_t>(size().y()) +
                                static_cast<std::size_t>(first.y() + j);
        std::copy_n(from, inside.x(), dense.data() + row * static_cast<std::size_t>(size().x()) + first.x());
      }
    }
  }
  return dense;
}

std::optional<double> Volume::density(const Vec3& p_W) const {
  const std::optional<Cell> cell = cellAt(lattice().toIndex(p_W), size());
  if (!cell) return std::nullopt;
  const Neighbourhood<0> around(*grid_->field, cell->first, size() - Vec3i::Ones());
  double density = 0;
  for (int corner = 0; corner < 8; ++corner)
    density += cornerWeight(cell->fraction, corner) * around.at(cornerOf(*cell, corner));
  return density;
}

bool Volume::sample(const Vec3& p_W, double& density, Vec3& gradient_W) const {
  const std::optional<Cell> cell = cellAt(lattice().toIndex(p_W), size());
  if (!cell) return false;
  const Vec3i last = size() - Vec3i::Ones();
  const Neighbourhood<1> around(*grid_->field, cell->first, last);
  density = 0;
  Vec3 gradient_L = Vec3::Zero();  // [density/m], along the lattice's axes
  for (int corner = 0; corner < 8; ++corner) {
    const double weight = cornerWeight(cell->fraction, corner);
    const Vec3i at = cornerOf(*cell, corner);
    density += weight * around.at(at);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i before = at;
      Vec3i after = at;
      before[axis] = std::max(at[axis] - 1, 0);
      after[axis] = std::min(at[axis] + 1, last[axis]);
      if (before == after) continue;
      const double run_m = (after[axis] - before[axis]) * lattice().spacing_m[axis];
      gradient_L[axis] += weight * (around.at(after) - around.at(before)) / run_m;
    }
  }
  gradient_W = lattice().gradientToWorld(gradient_L);
  return true;
}

void checkTouchable(const Volume& volume) {
  const Vec3i& size = volume.size();
  if (size.minCoeff() < 2) {
    throw Error(Error::Code::kBadInput, volume.facts().source,
                fmt::format("it has {} x {} x {} voxels, and a surface needs two along every axis", size.x(), size.y(),
                            size.z()),
                "give a volume of more slices");
  }
  // Operators add up to 32 densities before they divide, and divide by the voxel's size.
  constexpr double kSummed = 32;
  const double low = volume.minimum(), high = volume.maximum(), voxel_m = volume.lattice().smallestSpacing();
  const double largest = kSummed * std::max({std::abs(low), std::abs(high), (high - low) / voxel_m});
  if (largest <= static_cast<double>(std::numeric_limits<float>::max())) return;
  throw Error(Error::Code::kBadInput, volume.facts().source,
              fmt::format("its densities, {:g} to {:g} in voxels of {:g} mm, have gradients that fit no float", low,
                          high, voxel_m * kMillimetresPerMetre),
              "divide the densities by a constant");
}

std::size_t Volume::storedBytes() const {
  return grid_->field->storedBytes();
}
std::size_t Volume::storedBricks() const {
  return grid_->field->storedBricks();
}

}  // namespace palpate
