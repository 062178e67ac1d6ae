// SPDX-License-Identifier: Apache-2.0
// Stamps of tetrahedra, whose corners are known.
#include "apps/edit/stamp_files.hpp"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace stamp_files_test {

class Stamps : public testing::Test {
 protected:
  Stamps() {
    lattice_.spacing_m = Vec3(1e-3, 2e-3, 3e-3);
    profile_ = {.isovalue = 0, .background = -1, .object = 1, .slope_per_m = 500, .band_m = 2e-3};
  }
  // Corners at the origin and on the axes.
  [[nodiscard]] std::string tetrahedron(const char* name, const Vec3& ends, bool closed = true) const {
    const std::string file = (folder_.path() / name).string();
    std::ofstream(file) << fmt::format("v 0 0 0\nv {} 0 0\nv 0 {} 0\nv 0 0 {}\nf 1 3 2\nf 1 2 4\nf 1 4 3\n", ends.x(),
                                       ends.y(), ends.z())
                        << (closed ? "f 2 3 4\n" : "");
    return file;
  }
  TemporaryFolder folder_;
  Lattice lattice_;
  BrushProfile profile_;
};

// In voxels of the smallest spacing. Inside, the distance is that to the nearest of the four planes; what is made of a
// mesh of flat faces is exact to a hundredth of a voxel.
TEST_F(Stamps, HoldTheDistanceFromTheMesh) {
  const std::string file = tetrahedron("tet.obj", Vec3(6, 6, 6));
  for (const double unit_m : {1e-3, 2e-3}) {
    const auto stamp = StampFiles(lattice_, profile_).stampOf(file, unit_m, 1);
    EXPECT_LT((stamp->lattice.spacing_m - Vec3::Constant(1e-3)).norm(), 1e-12);
    const Vec3i at = stamp->lattice.toIndex(Vec3::Constant(1e-3)).array().round().cast<int>();
    const auto place = static_cast<std::size_t>(at.x() + stamp->size.x() * (at.y() + stamp->size.y() * at.z()));
    const Vec3 p = stamp->lattice.toWorld(at.cast<double>());
    const double deep_m = std::min(p.minCoeff(), (6 * unit_m - p.sum()) / std::sqrt(3.0));
    EXPECT_NEAR(stamp->distance_m.at(place), -deep_m, 1e-5) << unit_m;
  }
}

TEST_F(Stamps, AreCoarserWhereTheMeshIsLong) {
  const std::string file = tetrahedron("long.obj", Vec3(2, 600, 2));
  const auto stamp = StampFiles(lattice_, profile_).stampOf(file, 1e-3, 1);
  EXPECT_NEAR(stamp->lattice.spacing_m.x(), (0.6 + 2 * 2e-3) / (512 - 8), 1e-9);
  EXPECT_LE(stamp->size.maxCoeff(), 512);
  EXPECT_GE(stamp->size.maxCoeff(), 500);
}

// Read again only in another unit or where they must be deeper: an object of 3 needs a ramp three times as deep.
TEST_F(Stamps, AreKept) {
  const std::string file = tetrahedron("tet.obj", Vec3(6, 6, 6)), other = tetrahedron("other.obj", Vec3(6, 6, 6));
  StampFiles stamps(lattice_, profile_);
  const auto first = stamps.stampOf(file, 1e-3, 1);
  EXPECT_EQ(stamps.stampOf(file, 1e-3, 1), first);
  const auto large = stamps.stampOf(file, 2e-3, 1), another = stamps.stampOf(other, 1e-3, 1);
  EXPECT_NE(large, first);
  EXPECT_NE(another, first);
  EXPECT_EQ(stamps.stampOf(file, 1e-3, 1), first);
  EXPECT_EQ(stamps.stampOf(file, 2e-3, 1), large);
  EXPECT_EQ(stamps.stampOf(other, 1e-3, 1), another);
  const auto deep = stamps.stampOf(file, 1e-3, 3);
  EXPECT_NE(deep, first);
  EXPECT_EQ(stamps.stampOf(file, 1e-3, 1), deep);  // it holds all that the other does
}

TEST_F(Stamps, OfAMeshThatIsNotClosedAreRefused) {
  const std::string file = tetrahedron("open.obj", Vec3(6, 6, 6), false);
  EXPECT_EQ(
      refusalOf([&] { static_cast<void>(StampFiles(lattice_, profile_).stampOf(file, 1e-3, 1)); }),
      file + ": the mesh is not closed, so it has no inside; close its holes, and give neighbours the same corners");
}

}  // namespace stamp_files_test
}  // namespace palpate
