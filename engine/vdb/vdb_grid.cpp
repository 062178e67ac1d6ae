// SPDX-License-Identifier: Apache-2.0
#include "engine/vdb/vdb_grid.hpp"

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
#include "engine/field/brick_values.hpp"
#include "engine/field/finite_values.hpp"

namespace palpate {
namespace {

void checkSize(const Vec3i& size, const std::string& input) {
  if (size.minCoeff() >= 1) return;
  throw Error(Error::Code::kBadInput, input,
              fmt::format("it has {} x {} x {} voxels: none", size.x(), size.y(), size.z()), "give a volume");
}

// Voxels of a brick that lie in the domain, along each axis.
Vec3i voxelsInside(const Vec3i& size, const Vec3i& brick) {
  return (size - brick * kBrickSize).cwiseMin(Vec3i::Constant(kBrickSize));
}

// Gathers the range of all voxels, and the invalid ones.
class ValueSurvey {
 public:
  explicit ValueSurvey(const Vec3i& size) : size_(size) {}

  void add(float value, const Vec3i& index) {
    if (!std::isfinite(value)) {
      addBad(value, index);
    } else {
      minimum_ = std::min(minimum_, value);
      maximum_ = std::max(maximum_, value);
    }
  }

  void check(const std::string& input) const {
    if (bad_.count() == 0) return;
    const auto [k, j, i] = first_bad_;
    throw Error(Error::Code::kBadInput, input,
                fmt::format("{} of its {} voxels {}, the first at index ({}, {}, {})", bad_.count(),
                            size_.cast<long long>().prod(), bad_.words(), i, j, k),
                "replace them by numbers that a float can hold, or say with --nan which density they stand for");
  }

  // The range of voxels that are all finite.
  void addRange(float lowest, float highest) {
    minimum_ = std::min(minimum_, lowest);
    maximum_ = std::max(maximum_, highest);
  }

  void merge(const ValueSurvey& other) {
    addRange(other.minimum_, other.maximum_);
    if (other.bad_.count() == 0) return;
    first_bad_ = bad_.count() == 0 ? other.first_bad_ : std::min(first_bad_, other.first_bad_);
    bad_.add(other.bad_);
  }

  [[nodiscard]] float minimum() const { return minimum_; }
  [[nodiscard]] float maximum() const { return maximum_; }

 private:
  // Bricks are visited one after another, but "first" means first in the file's order, i fastest.
  void addBad(float value, const Vec3i& index) {
    const std::array<int, 3> key = {index.z(), index.y(), index.x()};
    first_bad_ = bad_.count() == 0 ? key : std::min(first_bad_, key);
    bad_.add(value);
  }

  Vec3i size_;
  float minimum_ = std::numeric_limits<float>::infinity();
  float maximum_ = -std::numeric_limits<float>::infinity();
  BadVoxels bad_;
  std::array<int, 3> first_bad_ = {0, 0, 0};  // k, j, i
};

// Vectors of four floats, which every processor has. The compiler does not vectorise the plain loop by itself.
constexpr int kLanes = 4;
using Floats [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using Bits [[gnu::vector_size(kLanes * sizeof(float))]] = std::int32_t;

Floats load(const float* from) {
  Floats values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

void store(float* to, Floats values) {
  std::memcpy(to, &values, sizeof values);
}

// Range of values, and whether they are finite and all the same, in four lanes.
struct LaneSurvey {
  explicit LaneSurvey(Floats values) : low(values), high(values) {}

  void add(Floats values, std::int32_t first) {
    constexpr std::int32_t kExponent = 0x7f800000;
    const auto bits = std::bit_cast<Bits>(values);
    low = values < low ? values : low;
    high = values > high ? values : high;
    differing |= bits ^ first;
    bad |= (bits & kExponent) == kExponent;
  }

  Floats low, high;
  Bits differing = {}, bad = {};
};

struct BrickSurvey {
  bool constant = true, finite = true;
  float lowest = 0, highest = 0;
};

// Two independent surveys side by side, so that no instruction waits for the one before it.
BrickSurvey surveyWhole(const float* values) {
  const auto first = std::bit_cast<std::int32_t>(values[0]);
  std::array<LaneSurvey, 2> halves = {LaneSurvey(load(values)), LaneSurvey(load(values + kLanes))};
  for (int n = 0; n < kBrickVoxels; n += 2 * kLanes) {
    halves[0].add(load(values + n), first);
    halves[1].add(load(values + n + kLanes), first);
  }
  BrickSurvey survey = {true, true, values[0], values[0]};
  for (const LaneSurvey& half : halves) {
    for (int lane = 0; lane < kLanes; ++lane) {
      survey.constant = survey.constant && half.differing[lane] == 0;
      survey.finite = survey.finite && half.bad[lane] == 0;
      survey.lowest = std::min(survey.lowest, half.low[lane]);
      survey.highest = std::max(survey.highest, half.high[lane]);
    }
  }
  return survey;
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

openvdb::Coord coord(const Vec3i& voxel) {
  return {voxel.x(), voxel.y(), voxel.z()};
}

openvdb::Coord cornerOf(const Vec3i& brick) {
  return coord(brick * kBrickSize);
}

// A leaf without values yet, all of it active.
std::unique_ptr<Leaf> emptyLeaf(const Vec3i& brick) {
  return std::make_unique<Leaf>(openvdb::PartialCreate(), cornerOf(brick), 0.0F, true);
}

// Reorders a brick's 512 values from Palpate's order (i fastest) to VDB's (k fastest), or back. Transposes in squares
// of four by four values.
void turnBrick(const float* from, float* to) {
  constexpr std::ptrdiff_t kRow = kBrickSize, kSlice = kRow * kBrickSize;
  for (int j = 0; j < kBrickSize; ++j) {
    for (int i = 0; i < kBrickSize; i += kLanes) {
      for (int k = 0; k < kBrickSize; k += kLanes) {
        const float* in = from + k * kSlice + j * kRow + i;
        float* out = to + i * kSlice + j * kRow + k;
        const Floats a = load(in), b = load(in + kSlice), c = load(in + 2 * kSlice), d = load(in + 3 * kSlice);
        const Floats ac01 = __builtin_shufflevector(a, c, 0, 4, 1, 5), ac23 = __builtin_shufflevector(a, c, 2, 6, 3, 7);
        const Floats bd01 = __builtin_shufflevector(b, d, 0, 4, 1, 5), bd23 = __builtin_shufflevector(b, d, 2, 6, 3, 7);
        store(out, __builtin_shufflevector(ac01, bd01, 0, 4, 1, 5));
        store(out + kSlice, __builtin_shufflevector(ac01, bd01, 2, 6, 3, 7));
        store(out + 2 * kSlice, __builtin_shufflevector(ac23, bd23, 0, 4, 1, 5));
        store(out + 3 * kSlice, __builtin_shufflevector(ac23, bd23, 2, 6, 3, 7));
      }
    }
  }
}

// Makes a leaf from a brick's 512 densities (i fastest). Its voxels inside the domain are active.
std::unique_ptr<Leaf> makeLeaf(const Vec3i& size, const Vec3i& brick, const float* values) {
  const Vec3i inside = voxelsInside(size, brick);
  if (inside.minCoeff() == kBrickSize) {
    std::unique_ptr<Leaf> leaf = emptyLeaf(brick);
    leaf->allocate();
    turnBrick(values, leaf->buffer().data());
    return leaf;
  }
  auto leaf = std::make_unique<Leaf>(cornerOf(brick), 0.0F, false);
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

// Moves the values of `leaf` into the layer, as its brick. Returns false and changes nothing if a value is not finite.
bool takeOver(const Vec3i& brick, Leaf& leaf, Layer& layer) {
  const float* values = leaf.buffer().data();
  const BrickSurvey survey = surveyWhole(values);
  if (!survey.finite) return false;
  layer.survey.addRange(survey.lowest, survey.highest);
  if (survey.constant) {
    layer.tiles.emplace_back(cornerOf(brick), values[0]);
  } else {
    layer.leaves.push_back(emptyLeaf(brick));
    layer.leaves.back()->swap(leaf.buffer());
  }
  return true;
}

Layer buildLayer(const Vec3i& size, int bk, const BrickSource& source, const LeafSource& leaf_of) {
  Layer layer(size);
  std::array<float, kBrickVoxels> values = {};
  const Vec3i bricks = (size + Vec3i::Constant(kBrickSize - 1)) / kBrickSize;
  for (int bj = 0; bj < bricks.y(); ++bj) {
    for (int bi = 0; bi < bricks.x(); ++bi) {
      const Vec3i brick(bi, bj, bk);
      Leaf* leaf = leaf_of ? leaf_of(brick) : nullptr;
      if (leaf != nullptr && takeOver(brick, *leaf, layer)) continue;
      const Vec3i first = brick * kBrickSize;
      bool constant = source(brick, values.data());
      if (constant && !std::isfinite(values[0])) {  // surveyed voxel by voxel, so that each one is counted
        values.fill(values[0]);
        constant = false;
      }
      if (constant) layer.survey.add(values[0], first);
      if (!constant) constant = surveyBrick(values.data(), first, voxelsInside(size, brick), layer.survey);
      if (constant) {
        layer.tiles.emplace_back(cornerOf(brick), values[0]);
      } else {
        layer.leaves.push_back(makeLeaf(size, brick, values.data()));
      }
    }
  }
  return layer;
}

// Gives every inactive tile the background's value. The domain's bricks are leaves and active tiles.
void setBackground(ScalarTree& tree, float value) {
  const auto fill = [&](auto& node) {
    for (auto tile = node.beginValueAll(); tile; ++tile) {  // beginValueOff would visit children too
      if (!tile.isValueOn()) tile.setValue(value);
    }
  };
  tree.root().setBackground(value, false);
  for (auto child = tree.root().beginChildOn(); child; ++child) {
    fill(*child);
    for (auto inner = child->beginChildOn(); inner; ++inner) fill(*inner);
  }
}

// Assembles the grid from layers, which several threads add at once.
class GridMaker {
 public:
  GridMaker(const Vec3i& size, const Lattice& lattice, const std::string& input)
      : grid_(std::make_unique<Volume::Grid>()), survey_(size) {
    checkSize(size, input);
    checkLattice(lattice, input);
    grid_->size = size;
    auto field = std::make_unique<VdbGrid>();
    tree_ = &field->grid->tree();
    grid_->field = std::move(field);
  }

  [[nodiscard]] int layers() const { return (grid_->size.z() + kBrickSize - 1) / kBrickSize; }

  void add(Layer layer) {
    const std::lock_guard lock(one_at_a_time_);
    survey_.merge(layer.survey);
    layer.moveTo(*tree_);
  }

  [[nodiscard]] std::unique_ptr<Volume::Grid> finish(const Lattice& lattice, VolumeFacts facts) {
    survey_.check(facts.source);
    facts.instead_of_nan.reset();  // it holds for the file only: whatever is computed from this volume must be finite
    setBackground(*tree_, survey_.minimum());
    grid_->lattice = lattice;
    grid_->facts = std::move(facts);
    grid_->minimum = survey_.minimum();
    grid_->maximum = survey_.maximum();
    return std::move(grid_);
  }

 private:
  std::unique_ptr<Volume::Grid> grid_;
  ScalarTree* tree_ = nullptr;
  std::mutex one_at_a_time_;
  ValueSurvey survey_;
};

}  // namespace

float VdbGrid::value(const Vec3i& voxel) const {
  return grid->constTree().getValue(coord(voxel));
}

void VdbGrid::readBox(const Vec3i& first, const Vec3i& size, float* values) const {
  const openvdb::tree::ValueAccessor<const ScalarTree, false> tree(grid->constTree());  // no thread sees another's
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) *values++ = tree.getValue(coord(first + Vec3i(i, j, k)));
    }
  }
}

std::optional<float> VdbGrid::constantOf(const Vec3i& brick) const {
  const ScalarTree& tree = grid->constTree();
  if (tree.probeConstLeaf(cornerOf(brick)) != nullptr) return std::nullopt;
  return tree.getValue(cornerOf(brick));
}

bool VdbGrid::readBrick(const Vec3i& brick, float* values) const {
  const ScalarTree& tree = grid->constTree();
  const auto* leaf = tree.probeConstLeaf(cornerOf(brick));
  if (leaf == nullptr) {
    values[0] = tree.getValue(cornerOf(brick));
    return true;
  }
  turnBrick(leaf->buffer().data(), values);
  return false;
}

void VdbGrid::setBrick(const Vec3i& size, const Vec3i& brick, const float* values) {
  grid->tree().addLeaf(makeLeaf(size, brick, values).release());  // in place of what was there
}

void VdbGrid::setConstantBrick(const Vec3i& brick, float value) {
  grid->tree().addTile(1, cornerOf(brick), value, true);
}

std::size_t VdbGrid::storedBytes() const {
  return grid->constTree().memUsage();
}

std::size_t VdbGrid::storedBricks() const {
  return grid->constTree().leafCount();
}

std::unique_ptr<Volume::Grid> buildGrid(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                        const BrickSource& source) {
  GridMaker maker(size, lattice, facts.source);
  for (int bk = 0; bk < maker.layers(); ++bk) maker.add(buildLayer(size, bk, source, nullptr));
  return maker.finish(lattice, std::move(facts));
}

std::unique_ptr<Volume::Grid> buildGridByLayers(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                                const LayerSource& layers, const LeafSource& leaf_of) {
  GridMaker maker(size, lattice, facts.source);
  const auto build = [&](const LayerSource& from) {
    tbb::parallel_for(0, maker.layers(), [&](int bk) { maker.add(buildLayer(size, bk, from(bk), leaf_of)); });
  };
  if (facts.instead_of_nan) {
    FiniteValues finite(size, *facts.instead_of_nan);
    build(finite.of(layers));
    finite.check(facts.source);
    if (const std::string remark = finite.remark(); !remark.empty()) {
      facts.remark += (facts.remark.empty() ? "" : "; ") + remark;
    }
    facts.replaced += static_cast<std::uint64_t>(finite.replaced().count());
  } else {
    build(layers);
  }
  return maker.finish(lattice, std::move(facts));
}

}  // namespace palpate
