// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/grid.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

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

  // Of voxels that are all finite.
  void addRange(float lowest, float highest) {
    minimum_ = std::min(minimum_, lowest);
    maximum_ = std::max(maximum_, highest);
  }

  void merge(const ValueSurvey& other) {
    addRange(other.minimum_, other.maximum_);
    if (other.bad_count_ == 0) return;
    first_bad_ = bad_count_ == 0 ? other.first_bad_ : std::min(first_bad_, other.first_bad_);
    bad_count_ += other.bad_count_;
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

// What 512 values have in common. Eight lanes, so that the compiler may take eight values at once; a quarter of the
// time.
struct BrickSurvey {
  bool constant = true, finite = true;
  float lowest = 0, highest = 0;
};

BrickSurvey surveyWhole(const float* values) {
  constexpr int kLanes = 8;
  constexpr std::uint32_t kExponent = 0x7f800000U;
  const auto first = std::bit_cast<std::uint32_t>(values[0]);
  std::array<float, kLanes> low, high;
  std::array<std::uint32_t, kLanes> differing = {}, bad = {};
  std::copy_n(values, kLanes, low.begin());
  high = low;
  for (int n = 0; n < kBrickVoxels; n += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float value = values[static_cast<std::size_t>(n) + lane];
      const auto bits = std::bit_cast<std::uint32_t>(value);
      low[lane] = value < low[lane] ? value : low[lane];
      high[lane] = value > high[lane] ? value : high[lane];
      differing[lane] |= bits ^ first;
      bad[lane] |= (bits & kExponent) == kExponent ? 1U : 0U;
    }
  }
  const auto none = [](const auto& flags) { return std::all_of(flags.begin(), flags.end(), std::logical_not<>()); };
  return {none(differing), none(bad), *std::min_element(low.begin(), low.end()),
          *std::max_element(high.begin(), high.end())};
}

// Adds the brick's voxels inside the domain to the survey and returns whether they all hold the same bits.
bool surveyBrick(const float* values, const Vec3i& first, const Vec3i& inside, ValueSurvey& survey) {
  if (inside.prod() == kBrickVoxels) {
    const BrickSurvey whole = surveyWhole(values);
    if (whole.finite) {
      survey.addRange(whole.lowest, whole.highest);
      return whole.constant;
    }
  }
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

using Leaf = ScalarTree::LeafNodeType;

// One layer of bricks.
struct Layer {
  explicit Layer(const Vec3i& size) : survey(size) {}
  ValueSurvey survey;
  std::vector<std::unique_ptr<Leaf>> leaves;
  std::vector<std::pair<openvdb::Coord, float>> tiles;

  void moveTo(ScalarTree& tree) {
    for (std::unique_ptr<Leaf>& leaf : leaves) tree.addLeaf(leaf.release());
    for (const auto& [corner, value] : tiles) tree.addTile(1, corner, value, true);
  }
};

Layer buildLayer(const Vec3i& size, int bk, const BrickSource& source) {
  Layer layer(size);
  std::array<float, kBrickVoxels> values = {};
  const Vec3i bricks = (size + Vec3i::Constant(kBrickSize - 1)) / kBrickSize;
  for (int bj = 0; bj < bricks.y(); ++bj) {
    for (int bi = 0; bi < bricks.x(); ++bi) {
      const Vec3i brick(bi, bj, bk);
      const Vec3i first = brick * kBrickSize;
      bool constant = source(brick, values.data());
      if (constant) layer.survey.add(values[0], first);
      if (!constant) constant = surveyBrick(values.data(), first, voxelsInside(size, brick), layer.survey);
      if (constant) {
        layer.tiles.emplace_back(openvdb::Coord(first.x(), first.y(), first.z()), values[0]);
      } else {
        layer.leaves.push_back(makeLeaf(size, brick, values.data()));
      }
    }
  }
  return layer;
}

// The domain's bricks are leaves and active tiles; every other tile is background.
void setBackground(ScalarTree& tree, float value) {
  const auto fill = [&](auto& node) {
    for (auto tile = node.beginValueAll(); tile; ++tile) {  // no children, unlike beginValueOff
      if (!tile.isValueOn()) tile.setValue(value);
    }
  };
  tree.root().setBackground(value, false);
  for (auto child = tree.root().beginChildOn(); child; ++child) {
    fill(*child);
    for (auto inner = child->beginChildOn(); inner; ++inner) fill(*inner);
  }
}

}  // namespace

std::unique_ptr<ScalarTree::LeafNodeType> makeLeaf(const Vec3i& size, const Vec3i& brick, const float* values) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i inside = voxelsInside(size, brick);
  const openvdb::Coord corner(first.x(), first.y(), first.z());
  if (inside.minCoeff() == kBrickSize) {
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), corner, 0.0F, true);  // not filled yet
    leaf->allocate();
    float* to = leaf->buffer().data();
    for (int i = 0; i < kBrickSize; ++i) {
      for (int jk = 0; jk < kBrickSize * kBrickSize; ++jk) {
        *to++ = values[(jk % kBrickSize * kBrickSize + jk / kBrickSize) * kBrickSize + i];
      }
    }
    return leaf;
  }
  auto leaf = std::make_unique<Leaf>(corner, 0.0F, false);
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
                                        const BrickSource& source, SourceCalls calls) {
  checkSize(size, facts.source);
  checkLattice(lattice, facts.source);
  auto grid = std::make_unique<Volume::Grid>();
  grid->field = ScalarGrid::create(0.0F);
  ScalarTree& tree = grid->field->tree();
  ValueSurvey survey(size);
  std::mutex one_at_a_time;
  const auto build = [&](int bk) {
    Layer layer = buildLayer(size, bk, source);
    const std::lock_guard lock(one_at_a_time);
    survey.merge(layer.survey);
    layer.moveTo(tree);
  };
  const int layers = (size.z() + kBrickSize - 1) / kBrickSize;
  if (calls == SourceCalls::kFromSeveralThreads) {
    tbb::parallel_for(0, layers, build);
  } else {
    for (int bk = 0; bk < layers; ++bk) build(bk);
  }
  survey.check(facts.source);
  setBackground(tree, survey.minimum());
  grid->size = size;
  grid->lattice = lattice;
  grid->facts = std::move(facts);
  grid->minimum = survey.minimum();
  grid->maximum = survey.maximum();
  return grid;
}

}  // namespace palpate
