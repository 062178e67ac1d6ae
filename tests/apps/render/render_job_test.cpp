// SPDX-License-Identifier: Apache-2.0
// `palpate render`: its files against the formula of a sphere, and what it refuses.
#include "apps/render/render_job.hpp"

#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>

#include "apps/console/interrupt.hpp"
#include "apps/render/view_words.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "temporary_folder.hpp"
#include "tests/apps/view/decoded.hpp"

namespace palpate {
namespace render_job_test {

using testing::HasSubstr;

// Centre at the world's origin; the radius is 0.7 of half the extent (engine/phantoms/solids.cpp).
constexpr const char* kSphere = "phantom:sphere?size=64";
constexpr double kRadius_m = 0.7 * 31.5e-3;
constexpr double kDistance_m = 0.1;
constexpr int kSide = 65;  // so that the middle of a pixel is the middle of the picture
constexpr std::size_t kMiddle = 32 * 65 + 32;

// A trilinear interpolation of the distance from the sphere is at most h^2/8 * 3/R too high, with R one voxel inside;
// the surface is then so much too far inside. 1.2e-3 of a voxel: the worst root in a cell (shaders/draw.layout.h).
constexpr double kVoxel_m = 1e-3;
constexpr double kSurface_m = kVoxel_m * kVoxel_m * 3 / (8 * (kRadius_m - kVoxel_m)) + 1.2e-3 * kVoxel_m;

class Render : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] RenderRequest sphere(const std::string& name) const {
    RenderRequest request;
    request.in = kSphere;
    request.out = file(name + ".png");
    request.depth = file(name + ".pfm");
    request.width = request.height = kSide;
    request.target_W = Vec3::Zero();
    request.distance_m = kDistance_m;
    return request;
  }
  static RenderResult drawn(const RenderRequest& request) {
    Progress progress;
    return render(request, progress);
  }
  static void expectRefused(const RenderRequest& request, Error::Code code, const std::string& words) {
    try {
      (void)drawn(request);
      ADD_FAILURE() << "no error, wanted: " << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }

  TemporaryFolder folder_;
};

// Of a file of kSide x kSide pixels, rows from the top.
std::vector<float> depthsOf(const std::string& file) {
  const std::string bytes = contentsOf(file), header = "Pf\n65 65\n-1.0\n";
  std::vector<float> depths(std::size_t{kSide} * kSide);
  EXPECT_TRUE(bytes.starts_with(header));
  EXPECT_EQ(bytes.size(), header.size() + 4 * depths.size());
  if (bytes.size() != header.size() + 4 * depths.size()) return depths;
  for (std::size_t y = 0; y < kSide; ++y)
    std::memcpy(&depths[y * kSide], &bytes[header.size() + sizeof(float) * kSide * (kSide - 1 - y)],
                sizeof(float) * kSide);
  return depths;
}

// How near the ray through a pixel comes to the sphere's centre [m], and the cosine of its angle with the view axis.
struct Ray {
  double closest_m, cosine;
};
Ray rayOf(std::size_t pixel, double fov_rad) {
  const std::size_t row = pixel / kSide;
  const double x = static_cast<double>(pixel % kSide) - 32, y = static_cast<double>(row) - 32;
  const double tangent = std::hypot(x, y) * 2 * std::tan(fov_rad / 2) / kSide;
  const double cosine = 1 / std::sqrt(1 + tangent * tangent);
  return {kDistance_m * tangent * cosine, cosine};
}

TEST_F(Render, DepthIsTheDistanceAlongTheRay) {
  const RenderRequest request = sphere("a");
  const RenderResult result = drawn(request);
  const std::vector<float> depths = depthsOf(file("a.pfm"));
  EXPECT_NEAR(depths[kMiddle], kDistance_m - kRadius_m, kSurface_m);
  std::size_t hits = 0;
  double nearest_m = 1, farthest_m = 0;
  for (std::size_t pixel = 0; pixel < depths.size(); ++pixel) {
    const Ray ray = rayOf(pixel, request.fov_rad);
    const bool hit = std::isfinite(depths[pixel]);
    if (std::abs(ray.closest_m - kRadius_m) > kSurface_m) {
      EXPECT_EQ(hit, ray.closest_m < kRadius_m) << pixel;
    }
    if (!hit) continue;
    ++hits;
    nearest_m = std::min<double>(nearest_m, depths[pixel]);
    farthest_m = std::max<double>(farthest_m, depths[pixel]);
    if (ray.closest_m > 0.9 * kRadius_m) continue;
    // The ray meets the surface at an angle, which makes an error of the surface this much longer along the ray.
    const double chord_m = std::sqrt(kRadius_m * kRadius_m - ray.closest_m * ray.closest_m);
    EXPECT_NEAR(depths[pixel], kDistance_m * ray.cosine - chord_m, kSurface_m * kRadius_m / chord_m) << pixel;
  }
  EXPECT_GT(hits, 500U);
  ASSERT_EQ(result.pictures.size(), 1U);
  EXPECT_EQ(result.pictures[0].hit_pixels, hits);
  EXPECT_EQ(result.pictures[0].nearest_m, nearest_m);
  EXPECT_EQ(result.pictures[0].farthest_m, farthest_m);
  EXPECT_EQ(result.pictures[0].bytes, std::filesystem::file_size(file("a.png")));
  EXPECT_EQ(result.pictures[0].depth_bytes, std::filesystem::file_size(file("a.pfm")));
  EXPECT_EQ(result.size, Vec3i::Constant(64));
  EXPECT_EQ(result.isovalue, 0);
  EXPECT_EQ(result.lowest, -1000);
  EXPECT_EQ(result.highest, 1000);
  EXPECT_TRUE(result.extent.low_W.isApprox(Vec3::Constant(-0.0315), 1e-12));
  EXPECT_TRUE(result.extent.high_W.isApprox(Vec3::Constant(0.0315), 1e-12));
  EXPECT_FALSE(result.is_distance);
  EXPECT_EQ(result.distance_m, kDistance_m);
  EXPECT_NE(result.device, "");
  EXPECT_GT(result.gpu_bytes, 0U);
  EXPECT_FALSE(result.slice_range);
  const Decoded picture = decode(contentsOf(file("a.png")));
  EXPECT_EQ(picture.width, kSide);
  EXPECT_EQ(picture.height, kSide);
}

// The front half is taken away, and the face of the cut is seen; or the back half, which nobody saw. 1e-7: rounding of
// floats of 0.1 m, several times.
TEST_F(Render, AClipPlaneCuts) {
  RenderRequest request = sphere("a");
  const RenderResult whole = drawn(request);
  const float middle = depthsOf(file("a.pfm"))[kMiddle];
  request.clips = {*planeOf("y=0")};
  (void)drawn(request);
  EXPECT_NEAR(depthsOf(file("a.pfm"))[kMiddle], kDistance_m, 1e-7);
  request.clips = {*planeOf("-y=0")};
  const RenderResult front = drawn(request);
  EXPECT_EQ(depthsOf(file("a.pfm"))[kMiddle], middle);
  EXPECT_LE(front.pictures[0].hit_pixels, whole.pictures[0].hit_pixels);
  request.clips = {*planeOf("y=25")};  // behind the sphere, in the volume
  EXPECT_EQ(drawn(request).pictures[0].hit_pixels, 0U);
}

// The volume is from -31.5 to 31.5 mm: half of it is at 0. Nobody said where the camera is: it looks at the quarter
// that is left, and goes nearer. From where it was, a quarter of the pixels would be left. A brick is 8 mm.
TEST_F(Render, TheQuarterThatClipsLeaveFillsThePicture) {
  RenderRequest request = sphere("a");
  request.target_W.reset();
  request.distance_m.reset();
  const RenderResult whole = drawn(request);
  request.clips = {*planeOf("z=50%"), *planeOf("x=50%")};
  const RenderResult quarter = drawn(request);
  EXPECT_NEAR(whole.target_W.norm(), 0, 0.004);
  EXPECT_LT((quarter.target_W - Vec3(kRadius_m / 2, 0, kRadius_m / 2)).cwiseAbs().maxCoeff(), 0.008);
  EXPECT_LT(quarter.distance_m, 0.9 * whole.distance_m);
  EXPECT_GT(static_cast<double>(quarter.pictures[0].hit_pixels),
            0.4 * static_cast<double>(whole.pictures[0].hit_pixels));
  const std::vector<float> depths = depthsOf(file("a.pfm"));
  for (std::size_t i = 0; i < kSide; ++i) EXPECT_TRUE(std::isinf(depths[i * kSide]) && std::isinf(depths[i])) << i;
}

// It hides no depth: that is the first surface's.
TEST_F(Render, ASecondSurfaceChangesColoursAlone) {
  RenderRequest request = sphere("a");
  (void)drawn(request);
  request = sphere("b");
  request.second = -600;
  (void)drawn(request);
  EXPECT_EQ(contentsOf(file("a.pfm")), contentsOf(file("b.pfm")));
  const Decoded one = decode(contentsOf(file("a.png"))), two = decode(contentsOf(file("b.png")));
  EXPECT_NE(one.at(32, 32), two.at(32, 32));
  EXPECT_EQ(one.at(0, 0), two.at(0, 0));  // beside both
}

// 1.5 levels for rounding and the normal's error: central differences of a distance err by h^2/(2 R^2) at most, 0.001,
// the place by as little.
TEST_F(Render, NormalsAreColoursInTheCamerasFrame) {
  RenderRequest request = sphere("a");
  request.normals = true;
  (void)drawn(request);
  const Decoded picture = decode(contentsOf(file("a.png")));
  const std::vector<float> depths = depthsOf(file("a.pfm"));
  for (const auto& [x, y] : {std::pair(32, 32), std::pair(40, 32), std::pair(32, 40), std::pair(25, 20)}) {
    const std::size_t pixel = static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
    const double tangent = 2 * std::tan(request.fov_rad / 2) / kSide;
    const Vec3 ray = Vec3((x - 32) * tangent, (32 - y) * tangent, -1).normalized();  // right, up, to the camera
    const Vec3 normal = (Vec3(0, 0, kDistance_m) + depths[pixel] * ray) / kRadius_m;
    const std::uint32_t colour = picture.at(x, y);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(colour >> (16 - 8 * axis) & 255U, 255 * (0.5 + 0.5 * normal[axis]), 1.5) << x << ' ' << y;
    }
  }
}

// A slice in front of the sphere, 0.95 mm from it: the density is a ramp from 0 at the sphere to -1000 at 3 mm
// (simpleProfile() of engine/phantoms/solids.cpp). It is looked at where the ramp's end is two voxels away. Grey has
// 255 levels for 2000; 1.5 levels: rounding, and 0.8 for kSurface_m.
TEST_F(Render, ASliceShowsTheDensity) {
  RenderRequest request = sphere("a");
  request.slices = {*planeOf("y=-23")};
  request.slice_range = SliceRange{-1500, 500};
  const RenderResult result = drawn(request);
  ASSERT_TRUE(result.slice_range);
  EXPECT_EQ(result.slice_range->white, 500);
  EXPECT_EQ(result.pictures[0].hit_pixels, kSide * kSide);
  const Decoded picture = decode(contentsOf(file("a.png")));
  const std::vector<float> depths = depthsOf(file("a.pfm"));
  int looked_at = 0;
  for (std::size_t pixel = 0; pixel < depths.size(); ++pixel) {
    const Ray ray = rayOf(pixel, request.fov_rad);
    const double depth_m = (kDistance_m - 0.023) / ray.cosine;
    EXPECT_NEAR(depths[pixel], depth_m, 1e-7) << pixel;
    const double outside_m = std::hypot(0.023, std::sqrt(1 - ray.cosine * ray.cosine) * depth_m) - kRadius_m;
    if (outside_m > 1e-3) continue;
    ++looked_at;
    const double level = 255 * (1500 - 1000 * outside_m / 3e-3) / 2000;
    EXPECT_NEAR(picture.at(static_cast<int>(pixel % kSide), static_cast<int>(pixel / kSide)) & 255U, level, 1.5);
  }
  EXPECT_GT(looked_at, 10);
}

// Without a range the picture's is chosen from the histogram: of a sphere from the lowest to the highest density.
TEST_F(Render, ASliceHasARangeWithoutBeingTold) {
  RenderRequest request = sphere("a");
  request.slices = {*planeOf("x=0")};
  const RenderResult result = drawn(request);
  ASSERT_TRUE(result.slice_range);
  EXPECT_EQ(result.slice_range->black, -1000);
  EXPECT_NEAR(result.slice_range->white, 1000, 1e-9);
}

// And of what is drawn: a sigma of 8 voxels carries background (-1000) into the middle of a sphere of 22 voxels. 5.6 %
// of a Gaussian's weight is farther from the middle than 2.75 sigma, so the density there is some 890.
TEST_F(Render, ASliceHasTheRangeOfTheFilteredField) {
  RenderRequest request = sphere("a");
  request.filter = "gaussian:8";
  request.slices = {*planeOf("x=0")};
  const RenderResult result = drawn(request);
  ASSERT_TRUE(result.slice_range);
  EXPECT_LT(result.highest, 950);
  EXPECT_LE(result.slice_range->white, result.highest + 1e-6);
  EXPECT_GE(result.slice_range->black, result.lowest - 1e-6);
}

// Nobody said where the camera is: every frame shows all of the object. The axes are left-handed and turned.
TEST_F(Render, ATurnShowsTheWholeObjectInEveryFrame) {
  Lattice lattice;
  lattice.R_WL = Eigen::AngleAxisd(0.6, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  lattice.R_WL.col(2) *= -1;
  lattice.origin_W = {0.2, 0.1, -0.3};
  lattice.spacing_m = {1e-3, 0.6e-3, 1.5e-3};
  const Vec3i size(50, 40, 30);
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i)  // a long ball, not in the middle
        values.push_back(static_cast<float>(1 - Vec3((i - 20) / 18.0, (j - 22) / 8.0, (k - 15) / 9.0).norm()));
    }
  }
  (void)saveVolume(Volume::fromDense(size, lattice, values, {}), file("v.nrrd"));
  RenderRequest request;
  request.in = file("v.nrrd");
  request.out = file("o.png");
  request.depth = file("o.pfm");
  request.isovalue = 0;
  request.width = request.height = kSide;
  request.view = *viewAnglesOf("20,35");
  request.frames = 3;
  const RenderResult result = drawn(request);
  ASSERT_EQ(result.pictures.size(), 3U);
  EXPECT_EQ(folder_.files(), 1 + 6);
  for (const Picture& picture : result.pictures) {
    const std::vector<float> depths = depthsOf(picture.files.depth);
    EXPECT_GT(picture.hit_pixels, 300U);
    for (std::size_t i = 0; i < kSide; ++i) {
      for (const std::size_t edge : {i, std::size_t{kSide - 1} * kSide + i, i * kSide, i * kSide + kSide - 1})
        EXPECT_TRUE(std::isinf(depths[edge])) << picture.files.depth;
    }
  }
  EXPECT_NE(contentsOf(file("o_000.pfm")), contentsOf(file("o_001.pfm")));
}

// The surface of the distance is at 0. Its error is below half a voxel.
TEST_F(Render, AFilteredFieldIsDrawn) {
  RenderRequest request = sphere("a");
  request.filter = "gaussian:0.7 distance:3";
  request.second = -0.002;  // 2 mm around it
  const RenderResult result = drawn(request);
  EXPECT_TRUE(result.is_distance);
  EXPECT_EQ(result.isovalue, 0);
  EXPECT_NEAR(result.highest, 0.003, 1e-9);  // the band, in metres
  EXPECT_NEAR(depthsOf(file("a.pfm"))[kMiddle], kDistance_m - kRadius_m, 0.5e-3);
}

TEST_F(Render, RefusesWhatItCannotDraw) {
  const auto bad = Error::Code::kBadInput;
  const auto with = [&](auto change) {
    RenderRequest request = sphere("a");
    change(request);
    return request;
  };
  expectRefused(with([](auto& r) { r.out = "a.jpg"; }), bad, "a.jpg: a picture is written as .png only");
  expectRefused(with([](auto& r) { r.depth = "a.tif"; }), bad, "a.tif: a depth image is");
  expectRefused(with([](auto& r) { r.isovalue = 1e6; }), bad, "isovalue 1e+06");
  expectRefused(with([](auto& r) { r.second = 0; }), bad,
                "--second: isovalue 0 is not below that of the first surface, 0, so it lies within it; give one below");
  expectRefused(with([](auto& r) {
                  r.filter = "distance:3";
                  r.second = 0.002;
                }),
                bad, "--second: isovalue 0.002 m is not below that of the first surface, 0 m, so it lies within it");
  expectRefused(with([](auto& r) {
                  r.filter = "distance:3";
                  r.second = -300;
                }),
                bad, "--second: isovalue -300 m gives no surface: the distances that are drawn are -0.003 to 0.003 m");
  expectRefused(with([](auto& r) { r.slices = {*planeOf("z=40")}; }), bad,
                "--slice: 'z=40' lies beside the volume, which reaches from -31.5,-31.5,-31.5 to 31.5,31.5,31.5 mm");
  expectRefused(with([](auto& r) { r.clips = {*planeOf("y=100")}; }), bad, "--clip: nothing is left of the volume");
  expectRefused(
      with([](auto& r) { r.second = -1001; }), bad,
      "--second: isovalue -1001 gives no surface: the densities that are drawn are -1000 to 1000; choose one");
  expectRefused(with([](auto& r) { r.filter = "mean:1"; }), bad, "mean");
  expectRefused(with([](auto& r) { r.filter = "erode:20"; }), bad, "--iso: isovalue 0 gives no surface");
  expectRefused(with([](auto& r) { r.in = "phantom:sphere?size=9x9x1"; }), bad, "a surface needs two");
  expectRefused(with([](auto& r) { r.gpu = "Voodoo"; }), Error::Code::kNotFound, "Voodoo");
  expectRefused(with([](auto& r) { r.gpu_memory_bytes = 4096; }), Error::Code::kOutOfMemory, "");
  expectRefused(with([&](auto& r) { r.in = file("none.nrrd"); }), Error::Code::kNotFound, "no such file");
  expectRefused(with([&](auto& r) { r.out = file("none/a.png"); }), Error::Code::kIo, "none");
  expectRefused(with([&](auto& r) { r.depth = file("none/a.pfm"); }), Error::Code::kIo, "none");
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(Render, FailedLeavesTheOlderFiles) {
  std::ofstream(file("a.png")) << "old";
  RenderRequest request = sphere("a");
  request.second = 1e6;
  expectRefused(request, Error::Code::kBadInput, "--second");
  EXPECT_EQ(contentsOf(file("a.png")), "old");
  EXPECT_EQ(folder_.files(), 1);
}

// Last: the request to stop stays.
TEST_F(Render, ZStoppedLeavesTheOlderFiles) {
  std::ofstream(file("a.png")) << "old";
  catchInterrupts();
  // A test program that ends slowly is not to be ended by the thread that watches for such ones; so this stays.
  [[maybe_unused]] static const KeptWork& kept = *new KeptWork;
  std::raise(SIGINT);
  expectRefused(sphere("a"), Error::Code::kCancelled, "palpate render: stopped by the user; nothing was written");
  EXPECT_EQ(contentsOf(file("a.png")), "old");
  EXPECT_EQ(folder_.files(), 1);
}

}  // namespace render_job_test
}  // namespace palpate
