// SPDX-License-Identifier: Apache-2.0
// Windows of every size: what they hold, and that the tool stays in them.
// Truth: the CPU twin, bit for bit.
#include <cstring>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/reference/window.hpp"
#include "engine/service/engine.hpp"
#include "engine/service/window_focus.hpp"
#include "servo/window/window_exchange.hpp"
#include "tests/engine/passes/sample_bits.hpp"

namespace palpate {
namespace window_edge_test {

Volume knot() {
  return makeVolume(*makePhantom("phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm"));
}

Vec3i firstVoxel(const Volume& volume, const SampleWindow& window) {
  return volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
}

void expectTheTwins(Engine& engine, const Volume& volume) {
  const SampleWindow& window = engine.exchange().latest();
  const auto expected =
      reference::windowSamples(reference::denseField(volume), firstVoxel(volume, window), window.size);
  EXPECT_EQ(std::memcmp(window.samples, expected.data(), expected.size() * sizeof(Sample)), 0);
}

class WindowEdge : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Edges, WindowEdge, testing::Range(kLeastWindowEdge, kMostWindowEdge + 1));

// In the middle, at corners, and over an edit.
TEST_P(WindowEdge, HoldsTheTwinsSamples) {
  Volume volume = knot();
  Engine engine(volume, makePlan({.gradient_all = true, .window_edge = GetParam(), .edits = true}), 0, "");
  const Vec3i size = volume.size().cwiseMin(GetParam());
  EXPECT_EQ(engine.memory()[4].bytes, 3 * static_cast<std::uint64_t>(size.prod()) * sizeof(Sample));
  for (const Vec3& tool : {Vec3(30, 26, 23), Vec3(0, 0, 0), Vec3(60, 52, 46), Vec3(60, 0, 23), Vec3(20, 30, 25)}) {
    EXPECT_TRUE(engine.publishAround(volume.lattice().toWorld(tool), 1));
    EXPECT_EQ(engine.exchange().latest().size, size);
    expectTheTwins(engine, volume);
  }
  engine.allowEdits(brushProfile(volume, 0));
  EditCommand hole;
  hole.from_W = hole.to_W = volume.lattice().toWorld({22, 28, 25});
  hole.radius_m = 4e-3;
  EXPECT_TRUE(engine.edit(std::span(&hole, 1), 2).published);
  EXPECT_GT(engine.readBack(volume), 0U);
  expectTheTwins(engine, volume);
}

TEST_P(WindowEdge, HoldsAVolumeThatIsThinner) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=40x5x9"));
  Engine engine(volume, makePlan({.gradient_all = true, .window_edge = GetParam()}), 0, "");
  for (const Vec3& tool : {Vec3(20, 2, 4), Vec3(39, 0, 8), Vec3(0, 4, 0)}) {
    engine.publishAround(volume.lattice().toWorld(tool), 1);
    EXPECT_EQ(engine.exchange().latest().size, volume.size().cwiseMin(GetParam()));
    expectTheTwins(engine, volume);
  }
}

// After another isovalue every cell that it crosses has the gradients of all its corners.
TEST_P(WindowEdge, ServesAnotherIsovalue) {
  const Volume volume = knot();
  Engine engine(volume, makePlan({.window_edge = GetParam(), .other_isovalues = true}), 0, "");
  engine.publishAround(volume.lattice().toWorld({16, 26, 23}), 1);
  constexpr double kOther = 300;
  engine.beginIsovalue(kOther);
  while (!engine.gatherIsovalue(100, 2)) continue;
  engine.endIsovalue(kOther);
  const SampleWindow& window = engine.exchange().latest();
  const auto expected =
      reference::windowSamples(reference::denseField(volume), firstVoxel(volume, window), window.size);
  int crossed = 0;
  for (int k = 0; k + 1 < window.size.z(); ++k) {
    for (int j = 0; j + 1 < window.size.y(); ++j) {
      for (int i = 0; i + 1 < window.size.x(); ++i) {
        const auto corner = [&](int c) {
          return static_cast<std::size_t>(((k + (c >> 2)) * window.size.y() + j + (c >> 1 & 1)) * window.size.x() + i +
                                          (c & 1));
        };
        int above = 0;
        for (int c = 0; c < 8; ++c) above += window.samples[corner(c)].density > kOther;
        if (above == 0 || above == 8) continue;
        ++crossed;
        for (int c = 0; c < 8; ++c) ASSERT_TRUE(sameBits(window.samples[corner(c)], expected[corner(c)]));
      }
    }
  }
  EXPECT_GT(crossed, 20);
}

// A tool bounces about in the volume at up to a voxel a tick (at 1 kHz and 0.5 mm that is 0.5 m/s) and turns wherever
// it likes. Each tick reads the window that was published for the pose before it. Along each axis, in voxels and with
// the edge e:
// - The tool is at most 3 e / 16 from the focus, the longest lead: the tick's way, at most 1, leads towards it.
// - The focus is at most floor(3 e / 16) - 1 from that of the window in use, or another one would have been gathered.
// - That focus is at most 1/2 from its window's middle, since windows begin at whole voxels.
// In all this is 2 for e = 8, where the window reaches to 3.5, and 11.5 for 32, where it reaches to 15.5. A turn
// changes the focus, for which the same holds; so it needs no exception. At the volume's border the window ends there
// too.
TEST_P(WindowEdge, KeepsTheToolInside) {
  const Volume volume = knot();
  Engine engine(volume, makePlan({.window_edge = GetParam()}), 0, "");
  const Lattice& lattice = volume.lattice();
  std::mt19937 bits(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(bits()) / 4294967296.0;
  };
  for (const double voxels_a_tick : {0.02, 0.3, 1.0}) {
    SCOPED_TRACE(voxels_a_tick);
    Vec3 at_L(30, 26, 23), way_L = Vec3::UnitX();
    const Vec3 last_L = (volume.size() - Vec3i::Ones()).cast<double>();
    engine.forgetWindow();
    for (int tick = 0; tick < 600; ++tick) {
      const bool leaves = ((at_L + voxels_a_tick * way_L).array() < 0).any() ||
                          ((at_L + voxels_a_tick * way_L).array() > last_L.array()).any();
      if (tick % 40 == 0 || leaves) {
        const Vec3 aim_L = Vec3(uniform(0, last_L.x()), uniform(0, last_L.y()), uniform(0, last_L.z()));
        way_L = (aim_L - at_L).normalized();
      }
      const Vec3 velocity_W = (lattice.toWorld(at_L + voxels_a_tick * way_L) - lattice.toWorld(at_L)) * 1000;
      engine.publishFor({.position_W = lattice.toWorld(at_L), .velocity_W = velocity_W, .tick = tick}, tick);
      at_L += voxels_a_tick * way_L;
      const SampleWindow& window = engine.exchange().latest();
      const Vec3 in_window = window.lattice.toIndex(lattice.toWorld(at_L));
      const Vec3 end = (window.size - Vec3i::Ones()).cast<double>();
      const bool inside = (in_window.array() >= -1e-9).all() && (in_window.array() <= end.array() + 1e-9).all();
      EXPECT_TRUE(inside) << tick << ": " << in_window.transpose();
    }
  }
}

TEST(WindowEdges, OutOfRangeAreRefused) {
  for (const int edge : {-1, 0, kLeastWindowEdge - 1, kMostWindowEdge + 1, 1000})
    EXPECT_THROW(static_cast<void>(makePlan({.window_edge = edge})), Error) << edge;
}

// Between runs: the same place gathers anew.
TEST(WindowEdges, AForgottenWindowIsGatheredAnew) {
  const Volume volume = knot();
  Engine engine(volume, makePlan({}), 0, "");
  const Vec3 tool_W = volume.lattice().toWorld({30, 26, 23});
  EXPECT_TRUE(engine.publishAround(tool_W, 1));
  EXPECT_FALSE(engine.publishAround(tool_W, 2));
  engine.forgetWindow();
  EXPECT_TRUE(engine.publishAround(tool_W, 3));
  EXPECT_EQ(engine.exchange().latest().version, 2U);
}

}  // namespace window_edge_test
}  // namespace palpate
