// SPDX-License-Identifier: Apache-2.0
#include "engine/phantoms/phantom.hpp"

#include <algorithm>
#include <random>

#include "engine/field/memory_budget.hpp"

namespace palpate {
namespace {

constexpr int kBlock = 4;  // voxels along the edge of the blocks that are skipped when constant

Lattice centredLattice(const PhantomSpec& spec) {
  const Vec3 half_m = (spec.size - Vec3i::Ones()).cast<double>().cwiseProduct(spec.spacing_m) / 2;
  return {-half_m, Mat3::Identity(), spec.spacing_m};
}

// Irwin-Hall: the sum of twelve 16-bit uniforms, centred and scaled to deviation 1. It uses integers only, so the
// result does not depend on a maths library. Variance of one uniform: (65536^2 - 1) / 12.
class Gauss {
 public:
  explicit Gauss(std::uint64_t seed) : bits_(seed) {}

  double operator()() {
    std::int64_t sum = 0;
    for (int word = 0; word < 3; ++word) {
      const std::uint64_t bits = bits_();
      for (unsigned shift = 0; shift < 64; shift += 16) sum += static_cast<std::int64_t>(bits >> shift & 0xffffU);
    }
    return static_cast<double>(sum - std::int64_t{6} * 65535) * 0x1p-16;  // 1 / sqrt(65536^2 - 1) is 2^-16 within 2e-10
  }

 private:
  std::mt19937_64 bits_;
};

void addNoise(std::vector<float>& values, double deviation, std::uint64_t seed) {
  Gauss gauss(seed);
  for (float& value : values) value = static_cast<float>(static_cast<double>(value) + deviation * gauss());
}

bool isByBricks(const Phantom& phantom) {
  return phantom.isByPlace() && phantom.spec().noise == 0;
}

// Counts the bricks that will be stored, but only if not all bricks together would fit.
void checkSparseMemory(const Phantom& phantom, const std::string& name, std::size_t memory_budget_bytes) {
  constexpr double kBrickBytes = kBrickVoxels * (kGridBytesPerVoxel + kGpuBytesPerVoxel);
  constexpr double kTileBytes = 8;
  checkBricks(name, phantom.size().x(), phantom.size().y(), phantom.size().z());
  const Vec3i bricks = (phantom.size() + Vec3i::Constant(kBrickSize - 1)) / kBrickSize;
  const double all = bricks.cast<double>().prod();
  const std::size_t budget = memory_budget_bytes != 0 ? memory_budget_bytes : availableMemoryBytes();
  if (all * kBrickBytes <= static_cast<double>(budget)) return;
  double stored = 0;
  Vec3i brick;
  for (brick.z() = 0; brick.z() < bricks.z(); ++brick.z()) {
    for (brick.y() = 0; brick.y() < bricks.y(); ++brick.y()) {
      for (brick.x() = 0; brick.x() < bricks.x(); ++brick.x()) stored += phantom.isConstantBrick(brick) ? 0 : 1;
    }
  }
  checkMemory(name, stored * kBrickBytes + all * kTileBytes, budget);
}

}  // namespace

Phantom::Phantom(const PhantomSpec& spec, const Profile& profile)
    : spec_(spec), profile_(profile), lattice_(centredLattice(spec)) {}

double Phantom::density(const Vec3& p_W) const {
  return std::clamp(profile_.isovalue - profile_.slope_per_m * signedDistance_m(p_W), profile_.low, profile_.high);
}

double Phantom::constantRadius_m(const Vec3& p_W) const {
  return beyondRamp_m(signedDistance_m(p_W), (profile_.high - profile_.isovalue) / profile_.slope_per_m,
                      (profile_.isovalue - profile_.low) / profile_.slope_per_m);
}

double Phantom::beyondRamp_m(double distance_m, double below_m, double above_m) {
  return std::max({0.0, distance_m - above_m, -below_m - distance_m});
}

std::vector<float> Phantom::densities() const {
  const Vec3i& n = size();
  std::vector<float> values(static_cast<std::size_t>(n.cast<long long>().prod()));
  const double half_diagonal_m = lattice_.spacing_m.norm() * (kBlock - 1) / 2;
  const auto at = [&](int i, int j, int k) -> float& {
    return values[(static_cast<std::size_t>(k) * n.y() + j) * n.x() + i];
  };
  for (int k0 = 0; k0 < n.z(); k0 += kBlock) {
    for (int j0 = 0; j0 < n.y(); j0 += kBlock) {
      for (int i0 = 0; i0 < n.x(); i0 += kBlock) {
        const Vec3 middle_W = lattice_.toWorld(Vec3(i0, j0, k0) + Vec3::Constant((kBlock - 1) / 2.0));
        const bool constant = constantRadius_m(middle_W) > half_diagonal_m;
        const auto middle = constant ? static_cast<float>(density(middle_W)) : 0.0F;
        for (int k = k0; k < std::min(k0 + kBlock, n.z()); ++k) {
          for (int j = j0; j < std::min(j0 + kBlock, n.y()); ++j) {
            for (int i = i0; i < std::min(i0 + kBlock, n.x()); ++i) {
              at(i, j, k) = constant ? middle : static_cast<float>(density(lattice_.toWorld(Vec3(i, j, k))));
            }
          }
        }
      }
    }
  }
  return values;
}

bool Phantom::isConstantAround(const Vec3& middle_W, int edge_voxels) const {
  return constantRadius_m(middle_W) > lattice_.spacing_m.norm() * (edge_voxels - 1) / 2;
}

Vec3 Phantom::middleOf(const Vec3i& first, int edge_voxels) const {
  return lattice_.toWorld(first.cast<double>() + Vec3::Constant((edge_voxels - 1) / 2.0));
}

bool Phantom::isConstantBrick(const Vec3i& brick) const {
  return isConstantAround(middleOf(brick * kBrickSize, kBrickSize), kBrickSize);
}

bool Phantom::brick(const Vec3i& brick, float* values) const {
  const Vec3i first = brick * kBrickSize;
  if (isConstantBrick(brick)) {
    values[0] = static_cast<float>(density(middleOf(first, kBrickSize)));
    return true;
  }
  for (int block = 0; block < 8; ++block) {
    const Vec3i corner = Vec3i(block & 1, block >> 1 & 1, block >> 2) * kBlock;
    const Vec3 middle_W = middleOf(first + corner, kBlock);
    const bool constant = isConstantAround(middle_W, kBlock);
    const auto middle = constant ? static_cast<float>(density(middle_W)) : 0.0F;
    for (int n = 0; n < kBlock * kBlock * kBlock; ++n) {
      const Vec3i at = corner + Vec3i(n % kBlock, n / kBlock % kBlock, n / (kBlock * kBlock));
      float& value = values[(at.z() * kBrickSize + at.y()) * kBrickSize + at.x()];
      value = constant ? middle : static_cast<float>(density(lattice_.toWorld((first + at).cast<double>())));
    }
  }
  return false;
}

std::unique_ptr<Phantom> makePhantom(const std::string& text) {
  const PhantomSpec spec = parsePhantomSpec(text);
  const auto& kinds = phantomKinds();
  return std::find_if(kinds.begin(), kinds.end(), [&](const PhantomKind& kind) { return kind.name == spec.name; })
      ->make(spec);
}

Volume makeVolume(const Phantom& phantom) {
  const PhantomSpec& spec = phantom.spec();
  VolumeFacts facts;
  facts.source = spec.text;
  facts.format = "phantom";
  facts.value_type = "float32";
  facts.orientation = "LPS axes, centred on the world's origin";
  facts.declared_isovalue = phantom.isovalue();
  if (isByBricks(phantom)) {
    Volume::BrickSource source = [&](const Vec3i& brick, float* values) { return phantom.brick(brick, values); };
    return Volume::fromLayers(spec.size, phantom.lattice(), std::move(facts), [&](int) { return source; });
  }
  std::vector<float> values = phantom.densities();
  if (spec.noise > 0) addNoise(values, spec.noise * (phantom.profile().high - phantom.profile().low), spec.seed);
  return Volume::fromDense(spec.size, phantom.lattice(), values, std::move(facts));
}

Volume phantomVolume(const std::string& name, std::size_t memory_budget_bytes) {
  const std::unique_ptr<Phantom> phantom = makePhantom(name);
  const Vec3i& size = phantom->size();
  if (isByBricks(*phantom)) {
    checkSparseMemory(*phantom, name, memory_budget_bytes);
  } else {
    checkMemory(name, size.x(), size.y(), size.z(), 0, memory_budget_bytes);
  }
  return makeVolume(*phantom);
}

}  // namespace palpate
