// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

void checkSize(const Vec3i& size, const std::string& input) {
  if (size.minCoeff() >= 2) return;
  throw Error(Error::Code::kBadInput, input,
              fmt::format("it has {} x {} x {} voxels, and a gradient needs two along every axis", size.x(), size.y(),
                          size.z()),
              "give a three-dimensional volume");
}

// Bits, not values: -0 and +0 must both survive.
bool sameBits(float a, float b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Voxels of a brick that lie in the domain, along each axis.
Vec3i voxelsInside(const Vec3i& size, const Vec3i& brick) {
  return (size - brick * kBrickSize).cwiseMin(Vec3i::Constant(kBrickSize));
}

// Gathers what must be known of all voxels: range, and the ones that are no number.
class ValueSurvey {
 public:
  explicit ValueSurvey(const Vec3i& size) : size_(size) {}

  void add(float value, const Vec3i& index) {
    if (!std::isfinite(value)) {
      addBad(index);
    } else {
      minimum_ = std::min(minimum_, value);
      maximum_ = std::max(maximum_, value);
    }
  }

  void check(const std::string& input) const {
    if (bad_count_ == 0) return;
    const auto [k, j, i] = first_bad_;
    throw Error(Error::Code::kBadInput, input,
                fmt::format("{} of its {} voxels are NaN or infinite, the first at index ({}, {}, {})", bad_count_,
                            size_.cast<long long>().prod(), i, j, k),
                "replace them by numbers");
  }

  [[nodiscard]] float minimum() const { return minimum_; }
  [[nodiscard]] float maximum() const { return maximum_; }

 private:
  // Bricks are visited one after another; "first" means first in the order of the file, i fastest.
  void addBad(const Vec3i& index) {
    const std::array<int, 3> key = {index.z(), index.y(), index.x()};
    first_bad_ = bad_count_ == 0 ? key : std::min(first_bad_, key);
    ++bad_count_;
  }

  Vec3i size_;
  float minimum_ = std::numeric_limits<float>::infinity();
  float maximum_ = -std::numeric_limits<float>::infinity();
  long long bad_count_ = 0;
  std::array<int, 3> first_bad_ = {0, 0, 0};  // k, j, i
};

// Adds the brick's voxels inside the domain to the survey and returns whether they all hold the same bits.
bool surveyBrick(const float* values, const Vec3i& first, const Vec3i& inside, ValueSurvey& survey) {
  bool constant = true;
  for (int k = 0; k < inside.z(); ++k) {
    for (int j = 0; j < inside.y(); ++j) {
      for (int i = 0; i < inside.x(); ++i) {
        const float value = values[(k * kBrickSize + j) * kBrickSize + i];
        survey.add(value, first + Vec3i(i, j, k));
        constant = constant && sameBits(value, values[0]);
      }
    }
  }
  return constant;
}

}  // namespace

std::unique_ptr<ScalarTree::LeafNodeType> makeLeaf(const Vec3i& size, const Vec3i& brick, const float* values) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i inside = voxelsInside(size, brick);
  auto leaf = std::make_unique<ScalarTree::LeafNodeType>(openvdb::Coord(first.x(), first.y(), first.z()), 0.0F, false);
  for (int k = 0; k < kBrickSize; ++k) {
    for (int j = 0; j < kBrickSize; ++j) {
      for (int i = 0; i < kBrickSize; ++i) {
        const auto offset = static_cast<openvdb::Index>((i * kBrickSize + j) * kBrickSize + k);
        const Vec3i nearest = Vec3i(i, j, k).cwiseMin(inside - Vec3i::Ones());
        const float value = values[(nearest.z() * kBrickSize + nearest.y()) * kBrickSize + nearest.x()];
        const bool active = i < inside.x() && j < inside.y() && k < inside.z();
        active ? leaf->setValueOn(offset, value) : leaf->setValueOff(offset, value);
      }
    }
  }
  return leaf;
}

std::unique_ptr<Volume::Grid> buildGrid(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                        const BrickSource& source) {
  checkSize(size, facts.source);
  checkLattice(lattice, facts.source);
  auto grid = std::make_unique<Volume::Grid>();
  grid->field = ScalarGrid::create(0.0F);
  ScalarTree& tree = grid->field->tree();
  ValueSurvey survey(size);
  std::array<float, kBrickVoxels> values = {};
  const Vec3i bricks = (size + Vec3i::Constant(kBrickSize - 1)) / kBrickSize;
  for (int bk = 0; bk < bricks.z(); ++bk) {
    for (int bj = 0; bj < bricks.y(); ++bj) {
      for (int bi = 0; bi < bricks.x(); ++bi) {
        const Vec3i brick(bi, bj, bk);
        const Vec3i first = brick * kBrickSize;
        const Vec3i inside = voxelsInside(size, brick);
        const openvdb::Coord corner(first.x(), first.y(), first.z());
        bool constant = source(brick, values.data());
        if (constant) survey.add(values[0], first);
        if (!constant) constant = surveyBrick(values.data(), first, inside, survey);
        if (constant) {
          tree.addTile(1, corner, values[0], true);
        } else {
          tree.addLeaf(makeLeaf(size, brick, values.data()).release());
        }
      }
    }
  }
  survey.check(facts.source);
  grid->size = size;
  grid->lattice = lattice;
  grid->facts = std::move(facts);
  grid->minimum = survey.minimum();
  grid->maximum = survey.maximum();
  return grid;
}

}  // namespace palpate
