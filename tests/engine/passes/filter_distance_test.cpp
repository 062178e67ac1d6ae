// SPDX-License-Identifier: Apache-2.0
// The signed distance: bits against the twin, and the exact distance of simple solids.
#include <cmath>

#include "engine/reference/distance.hpp"
#include "filter_on_gpu.hpp"
#include "shaders/kernel_text.hpp"

namespace palpate {
namespace {

using reference::DenseField;

struct Case {
  std::string chain;
  Vec3i size;
  float isovalue = 0;
};
void dbg(const DenseField& in, const DenseField& a, const DenseField& b) {
  int n=0;
  for (std::size_t i = 0; i < a.values.size() && n<8; ++i) if (std::bit_cast<int>(a.values[i])!=std::bit_cast<int>(b.values[i])) { ++n;
    printf("DBG %zu in %g gpu %.9g (%08x) twin %.9g (%08x)\n", i, in.values[i], a.values[i], std::bit_cast<unsigned>(a.values[i]), b.values[i], std::bit_cast<unsigned>(b.values[i])); }
}
class DistanceBits : public testing::TestWithParam<Case> {};

TEST_P(DistanceBits, EqualTheTwin) {
  const auto& [chain, size, isovalue] = GetParam();
  const auto steps = lowerFilters(filterChain(chain), testLattice().spacing_m, isovalue);
  for (const Volume& volume : {ballField(size, 9.0), extremes(size)}) {
    dbg(reference::denseField(volume), filteredOnGpu(volume, steps), reference::applyFilters(reference::denseField(volume), steps));
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::applyFilters(reference::denseField(volume), steps)),
              0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Chains, DistanceBits,
                         testing::Values(Case{"distance:4", {41, 33, 37}}, Case{"distance:6", {40, 48, 24}, 0.7F},
                                         Case{"distance:1", {30, 29, 28}}, Case{"distance:3", {2, 20, 9}, -1},
                                         Case{"distance:5", {2, 2, 17}}, Case{"distance:2", {2, 2, 2}},
                                         Case{"gaussian:1 distance:3 gaussian:0.7", {33, 20, 26}, 0.5F},
                                         Case{"distance:4 distance:2", {33, 30, 26}, 1.0F}));

// Densities of a solid by its signed distance, positive inside [m], on voxels of a given spacing around the origin.
template <typename Density>
Volume solid(const Vec3i& size, const Vec3& spacing_m, Density density) {
  std::vector<float> values;
  const Vec3 middle = (size.cast<double>().array() - 1) / 2 + 0.137;  // no symmetry with the voxels
  for (int n = 0; n < size.prod(); ++n) {
    const Vec3 voxel(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
    values.push_back(static_cast<float>(density(Vec3((voxel - middle).cwiseProduct(spacing_m)))));
  }
  Lattice lattice;
  lattice.spacing_m = spacing_m;
  return Volume::fromDense(size, lattice, values, {});
}

// Largest difference from a solid's own distance, cut off at the band, over voxels chosen by place [m].
struct Worst {
  double error_m = 0;
  Vec3 at_m = Vec3::Zero();
};
template <typename Distance, typename Chosen>
Worst worstError(const DenseField& field, const Vec3& spacing_m, double band_m, Distance distance, Chosen chosen) {
  const Vec3 middle = (field.size.cast<double>().array() - 1) / 2 + 0.137;
  Worst worst;
  for (int n = 0; n < field.size.prod(); ++n) {
    const Vec3 voxel(n % field.size.x(), n / field.size.x() % field.size.y(), n / field.size.x() / field.size.y());
    const Vec3 x = (voxel - middle).cwiseProduct(spacing_m);
    if (!chosen(x)) continue;
    const double truth = std::clamp(distance(x), -band_m, band_m);
    const double error = std::abs(field.values[static_cast<std::size_t>(n)] - truth);
    if (error > worst.error_m) worst = {error, x};
  }
  return worst;
}

DenseField distanceOnGpu(const Volume& volume, int band, float isovalue) {
  return filteredOnGpu(volume, lowerFilters(filterChain("distance:" + std::to_string(band)),
                                            volume.lattice().spacing_m, isovalue));
}
constexpr auto kEverywhere = [](const Vec3&) { return true; };

TEST(Distance, OfBallsTrial) {
  for (const double ratio : {1.0, 2.5}) {
    for (const int n : {1, 2, 4}) {
      const double R = 8e-3;
      const Vec3 h(1e-3 / n, 1e-3 / n, ratio * 1e-3 / n);
      const Vec3i size(30 * n - n, 30 * n - n, static_cast<int>((30 * n - n) / ratio));
      const Volume v1 = solid(size, h, [&](const Vec3& x) { return R * R - x.squaredNorm(); });
      const auto w1 = worstError(distanceOnGpu(v1, 4, 0), h, 4 * h.x(), [&](const Vec3& x) { return R - x.norm(); }, kEverywhere);
      const Volume v2 = solid(size, h, [&](const Vec3& x) { return std::clamp(R - x.norm(),-2*h.x(),2*h.x()); });
      const auto w2 = worstError(distanceOnGpu(v2, 4, 0), h, 4 * h.x(), [&](const Vec3& x) { return R - x.norm(); }, kEverywhere);
      const auto torus = [&](const Vec3& x) { return R/2 - std::hypot(std::hypot(x.x(), x.y()) - R*0.8, x.z()); };
      const Volume v3 = solid(size, h, [&](const Vec3& x) { return std::exp(torus(x)*300); });
      const auto w3 = worstError(distanceOnGpu(v3, 4, 1), h, 4 * h.x(), torus, [&](const Vec3&x){ return std::hypot(x.x(), x.y()) > R*0.8-R/2+0*h.x(); });
      const auto box = [&](const Vec3& x) { const Vec3 q = x.cwiseAbs() - Vec3(6e-3, 5.3e-3, 7.1e-3); return -(q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0)); };
      const Volume v4 = solid(size, h, [&](const Vec3& x) { return std::clamp(box(x), -3*h.x(), 3*h.x()); });
      const auto f4 = distanceOnGpu(v4, 4, 0);
      const auto w4 = worstError(f4, h, 4 * h.x(), box, kEverywhere);
      const auto w5 = worstError(f4, h, 4 * h.x(), box, [&](const Vec3& x) { const Vec3 q = x.cwiseAbs() - Vec3(6e-3, 5.3e-3, 7.1e-3); return (q.array().abs() < 6*h.maxCoeff()).count() <= 1; });
      printf("ball at %g %g %g  r %g (R %g)\n", w2.at_m.x()/h.x(), w2.at_m.y()/h.x(), w2.at_m.z()/h.x(), w2.at_m.norm()/h.x(), R/h.x());
      printf("ratio %g n %d ball2 %.4f ball %.4f torus %.4f box %.4f boxface %.6f voxels; box at %g %g %g\n", ratio, n, w1.error_m / h.x(), w2.error_m/h.x(), w3.error_m/h.x(), w4.error_m/h.x(), w5.error_m/h.x(), w4.at_m.x()/h.x(), w4.at_m.y()/h.x(), w4.at_m.z()/h.x());
    }
  }
}

}  // namespace
}  // namespace palpate
