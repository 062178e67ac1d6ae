// SPDX-License-Identifier: Apache-2.0
#include "engine/field/few_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/engine/files/files.hpp"

namespace palpate {
namespace few_values_test {

using testing::ElementsAre;
using Density = std::function<double(const Vec3& p)>;  // of a voxel [voxel]

Volume volumeOf(const Vec3i& size, const Density& density) {
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) values.push_back(static_cast<float>(density(Vec3(i, j, k))));
    }
  }
  return Volume::fromDense(size, {}, values, {});
}

Volume changed(const Volume& volume, const std::function<float(float)>& change) {
  std::vector<float> values = volume.toDense();
  std::ranges::transform(values, values.begin(), change);
  return Volume::fromDense(volume.size(), volume.lattice(), values, {});
}

class Numbers {
 public:
  explicit Numbers(unsigned seed) : bits_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution<>(low, high)(bits_); }
  int whole(int low, int high) { return std::uniform_int_distribution<>(low, high)(bits_); }
  Vec3 place(const Vec3i& size) { return {(*this)(0, size.x()), (*this)(0, size.y()), (*this)(0, size.z())}; }

 private:
  std::mt19937 bits_;
};

// Each place has the label of the seed next to it.
Volume labels(Numbers& numbers, const Vec3i& size, int count) {
  std::vector<Vec3> seeds;
  for (int n = 0; n < count; ++n) seeds.push_back(numbers.place(size));
  return volumeOf(size, [&](const Vec3& p) {
    return std::ranges::min_element(seeds, {}, [&](const Vec3& s) { return (s - p).squaredNorm(); }) - seeds.begin();
  });
}

// By the definition, voxel for voxel.
double stepShare(const Volume& volume, float isovalue) {
  double steps[2] = {}, lines[2] = {};
  const Vec3i size = volume.size();
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) {
        const Vec3i at(i, j, k);
        const float middle = volume.value(at);
        const std::size_t side = middle > isovalue ? 1 : 0;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int way : {-1, 1}) {
            const Vec3i across = at + way * Vec3i::Unit(axis), behind = at - way * Vec3i::Unit(axis);
            const bool in_brick = (across / kBrickSize == at / kBrickSize) && (behind / kBrickSize == at / kBrickSize);
            if (!in_brick || across.minCoeff() < 0 || behind.minCoeff() < 0) continue;
            if (((size - across).array() <= 0).any() || ((size - behind).array() <= 0).any()) continue;
            if ((volume.value(across) > isovalue) == (side == 1)) continue;
            if ((volume.value(behind) > isovalue) != (side == 1)) continue;
            lines[side] += 1;
            steps[side] += volume.value(behind) == middle ? 1 : 0;
          }
        }
      }
    }
  }
  const auto share = [&](std::size_t side) { return lines[side] > 0 ? steps[side] / lines[side] : 1.0; };
  return std::min(share(0), share(1));
}

// Balls of any size, anywhere, also across the border, with any two values.
TEST(FewValues, EveryMaskIsRecognised) {
  Numbers numbers(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3i size(numbers.whole(2, 40), numbers.whole(2, 40), numbers.whole(2, 40));
    const double low = std::array{0.0, -1000.0, -0.0, numbers(-5, 5)}[static_cast<std::size_t>(trial % 4)];
    const double high = low + std::array{1.0, 255.0, 1e-3, numbers(0.1, 1e6)}[static_cast<std::size_t>(trial / 4 % 4)];
    const Vec3 middle = numbers.place(size);
    const double radius = numbers(0.5, 15);
    const Volume mask = volumeOf(size, [&](const Vec3& p) { return (p - middle).norm() < radius ? high : low; });
    if (mask.minimum() == mask.maximum()) {
      EXPECT_FALSE(fewValuesOf(mask, low)) << trial;
      continue;
    }
    const auto found = fewValuesOf(mask, 0.5 * (low + high));
    ASSERT_TRUE(found) << trial;
    EXPECT_THAT(found->values, ElementsAre(static_cast<float>(low), static_cast<float>(high))) << trial;
    EXPECT_EQ(found->step_share, 1) << trial;
    for (const double beyond : {static_cast<double>(mask.maximum()), low - 1, std::nan("")})
      EXPECT_FALSE(fewValuesOf(mask, beyond)) << trial;
  }
}

// However its values are stored, and whatever slope and intercept make of them.
TEST(FewValues, AMaskIsRecognisedInEveryTypeAndScale) {
  const Volume mask = volumeOf({20, 21, 22}, [](const Vec3& p) { return (p - Vec3(9, 11, 10)).norm() < 7 ? 1 : 0; });
  for (const auto& [slope, intercept] : {std::pair{1.0F, 0.0F}, {255.0F, 0.0F}, {0.1F, -3.7F}, {-2.0F, 1.0F}}) {
    const Volume scaled = changed(mask, [&](float value) { return slope * value + intercept; });
    const auto found = fewValuesOf(scaled, slope * 0.5F + intercept);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->values.size(), 2U);
  }
  const TempFolder folder;
  for (const char* name : {"mask.nrrd", "mask.nii.gz", "mask.mha", "mask.vdb"}) {
    saveVolume(mask, folder.file(name));
    EXPECT_TRUE(fewValuesOf(loadVolume(folder.file(name)), 0.5)) << name;
  }
}

// Voxels without a value were replaced by a third one.
TEST(FewValues, AMaskWithPlacesThatWereNotScannedIsRecognised) {
  const Volume mask = volumeOf({24, 24, 24}, [](const Vec3& p) {
    return p.x() > 18 ? -1024 : (p - Vec3(10, 11, 12)).norm() < 7 ? 1 : 0;
  });
  const auto found = fewValuesOf(mask, 0.5);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->values, ElementsAre(-1024, 0, 1));
}

TEST(FewValues, OfLinesAcrossTheSurfaceTheShareIsCounted) {
  Numbers numbers(2);
  for (int trial = 0; trial < 40; ++trial) {
    const Vec3i size(numbers.whole(1, 30), numbers.whole(1, 30), numbers.whole(1, 30));
    const Volume volume = labels(numbers, size, numbers.whole(2, 30));
    if (volume.minimum() == volume.maximum()) continue;
    const auto isovalue = static_cast<float>(numbers(volume.minimum(), volume.maximum()));
    const double share = stepShare(volume, isovalue);
    const auto found = fewValuesOf(volume, isovalue);
    EXPECT_EQ(found.has_value(), share >= kStepShare) << trial;
    if (!found) continue;
    EXPECT_DOUBLE_EQ(found->step_share, share) << trial;
  }
}

// Labels of some ten voxels, and as many as a whole body has; at an isovalue between any two.
TEST(FewValues, MapsOfLabelsAreRecognised) {
  Numbers numbers(3);
  for (const int count : {3, 8, 30, 117}) {
    const int edge = static_cast<int>(std::lround(10 * std::cbrt(count))) + 8;
    const Volume map = labels(numbers, Vec3i::Constant(edge), count);
    for (int trial = 0; trial < 5; ++trial) {
      const double isovalue = numbers.whole(0, count - 2) + 0.5;
      EXPECT_TRUE(fewValuesOf(map, isovalue)) << count << " labels at " << isovalue;
    }
  }
}

// With fewer values than 256 the second half would not be recognised, with more the third would be.
TEST(FewValues, AreAsManyAsAByteHolds) {
  for (const int count : {117, 256, 257}) {
    const Volume columns =
        volumeOf({static_cast<int>(4 * count), 4, 4}, [&](const Vec3& p) { return std::floor(p.x() / 4); });
    EXPECT_EQ(fewValuesOf(columns, 60.5).has_value(), count <= 256) << count;
  }
}

// Linear resampling gives a mask many values: its steps are ramps then.
TEST(FewValues, AMaskThatWasResampledLinearlyIsNot) {
  Numbers numbers(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3i size = Vec3i::Constant(32);
    const double radius = numbers(6, 11);
    const Volume mask =
        volumeOf(size, [&](const Vec3& p) { return (p - Vec3::Constant(15.7)).norm() < radius ? 1 : 0; });
    const double step = numbers(0.55, 0.95);
    const Vec3 shift = Vec3(numbers(0, 1), numbers(0, 1), numbers(0, 1));
    const Volume resampled = volumeOf(size, [&](const Vec3& p) {
      const Vec3 at = step * p + shift;
      const Vec3i cell = at.cast<int>();
      double value = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i to(corner & 1, corner >> 1 & 1, corner >> 2);
        const Vec3 weight =
            to.cast<double>() +
            (Vec3::Ones() - 2 * to.cast<double>()).cwiseProduct(Vec3::Ones() - (at - cell.cast<double>()));
        value += weight.prod() * static_cast<double>(mask.value(cell + to));
      }
      return value;
    });
    EXPECT_FALSE(fewValuesOf(resampled, 0.5)) << trial;
  }
}

TEST(FewValues, PhantomsAndConstantVolumesAreNot) {
  for (const char* name :
       {"sphere", "box", "spheres", "knot", "shell", "gyroid", "head", "lung", "sphere?noise=0.05"}) {
    const Volume volume = loadVolume(std::string("phantom:") + name);
    EXPECT_FALSE(fewValuesOf(volume, defaultIsovalue(volume))) << name;
  }
  EXPECT_FALSE(fewValuesOf(volumeOf({9, 9, 9}, [](const Vec3&) { return 3; }), 3));
}

// Scans of eight, six and five bits, with an edge over three voxels and with noise of a grey level and more.
TEST(FewValues, ScansOfFewGreyLevelsAreNot) {
  for (const int levels : {256, 64, 32}) {
    for (const char* noise : {"0", "0.01", "0.05"}) {
      for (const char* name : {"sphere", "knot", "head", "lung"}) {
        const Volume volume = loadVolume(fmt::format("phantom:{}?size=48&noise={}", name, noise));
        const float low = volume.minimum(), step = (volume.maximum() - low) / static_cast<float>(levels - 1);
        const Volume grey = changed(volume, [&](float value) { return std::round((value - low) / step); });
        for (const double share : {0.3, 0.5, 0.7}) {
          const double isovalue = share * levels + 0.25;
          EXPECT_FALSE(fewValuesOf(grey, isovalue)) << name << " " << levels << " levels, noise " << noise << ", "
                                                    << share << ": " << stepShare(grey, static_cast<float>(isovalue));
        }
      }
    }
  }
}

// Scans are none, whatever isovalue parts them; what is left of one by a threshold is a mask.
TEST(FewValues, RealScansAreNotButTheirMasksAre) {
  const char* data = std::getenv("PALPATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PALPATE_DATA names no folder of scans";
  int scans = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data)) {
    const std::string name = entry.path().string();
    if (!name.ends_with(".nrrd") && !name.ends_with(".nii.gz")) continue;
    const Volume scan = loadVolume(name);
    ++scans;
    for (const IsovalueSuggestion& one : statisticsOf(scan).suggestions)
      EXPECT_FALSE(fewValuesOf(scan, one.isovalue)) << name << " at " << one.isovalue;
    const auto isovalue = static_cast<float>(defaultIsovalue(scan));
    const Volume mask = changed(scan, [&](float value) { return value > isovalue ? 1.0F : 0.0F; });
    const auto found = fewValuesOf(mask, 0.5);
    ASSERT_TRUE(found) << name;
    EXPECT_THAT(found->values, ElementsAre(0, 1)) << name;
  }
  EXPECT_GT(scans, 0);
}

}  // namespace few_values_test
}  // namespace palpate
