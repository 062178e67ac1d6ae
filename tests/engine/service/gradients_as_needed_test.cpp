// SPDX-License-Identifier: Apache-2.0
// Gradients that are computed when a window first reaches a brick. Truth: an engine that has computed all of them at
// the start; each window must be the same, bit for bit.
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/gpu/gpu_use.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace gradients_as_needed_test {

std::uint64_t dispatchesOf(const Engine& engine, const std::string& kernel) {
  std::uint64_t count = 0;
  for (const gpu::KernelUse& use : engine.gpuUse().kernels)
    if (use.name.starts_with(kernel)) count += use.dispatches;
  return count;
}

void expectSameWindows(Engine& a, Engine& b) {
  const SampleWindow& one = a.exchange().latest();
  const SampleWindow& other = b.exchange().latest();
  ASSERT_EQ(one.size, other.size);
  EXPECT_EQ(one.lattice.origin_W, other.lattice.origin_W);
  EXPECT_EQ(std::memcmp(one.samples, other.samples, static_cast<std::size_t>(one.size.prod()) * sizeof(Sample)), 0);
}

struct Case {
  const char* name;
  EngineRequest request;
};

class GradientsAsNeeded : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Requests, GradientsAsNeeded,
                         testing::Values(Case{"central", {}}, Case{"sobel", {.gradient_operator = "sobel"}},
                                         Case{"central4", {.gradient_operator = "central4"}},
                                         Case{"halves", {.half_samples = true}},
                                         Case{"filtered", {.filter = "median:1"}}, Case{"distance", {.distance = true}},
                                         Case{"small_windows", {.window_edge = 8}}, Case{"drawn", {.draws = true}}),
                         [](const testing::TestParamInfo<Case>& one) { return std::string(one.param.name); });

// A tool anywhere in the volume and outside it, from place to place and creeping.
TEST_P(GradientsAsNeeded, MakeTheSameWindows) {
  const Volume volume = makeVolume(*makePhantom("phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm&noise=0.05"));
  EngineRequest request = GetParam().request;
  Engine all(volume, makePlan(request), 0, "");
  request.gradients_as_needed = true;
  const Plan plan = makePlan(request);
  ASSERT_TRUE(plan.gradientsAsNeeded());
  Engine needed(volume, plan, 0, "");
  EXPECT_EQ(dispatchesOf(needed, "gradient"), 0U);
  EXPECT_EQ(needed.planFacts().gradient_bricks, all.planFacts().gradient_bricks);
  EXPECT_LT(needed.memory()[3].bytes, all.memory()[3].bytes);  // samples
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(-5, 66);
  std::normal_distribution<double> step(0, 2);
  Vec3 tool(30, 26, 23);
  for (int n = 0; n < 60; ++n) {
    tool = n % 3 == 0 ? Vec3(anywhere(random), anywhere(random), anywhere(random))
                      : Vec3(tool + Vec3(step(random), step(random), step(random)));
    const Vec3 tool_W = volume.lattice().toWorld(tool);
    EXPECT_EQ(needed.publishAround(tool_W, n + 1), all.publishAround(tool_W, n + 1));
    expectSameWindows(needed, all);
  }
  EXPECT_GT(dispatchesOf(needed, "gradient"), 0U);
}

// A brick is computed once, however often a window shows it.
TEST(GradientsAsNeededOnce, AreKept) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=160"));  // a ball with a radius of 55 voxels
  Engine engine(volume, makePlan({.gradients_as_needed = true}), 0, "");
  const auto showAt = [&](double i) { engine.publishAround(volume.lattice().toWorld({i, 80, 80}), 1); };
  showAt(24);
  const std::uint64_t first = dispatchesOf(engine, "gradient");
  EXPECT_EQ(first, 1U);
  const std::uint64_t bytes = engine.memory()[3].bytes;
  showAt(80);  // the inside of the ball, where nothing crosses
  showAt(24);
  EXPECT_EQ(dispatchesOf(engine, "gradient"), first);
  EXPECT_EQ(engine.memory()[3].bytes, bytes);
  showAt(136);  // the other side
  EXPECT_EQ(dispatchesOf(engine, "gradient"), first + 1);
}

// As of a new engine, so that times of one run say what another would take.
TEST(GradientsAsNeededOnce, AreComputedAgainOnceTheWindowIsForgotten) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=160"));
  Engine engine(volume, makePlan({.gradients_as_needed = true}), 0, "");
  const Vec3 tool_W = volume.lattice().toWorld({24, 80, 80});
  engine.publishAround(tool_W, 1);
  std::vector<Sample> first(engine.exchange().latest().samples,
                            engine.exchange().latest().samples + engine.exchange().latest().size.prod());
  const std::uint64_t dispatches = dispatchesOf(engine, "gradient");
  engine.forgetWindow();
  engine.publishAround(tool_W, 2);
  EXPECT_EQ(dispatchesOf(engine, "gradient"), 2 * dispatches);
  EXPECT_EQ(std::memcmp(engine.exchange().latest().samples, first.data(), first.size() * sizeof(Sample)), 0);
}

// The limit is held against all that the isosurface needs, so that no run ends in the middle for want of room.
TEST(GradientsAsNeededOnce, AreRefusedAtTheStartWhereAllOfThemFindNoRoom) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=96"));
  constexpr std::uint64_t kLittle = 4 << 20U;
  EXPECT_THROW(Engine(volume, makePlan({.gradients_as_needed = true}), 0, "", kLittle), Error);
}

}  // namespace gradients_as_needed_test
}  // namespace palpate
