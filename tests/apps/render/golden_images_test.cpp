// SPDX-License-Identifier: Apache-2.0
// Pictures as a person saw and approved them (golden/). Another driver may round otherwise, so colours are compared as
// an eye does. PALPATE_WRITE_GOLDEN=1 writes them anew: look at each before it is committed.
#include <array>
#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>

#include "apps/render/render_job.hpp"
#include "apps/render/view_words.hpp"
#include "temporary_folder.hpp"
#include "tests/apps/view/decoded.hpp"
#include "tests/support/scans.hpp"

namespace palpate {
namespace golden_images_test {

// CIE L*a*b* of an sRGB colour (IEC 61966-2-1, white D65).
std::array<double, 3> labOf(std::uint32_t rgb) {
  const auto linear = [&](unsigned shift) {
    const double v = (rgb >> shift & 0xFFU) / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const double r = linear(16), g = linear(8), b = linear(0);
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505), y = f(0.2126 * r + 0.7152 * g + 0.0722 * b),
               z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// What an eye just notices: a distance of 2.3 (Mahy, Van Eycken and Oosterlinck, 1994).
constexpr double kJustNoticed = 2.3;

double noticedShare(const Decoded& a, const Decoded& b) {
  int noticed = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    if ((a.rgb[i] & 0xFFFFFFU) == (b.rgb[i] & 0xFFFFFFU)) continue;
    const auto p = labOf(a.rgb[i]), q = labOf(b.rgb[i]);
    noticed += std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) > kJustNoticed;
  }
  return static_cast<double>(noticed) / static_cast<double>(a.rgb.size());
}

// One pixel in 200 may show that a ray at a silhouette passed or hit: of 320 x 240 that is 384, where the outlines of
// these pictures are some 2,000 pixels long.
constexpr double kMostNoticed = 1.0 / 200;

class GoldenImages : public testing::Test {
 protected:
  [[nodiscard]] static RenderRequest request(const std::string& volume) {
    RenderRequest request;
    request.in = volume;
    request.width = 320;
    request.height = 240;
    request.view = {2.5, 0.2};
    request.occlusion = true;  // as approved; it is off by default
    return request;
  }
  // Empty: there are no scans.
  [[nodiscard]] static std::string ctHead() {
    for (const std::filesystem::path& scan : realScans()) {
      if (scan.filename() == "ct_head_invesalius.nrrd") return scan.string();
    }
    return {};
  }
  [[nodiscard]] Decoded drawn(RenderRequest request) const {
    request.out = (folder_.path() / "drawn.png").string();
    Progress progress;
    static_cast<void>(render(request, progress));
    return decode(contentsOf(request.out));
  }
  void expectAsApproved(const RenderRequest& request, const std::string& name) const {
    const Decoded now = drawn(request);
    const std::filesystem::path golden = std::filesystem::path(PALPATE_GOLDEN) / (name + ".png");
    if (std::getenv("PALPATE_WRITE_GOLDEN") != nullptr) {
      std::filesystem::copy_file(folder_.path() / "drawn.png", golden,
                                 std::filesystem::copy_options::overwrite_existing);
    }
    const Decoded approved = decode(contentsOf(golden.string()));
    ASSERT_EQ(now.width, approved.width);
    ASSERT_EQ(now.height, approved.height);
    EXPECT_LE(noticedShare(now, approved), kMostNoticed) << golden;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(GoldenImages, OfThePhantomHead) {
  expectAsApproved(request("phantom:head"), "phantom_head");
}

TEST_F(GoldenImages, OfASkull) {
  const std::string head = ctHead();
  if (head.empty()) GTEST_SKIP() << kNoScans;
  expectAsApproved(request(head), "skull");
}

// Skin over bone, cut open, with a slice in the cut.
TEST_F(GoldenImages, OfAHeadCutOpen) {
  const std::string head = ctHead();
  if (head.empty()) GTEST_SKIP() << kNoScans;
  RenderRequest cut = request(head);
  cut.isovalue = 300;
  cut.second = -300;
  cut.clips = {planeOf("x=40%").value()};
  cut.slices = {planeOf("x=40%").value()};
  expectAsApproved(cut, "head_cut_open");
}

// What the comparison must see: a camera two degrees further, and no shade of hollows.
TEST_F(GoldenImages, OthersAreNotTaken) {
  const RenderRequest as_approved = request("phantom:knot");
  const Decoded knot = drawn(as_approved);
  RenderRequest turned = as_approved, flat = as_approved;
  turned.view.azimuth_rad += 2 / kDegreesPerRadian;
  flat.occlusion = false;
  EXPECT_EQ(noticedShare(knot, drawn(as_approved)), 0);
  EXPECT_GT(noticedShare(knot, drawn(turned)), kMostNoticed);
  EXPECT_GT(noticedShare(knot, drawn(flat)), kMostNoticed);
}

}  // namespace golden_images_test
}  // namespace palpate
