// SPDX-License-Identifier: Apache-2.0
#include "apps/convert/convert_job.hpp"

#include <csignal>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include "apps/load/load_and_tell.hpp"
#include "apps/mesh/mesh_file.hpp"
#include "base/error.hpp"
#include "engine/field/statistics.hpp"
#include "engine/field/volume.hpp"
#include "engine/files/volume_file.hpp"
#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace convert_job_test {

using ::testing::HasSubstr;
constexpr const char* kBall = "phantom:sphere?size=24&spacing=0.5mm";

ConvertResult run(const ConvertRequest& request) {
  Progress progress;
  return convert(request, progress);
}

void expectRefused(const ConvertRequest& request, Error::Code code, const std::string& words) {
  try {
    static_cast<void>(run(request));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

class Convert : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

TEST_F(Convert, AVolumeGoesThroughEveryFormatUnchanged) {
  const std::vector<float> values = loadVolume(kBall).toDense();
  std::string from = kBall;
  for (const char* name : {"a.vdb", "b.nrrd", "c.nii.gz", "d.mha", "e.nii", "f.vdb"}) {
    const ConvertResult result = run({.in = from, .out = file(name)});
    EXPECT_FALSE(result.is_mesh);
    EXPECT_EQ(result.bytes, std::filesystem::file_size(file(name)));
    from = file(name);
    const Volume volume = loadVolume(from);
    EXPECT_EQ(volume.toDense(), values) << name;
    // Two of the files hold 32-bit floats: 2^-24 of 0.5 mm each.
    EXPECT_LE((volume.lattice().spacing_m - Vec3::Constant(0.5e-3)).cwiseAbs().maxCoeff(), 1e-10) << name;
  }
  EXPECT_EQ(folder_.files(), 6);
}

TEST_F(Convert, WhatIsOddAboutTheVolumeIsTold) {
  for (const std::string spacings : {"", "spacings: 2 2 2\n"}) {
    std::ofstream(file("a.nrrd"), std::ios::binary)
        << "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\n" + spacings + "encoding: raw\n\n01234567";
    testing::internal::CaptureStderr();
    static_cast<void>(run({.in = file("a.nrrd"), .out = file("b.vdb")}));
    const std::string told = testing::internal::GetCapturedStderr();
    const std::string words = "palpate: " + file("a.nrrd") + ": the file gives no voxel size; 1 mm is assumed";
    EXPECT_EQ(told.find(words) != std::string::npos, spacings.empty()) << told;
    EXPECT_EQ(told.find("palpate: ") != std::string::npos, spacings.empty()) << told;
  }
}

// A file of 64 voxels.
std::string nrrdOf(const std::string& type, const std::string& bytes) {
  return "NRRD0004\ntype: " + type +
         "\ndimension: 3\nsizes: 4 4 4\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n" + bytes;
}
template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// 2^24 + n for n from 0 to 63: every second one is no float, and lies 1 from the next. What was at the output stays.
TEST_F(Convert, ExactRefusesNumbersThatAreRounded) {
  std::vector<std::int32_t> values(64);
  std::iota(values.begin(), values.end(), 1 << 24);
  std::ofstream(file("a.nrrd"), std::ios::binary) << nrrdOf("int", bytesOf(values));
  std::ofstream(file("b.nrrd")) << "older";
  expectRefused({.in = file("a.nrrd"), .out = file("b.nrrd"), .exact = true}, Error::Code::kBadInput,
                file("a.nrrd") +
                    ": 32 of its int32 values are no 32-bit floats and were rounded, by 1 at most; leave --exact out");
  std::ostringstream kept;
  kept << std::ifstream(file("b.nrrd")).rdbuf();
  EXPECT_EQ(kept.str(), "older");
  EXPECT_EQ(folder_.files(), 2);
  testing::internal::CaptureStderr();
  static_cast<void>(run({.in = file("a.nrrd"), .out = file("b.nrrd")}));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("32 of its int32 values are no 32-bit floats"));
  values[0] = 2'000'000'000;  // beside which the rest is small: a mesh, which has no densities, does not show it
  std::ofstream(file("a.nrrd"), std::ios::binary) << nrrdOf("int", bytesOf(values));
  for (const char* out : {"b.nrrd", "b.stl"}) {
    testing::internal::CaptureStderr();
    static_cast<void>(run({.in = file("a.nrrd"), .out = file(out)}));
    const bool is_told = testing::internal::GetCapturedStderr().find("no 32-bit floats") != std::string::npos;
    EXPECT_EQ(is_told, std::string(out) == "b.nrrd");
  }
}

TEST_F(Convert, ExactRefusesWhatIsReplaced) {
  std::vector<float> values(64, 0.5F);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  std::ofstream(file("a.nrrd"), std::ios::binary) << nrrdOf("float", bytesOf(values));
  expectRefused({.in = file("a.nrrd") + "?nan=3", .out = file("b.mha"), .exact = true}, Error::Code::kBadInput,
                "1 of its voxels have no density in the file, and were given one; leave --exact out");
  expectRefused({.in = kBall, .out = file("a.stl"), .exact = true}, Error::Code::kBadInput,
                "--exact: a mesh keeps no densities");
}

TEST_F(Convert, ExactRefusesWhatIsClamped) {
  VolumeFacts facts;
  facts.clamped = 3;
  const Volume volume = Volume::fromDense({2, 2, 2}, {}, std::vector<float>(8), facts);
  EXPECT_THAT(refusalOf([&] { checkExact(volume, {.in = "a", .out = "b.mha"}); }),
              HasSubstr("a: 3 of its pixels, packed with losses, lay beyond BitsStored"));
}

// 1e9 + n: floats are 64 apart there, so that little is left of the differences. Whoever feels them is told.
TEST_F(Convert, WhatRoundingTakesFromTheRangeIsToldWithEveryVolume) {
  const auto told = [&](std::int32_t low, std::int32_t high) {
    std::vector<std::int32_t> values(64);
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = n == 0 ? high : low + static_cast<std::int32_t>(n);
    std::ofstream(file("a.nrrd"), std::ios::binary) << nrrdOf("int", bytesOf(values));
    Progress progress;
    testing::internal::CaptureStderr();
    static_cast<void>(loadAndTell(file("a.nrrd"), progress));
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(told(1'000'000'000, 1'000'000'064), HasSubstr("values are no 32-bit floats and were rounded, by 32 at"));
  EXPECT_EQ(told(1'000'000'000, 2'000'000'000), "");
  EXPECT_EQ(told(0, 100), "");
}

// Distances of a sphere in metres: thousandths of a level set's are no floats as a rule.
TEST_F(Convert, ExactRefusesALevelSetInMillimetres) {
  const Volume ball = loadVolume(kBall);
  VolumeFacts facts;
  facts.is_level_set = true;
  static_cast<void>(saveVolume(Volume::fromDense(ball.size(), ball.lattice(), ball.toDense(), facts), file("a.vdb")));
  expectRefused({.in = file("a.vdb"), .out = file("b.vdb"), .unit = LengthUnit::kMillimetre, .exact = true},
                Error::Code::kBadInput, "b.vdb: ");
  expectRefused({.in = file("a.vdb"), .out = file("b.vdb"), .unit = LengthUnit::kMillimetre, .exact = true},
                Error::Code::kBadInput, " of its millimetre values are no 32-bit floats and were rounded, by ");
  testing::internal::CaptureStderr();
  static_cast<void>(run({.in = file("a.vdb"), .out = file("b.vdb"), .unit = LengthUnit::kMillimetre}));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("b.vdb: "));
  for (const char* name : {"b.vdb", "b.nrrd"}) {
    static_cast<void>(run({.in = file("a.vdb"), .out = file(name), .exact = true}));
    EXPECT_EQ(loadVolume(file(name)).toDense(), ball.toDense());
  }
}

// One that is not kept is one too many: 1000 / 1024 mm is a float, a thousand times a tenth is none.
TEST_F(Convert, ExactRefusesASingleMillimetreThatIsRounded) {
  std::vector<float> values(512);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(static_cast<int>(n) - 256) / 1024;
  VolumeFacts facts;
  facts.is_level_set = true;
  const auto save = [&](const char* name) {
    static_cast<void>(
        saveVolume(Volume::fromDense(Vec3i::Constant(8), Lattice{Vec3::Zero(), Mat3::Identity(), Vec3::Constant(1e-3)},
                                     values, facts),
                   file(name)));
  };
  save("all.vdb");
  static_cast<void>(run({.in = file("all.vdb"), .out = file("b.vdb"), .unit = LengthUnit::kMillimetre, .exact = true}));
  values[300] = 0.1F;
  save("one.vdb");
  expectRefused({.in = file("one.vdb"), .out = file("b.vdb"), .unit = LengthUnit::kMillimetre, .exact = true},
                Error::Code::kBadInput, "1 of its millimetre values");
}

// Numbers that floats hold go through every format, whatever their type and scale.
TEST_F(Convert, ExactIsNoObstacleWhereAllIsKept) {
  std::vector<double> values(64);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = 0.25 * static_cast<double>(n) - 3;
  std::ofstream(file("a.nrrd"), std::ios::binary) << nrrdOf("double", bytesOf(values));
  for (const char* name : {"b.vdb", "b.nrrd", "b.nii", "b.nii.gz", "b.mha"}) {
    static_cast<void>(run({.in = file("a.nrrd"), .out = file(name), .exact = true}));
    EXPECT_EQ(loadVolume(file(name)).toDense(), std::vector<float>(values.begin(), values.end())) << name;
  }
}

// Its extent tells the unit. Equal places are one vertex in an STL, so the mesh is closed by places.
TEST_F(Convert, AMeshIsClosedAndInItsUnit) {
  for (const char* name : {"a.stl", "a.ply", "a.obj"}) {
    double extent[2] = {};
    for (const LengthUnit unit : {LengthUnit::kMillimetre, LengthUnit::kMetre}) {
      const ConvertResult result = run({.in = kBall, .out = file(name), .adaptivity = 0.02, .unit = unit});
      const TriangleMesh mesh = readMeshFile(file(name));
      EXPECT_EQ(result.triangles, mesh.triangles.size());
      EXPECT_EQ(result.bytes, std::filesystem::file_size(file(name)));
      std::map<std::array<double, 3>, std::uint32_t> places;
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
      const auto place = [&](std::uint32_t vertex) {
        const Vec3& v = mesh.vertices_W[vertex];
        return places.emplace(std::array{v.x(), v.y(), v.z()}, places.size()).first->second;
      };
      for (const auto& t : mesh.triangles) {
        for (std::size_t n = 0; n < 3; ++n) ++edges[std::minmax({place(t[n]), place(t[(n + 1) % 3])})];
      }
      for (const auto& [edge, count] : edges) ASSERT_EQ(count, 2) << name;
      Vec3 low = mesh.vertices_W[0], high = low;
      for (const Vec3& v : mesh.vertices_W) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
      }
      extent[unit == LengthUnit::kMetre ? 1 : 0] = (high - low).norm();
    }
    EXPECT_NEAR(extent[0] / extent[1], 1000, 0.01) << name;
    EXPECT_GT(extent[0], 1);
  }
}

TEST_F(Convert, SaysWhatItDid) {
  const ConvertRequest request{.in = kBall, .out = file("a.stl")};
  ConvertResult result = run(request);
  EXPECT_THAT(convertWords(request, result), HasSubstr("24 x 24 x 24 voxels"));
  EXPECT_THAT(convertWords(request, result), HasSubstr(std::to_string(result.triangles) + " triangles"));
}

// Every figure another, so that none stands for another.
TEST(ConvertWords, TellEveryFigure) {
  ConvertResult result{.size = {24, 25, 26}, .triangles = 300, .vertices = 152, .isovalue = -1.5, .bytes = 1536};
  result.seconds = 0.256;
  EXPECT_EQ(convertWords({.in = "a", .out = "b.vdb"}, result), "b.vdb: 24 x 25 x 26 voxels, 1.5 KiB, 0.26 s");
  result.is_mesh = true;
  const std::string words =
      "b.stl: 300 triangles, 152 vertices, isosurface -1.5 of 24 x 25 x 26 voxels, 1.5 KiB, 0.26 s";
  EXPECT_EQ(convertWords({.in = "a", .out = "b.stl"}, result), words);
  result.collapsed = 1;
  EXPECT_THAT(convertWords({.in = "a", .out = "b.stl"}, result),
              testing::StartsWith(words + "\n1 of the triangles without area: "));
}

TEST(ConvertWords, SayWhichFormatKeepsASurface) {
  EXPECT_EQ(surfaceWords("a.stl", 2), "");
  EXPECT_EQ(surfaceWords("a.vdb", 2), "its surface is at 2, which the file keeps\n");
  EXPECT_EQ(surfaceWords("a.nii.gz", 2),
            "its surface is at 2, which this format cannot keep: give --iso 2 where it is used\n");
}

// A ball of densities about 5000, so that neither the isovalue that is given nor the chosen one is 0.
TEST_F(Convert, TheIsovalueIsTheGivenOneOrTheVolumes) {
  const Volume ball = loadVolume(kBall);
  std::vector<float> values = ball.toDense();
  for (float& value : values) value += 5000;
  saveVolume(Volume::fromDense(ball.size(), ball.lattice(), values, {}), file("ball.nrrd"));
  const double own = defaultIsovalue(loadVolume(file("ball.nrrd")));
  EXPECT_GT(own, 3000);
  EXPECT_EQ(run({.in = file("ball.nrrd"), .out = file("a.stl")}).isovalue, own);
  // Half a voxel further in: the isosurface of a distance is a ball again, and smaller.
  const auto radius_m = [&](double isovalue) {
    EXPECT_EQ(
        run({.in = file("ball.nrrd"), .out = file("a.ply"), .isovalue = isovalue, .unit = LengthUnit::kMetre}).isovalue,
        isovalue);
    double radius = 0;
    for (const Vec3& v : readMeshFile(file("a.ply")).vertices_W) radius = std::max(radius, v.norm());
    return radius;
  };
  EXPECT_GT(radius_m(5000), radius_m(5300));
}

// Without an adaptivity every cell is kept, as with 0; both ends of its range are taken.
TEST_F(Convert, AdaptivityJoinsTriangles) {
  const std::size_t without = run({.in = kBall, .out = file("a.stl")}).triangles;
  EXPECT_EQ(run({.in = kBall, .out = file("a.stl"), .adaptivity = 0}).triangles, without);
  EXPECT_LT(run({.in = kBall, .out = file("a.stl"), .adaptivity = 1}).triangles, without);
}

// A stream that is no terminal: each stage has its line.
TEST_F(Convert, TellsItsStages) {
  const auto told = [&](const std::string& out) {
    std::FILE* stream = std::tmpfile();
    {
      Progress progress(stream, 1000);
      const ConvertResult result = convert({.in = kBall, .out = out}, progress);
      EXPECT_EQ(result.size, Vec3i::Constant(24));
      EXPECT_GT(result.seconds, 0);
    }
    std::rewind(stream);
    std::string text(4096, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), stream));
    std::fclose(stream);
    return text;
  };
  const std::string loading = std::string("loading ") + kBall + " ...\n";
  EXPECT_EQ(told(file("a.vdb")), loading + "writing " + file("a.vdb") + " ...\n");
  EXPECT_EQ(told(file("a.stl")), loading + "meshing ...\nwriting " + file("a.stl") + " ...\n");
}

// A kilometre from the origin along each axis a 32-bit float of millimetres keeps 0.06: more than the ball's voxels of
// 0.01.
TEST_F(Convert, SaysWhichTrianglesCollapseFarFromTheOrigin) {
  const auto convertedAt = [&](double off_m) {
    const Volume ball = loadVolume("phantom:sphere?size=16&spacing=0.01mm");
    Lattice lattice = ball.lattice();
    lattice.origin_W += Vec3::Constant(off_m);
    saveVolume(Volume::fromDense(ball.size(), lattice, ball.toDense(), {}), file("ball.vdb"));
    const ConvertRequest request{.in = file("ball.vdb"), .out = file("ball.stl"), .isovalue = 0};
    const ConvertResult result = run(request);
    // Of what the file holds.
    std::size_t collapsed = 0;
    const TriangleMesh mesh = readMeshFile(file("ball.stl"));
    for (const auto& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices_W[t[0]], &b = mesh.vertices_W[t[1]], &c = mesh.vertices_W[t[2]];
      // 1e-12 of the edges is far below what a float can tell, and above the rounding of the reader's metres.
      collapsed += (b - a).cross(c - a).norm() <= 1e-12 * (b - a).norm() * (c - a).norm() ? 1 : 0;
    }
    EXPECT_EQ(result.collapsed, collapsed);
    const std::string words = convertWords(request, result);
    EXPECT_EQ(words.find("triangles without area") != std::string::npos, collapsed > 0) << words;
    return result.collapsed;
  };
  EXPECT_EQ(convertedAt(0), 0U);
  EXPECT_GT(convertedAt(1000), 10U);
}

TEST_F(Convert, RefusesWhatItCannotDo) {
  const auto bad = Error::Code::kBadInput;
  expectRefused({.in = kBall, .out = file("a.tiff")}, bad, ".stl, .obj, .ply");
  expectRefused({.in = kBall, .out = file("a.nrrd"), .isovalue = 1}, bad, "--iso");
  expectRefused({.in = kBall, .out = file("a.nrrd"), .adaptivity = 0.1}, bad, "--adaptivity");
  expectRefused({.in = kBall, .out = file("a.nrrd"), .unit = LengthUnit::kMetre}, bad, "--unit");
  for (const double adaptivity : {-0.1, 1.5, std::nan("")}) {
    expectRefused({.in = kBall, .out = file("a.stl"), .adaptivity = adaptivity}, bad, "[0, 1]");
  }
  for (const double isovalue : {1e9, -1e9, std::nan("")}) {
    expectRefused({.in = kBall, .out = file("a.stl"), .isovalue = isovalue}, bad, "isovalue");
  }
  expectRefused({.in = "phantom:random?size=8x8x1", .out = file("a.stl")}, bad,
                "and a surface needs two along every axis");
  expectRefused({.in = file("none.nrrd"), .out = file("a.stl")}, Error::Code::kNotFound, "no such file");
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(Convert, NeverReplacesItsInput) {
  static_cast<void>(run({.in = kBall, .out = file("a.vdb")}));
  const std::string before = contentsOf(file("a.vdb"));
  std::filesystem::create_hard_link(file("a.vdb"), file("b.vdb"));
  expectRefused({.in = file("a.vdb"), .out = file("a.vdb")}, Error::Code::kBadInput, "it is the input");
  expectRefused({.in = file("a.vdb#density"), .out = file("a.vdb")}, Error::Code::kBadInput, "it is the input");
  expectRefused({.in = file("a.vdb"), .out = file("b.vdb")}, Error::Code::kBadInput, "it is the input");
  expectRefused({.in = folder_.path().string(), .out = file("b.vdb")}, Error::Code::kBadInput, "the input's folder");
  EXPECT_EQ(contentsOf(file("a.vdb")), before);
}

// A limit on the size of files stands for the full disk: the older file stays, and nothing beside it.
TEST_F(Convert, AFullDiskLeavesTheOlderFile) {
  for (const char* name : {"a.vdb", "a.nii.gz", "a.nrrd", "a.stl"}) {
    std::ofstream(file(name)) << "old";
    void (*handler)(int) = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit now{2000, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
    expectRefused({.in = "phantom:gyroid?size=64", .out = file(name)}, Error::Code::kIo, "make room");
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(contentsOf(file(name)), "old");
  }
  EXPECT_EQ(folder_.files(), 4);
}

TEST_F(Convert, RefusesFoldersThatMayNotBeWritten) {
  expectRefused({.in = kBall, .out = file("no/a.vdb")}, Error::Code::kIo, "make the folder first");
  expectRefused({.in = kBall, .out = "/proc/a.vdb"}, Error::Code::kIo, "cannot be created");
}

}  // namespace convert_job_test
}  // namespace palpate
