// SPDX-License-Identifier: Apache-2.0
// `palpate gradient`: its file, read back with OpenVDB, against the twin.
#include "apps/gradient/gradient_job.hpp"

#include <csignal>
#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/GridOperators.h>

#include "apps/console/interrupt.hpp"
#include "base/error.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/reference/brick_bounds.hpp"
#include "engine/reference/gradient.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace gradient_job_test {

using openvdb::Coord;
using ::testing::HasSubstr;
constexpr const char* kBall = "phantom:sphere?size=41x33x37&spacing=0.5x0.5x0.8mm";

openvdb::Vec3SGrid::Ptr readVectors(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  auto grid = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("gradient"));
  file.close();
  return grid;
}

class GradientFile : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  void expectRefused(const GradientRequest& request, Error::Code code, const std::string& words) {
    Progress progress;
    try {
      (void)gradientFile(request, progress);
      ADD_FAILURE() << "no error, wanted: " << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }
  // An oblique volume of random densities, written where loadVolume finds it.
  std::string obliqueVolume() {
    Lattice lattice;
    lattice.origin_W = {0.01, -0.02, 0.03};
    lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
    lattice.R_WL = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
    openvdb::initialize();
    auto grid = openvdb::FloatGrid::create(0);
    openvdb::Mat4R matrix = openvdb::Mat4R::identity();
    for (int axis = 0; axis < 3; ++axis) {
      for (int n = 0; n < 3; ++n) matrix(axis, n) = lattice.R_WL(n, axis) * lattice.spacing_m[axis] * 1000;
      matrix(3, axis) = lattice.origin_W[axis] * 1000;
    }
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    grid->insertMeta("unit", openvdb::StringMetadata("mm"));
    auto values = grid->getAccessor();
    for (int n = 0; n < 19 * 17 * 13; ++n)
      values.setValue(Coord(n % 19, n / 19 % 17, n / 19 / 17), static_cast<float>((n * 7919) % 1000) - 400);
    openvdb::io::File out(file("in.vdb"));
    out.write({grid});
    out.close();
    return file("in.vdb");
  }

  TemporaryFolder folder_;
};

// Every voxel of every brick: the twin's gradient, turned into the world and per millimetre.
TEST_F(GradientFile, OfAllBricksHoldsTheTwinsGradientsInTheWorld) {
  const std::string in = obliqueVolume();
  const Volume volume = loadVolume(in);
  const reference::DenseField field = reference::denseField(volume);
  for (const char* name : {"central", "sobel", "central4", "gaussian:1mm"}) {
    Progress progress;
    const GradientRequest request{.in = in, .out = file("out.vdb"), .gradient = name, .all = true};
    const GradientResult result = gradientFile(request, progress);
    EXPECT_EQ(result.written, result.bricks);
    EXPECT_EQ(result.bytes, std::filesystem::file_size(file("out.vdb")));
    EXPECT_THAT(gradientWords(request, result), HasSubstr(name));
    const auto grid = readVectors(file("out.vdb"));
    EXPECT_EQ(grid->getVectorType(), openvdb::VEC_COVARIANT);
    EXPECT_TRUE(grid->isInWorldSpace());
    EXPECT_EQ(grid->metaValue<std::string>("unit"), "mm");
    EXPECT_EQ(grid->activeVoxelCount(), field.values.size());
    const openvdb::Vec3d at = grid->transform().indexToWorld(Coord(3, 2, 1));
    EXPECT_LE((Vec3(at.x(), at.y(), at.z()) - 1000 * volume.lattice().toWorld({3, 2, 1})).norm(), 1e-9);
    const GradientOperator way = gradientOperator(name);
    const reference::DenseField smoothed = reference::smoothedFor(way, field);
    auto vectors = grid->getConstAccessor();
    for (int k = 0; k < field.size.z(); ++k) {
      for (int j = 0; j < field.size.y(); ++j) {
        for (int i = 0; i < field.size.x(); ++i) {
          const auto g = reference::gradientAt(smoothed, way, i, j, k);
          const Vec3 want = volume.lattice().R_WL * Vec3(g[0], g[1], g[2]) * 1e-3;
          const openvdb::Vec3f got = vectors.getValue(Coord(i, j, k));
          // Turned in double, then rounded to float once.
          ASSERT_LE((Vec3(got.x(), got.y(), got.z()) - want).norm(), want.norm() * 1.2e-7) << name << i << j << k;
        }
      }
    }
  }
}

// Away from the border OpenVDB's own gradient is the central difference in the world, in its transform's units; it
// rounds in float, the densities are below 1000 and the voxels 0.7 mm: 1e-6 x 1000 / 0.7 is more than its three
// products and sums can be off.
TEST_F(GradientFile, IsWhatOpenVdbComputes) {
  const std::string in = obliqueVolume();
  Progress progress;
  (void)gradientFile({.in = in, .out = file("out.vdb"), .all = true}, progress);
  openvdb::io::File source(in);
  source.open();
  const auto density = openvdb::gridPtrCast<openvdb::FloatGrid>(source.readGrid(source.beginName().gridName()));
  const auto theirs = openvdb::tools::gradient(*density);
  const auto ours = readVectors(file("out.vdb"));
  EXPECT_EQ(theirs->getVectorType(), ours->getVectorType());
  const Vec3i offset = Vec3i::Constant(2);  // of the domain around the active voxels
  for (const Vec3i& p : {Vec3i(4, 5, 6), Vec3i(9, 8, 7), Vec3i(15, 12, 10)}) {
    const openvdb::Vec3f a = theirs->tree().getValue(Coord(p.x(), p.y(), p.z()));
    const Vec3i q = p + offset;
    const openvdb::Vec3f b = ours->tree().getValue(Coord(q.x(), q.y(), q.z()));
    EXPECT_LE((a - b).length(), 1.5e-3F) << p.transpose();
    EXPECT_GT(b.length(), 1.0F);
  }
}

TEST_F(GradientFile, OfTheActiveBricksHoldsThoseThatTheIsosurfaceNeeds) {
  Progress progress;
  const GradientResult result = gradientFile({.in = kBall, .out = file("out.vdb")}, progress);
  EXPECT_LT(result.written, result.bricks);
  EXPECT_GT(result.written, 8U);
  const Volume volume = loadVolume(kBall);
  const reference::DenseField field = reference::denseField(volume);
  const auto grid = readVectors(file("out.vdb"));
  EXPECT_EQ(grid->tree().leafCount(), result.written);
  auto vectors = grid->getConstAccessor();
  std::size_t crossed = 0;
  for (int k = 0; k + 1 < field.size.z(); ++k) {
    for (int j = 0; j + 1 < field.size.y(); ++j) {
      for (int i = 0; i + 1 < field.size.x(); ++i) {
        const float here = field.at(i, j, k);
        const auto iso = static_cast<float>(result.isovalue);
        if ((here > iso) == (field.at(i + 1, j, k) > iso)) continue;
        ++crossed;
        const auto g = reference::gradientAt(field, {}, i, j, k);
        ASSERT_TRUE(vectors.isValueOn(Coord(i, j, k)));
        ASSERT_TRUE(vectors.isValueOn(Coord(i + 1, j + 1, k + 1)));
        ASSERT_NEAR(vectors.getValue(Coord(i, j, k)).length() * 1000, Vec3(g[0], g[1], g[2]).norm(),
                    Vec3(g[0], g[1], g[2]).norm() * 4e-7);
      }
    }
  }
  EXPECT_GT(crossed, 100U);
  // Another isovalue needs other bricks.
  const double further_in = 0.5 * (result.isovalue + static_cast<double>(volume.maximum()));
  const GradientResult inner = gradientFile({.in = kBall, .out = file("b.vdb"), .isovalue = further_in}, progress);
  EXPECT_EQ(inner.isovalue, further_in);
  EXPECT_NE(inner.written, result.written);
}

// Every figure another, so that none stands for another.
TEST(GradientWordsOfAJob, TellEveryFigure) {
  GradientResult result{.device = "a device", .bricks = 9, .written = 5, .isovalue = -1.5, .gradient_s = 0.125};
  result.seconds = 0.25;
  result.bytes = 1536;
  EXPECT_EQ(gradientWords({.in = "in", .out = "g.vdb", .gradient = "sobel"}, result),
            "g.vdb: sobel gradient of 5 of 9 bricks, isovalue -1.5, 1.5 KiB; 0.125 s on a device, 0.25 s in all");
  EXPECT_EQ(gradientWords({.in = "in", .out = "g.vdb", .gradient = "sobel", .all = true}, result),
            "g.vdb: sobel gradient of 5 of 9 bricks, 1.5 KiB; 0.125 s on a device, 0.25 s in all");
}

// A stream that is no terminal: each stage has its line, and how far it is. 343 bricks: after 256 it is told again.
TEST_F(GradientFile, TellsItsStages) {
  const auto told = [&](const GradientRequest& request) {
    std::FILE* stream = std::tmpfile();
    {
      Progress progress(stream, 0);
      const GradientResult result = gradientFile(request, progress);
      EXPECT_EQ(result.bricks, 343U);
      EXPECT_NE(result.device, "");
      EXPECT_GT(result.gradient_s, 0);
      EXPECT_GE(result.seconds, result.gradient_s);
    }
    std::rewind(stream);
    std::string text(65536, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), stream));
    std::fclose(stream);
    return text;
  };
  const GradientRequest request{.in = "phantom:sphere?size=56", .out = file("g.vdb"), .all = true};
  const std::string text = told(request);
  EXPECT_THAT(text, testing::StartsWith("loading phantom:sphere?size=56 ...\n"));
  EXPECT_THAT(text, HasSubstr("\ngradients ...\n"));
  EXPECT_THAT(text, HasSubstr("\ngradients: 100 % ...\n"));
  EXPECT_THAT(text, testing::EndsWith("\ncopying ...\ncopying: 75 % ...\nwriting " + request.out + " ...\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("smoothing")));
  GradientRequest smooth = request;
  smooth.gradient = "gaussian:1";
  EXPECT_THAT(told(smooth), HasSubstr("\nsmoothing ...\nsmoothing: "));
}

TEST_F(GradientFile, RefusesWhatItCannotDo) {
  const auto bad = Error::Code::kBadInput;
  expectRefused({.in = kBall, .out = file("a.nrrd")}, bad, "OpenVDB only");
  expectRefused({.in = kBall, .out = file("a.vdb"), .gradient = "prewitt"}, bad, "prewitt");
  expectRefused({.in = kBall, .out = file("a.vdb"), .all = true, .isovalue = 1}, bad, "--iso");
  expectRefused({.in = kBall, .out = file("a.vdb"), .isovalue = 1e9}, bad, "isovalue");
  expectRefused({.in = kBall, .out = file("none/a.vdb")}, Error::Code::kIo, "none");
  expectRefused({.in = file("none.nrrd"), .out = file("a.vdb")}, Error::Code::kNotFound, "no such file");
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(GradientFile, NeverReplacesItsInput) {
  const std::string in = obliqueVolume();
  const std::string before = contentsOf(in);
  std::filesystem::create_hard_link(in, file("b.vdb"));
  expectRefused({.in = in, .out = in}, Error::Code::kBadInput, "it is the input");
  expectRefused({.in = in, .out = file("b.vdb")}, Error::Code::kBadInput, "it is the input");
  EXPECT_EQ(contentsOf(in), before);
}

// Ctrl-C leaves the older file and nothing beside it. Last: the request to stop stays.
TEST_F(GradientFile, ZStoppedLeavesTheOlderFile) {
  std::ofstream(file("out.vdb")) << "old";
  catchInterrupts();
  // A test program that ends slowly is not to be ended by the thread that watches for such ones; so this stays.
  [[maybe_unused]] static const KeptWork& kept = *new KeptWork;
  std::raise(SIGINT);
  expectRefused({.in = kBall, .out = file("out.vdb")}, Error::Code::kCancelled, "palpate gradient");
  EXPECT_EQ(contentsOf(file("out.vdb")), "old");
  EXPECT_EQ(folder_.files(), 1);
}

}  // namespace gradient_job_test
}  // namespace palpate
