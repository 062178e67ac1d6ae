// SPDX-License-Identifier: Apache-2.0
// Routes of chains, followed step by step on paper: what each pool holds when a step reads it.
#include "engine/filter_passes/filter_route.hpp"

#include <array>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "tests/engine/passes/test_fields.hpp"

namespace palpate {
namespace filter_route_test {

std::vector<FilterStep> stepsOf(const std::string& chain) {
  return lowerFilters(filterChain(chain), Vec3::Constant(1e-3), 0.5F);
}

// One step, two that share, more than there are pools, distances at the beginning, in the middle, at the end, twice.
const std::array<const char*, 11> kChains = {"median:1",
                                             "median:1 median:1",
                                             "gaussian:1",
                                             "diffuse:5:kappa=1",
                                             "distance:3",
                                             "median:1 distance:3",
                                             "distance:3 median:1",
                                             "gaussian:1 distance:3 gaussian:1",
                                             "distance:2 distance:3",
                                             "median:1 distance:2 distance:3 median:1",
                                             "gaussian:1 close:1 open:1 distance:3"};

// The step whose densities a distance's end takes: the one before its seed.
int readAtTheEnd(const std::vector<FilterStep>& steps, std::size_t finish) {
  std::size_t seed = finish;
  while (steps[seed].kind != StepKind::kDistanceSeed) --seed;
  return static_cast<int>(seed) - 1;
}

// Every step finds in the pool that it reads what the step wrote there that it is to follow: no other has written it
// since. The last step writes the result.
TEST(FilterRoute, NoStepWritesWhatALaterOneReads) {
  for (const char* chain : kChains) {
    const auto steps = stepsOf(chain);
    const auto routes = routesOf(steps);
    ASSERT_EQ(routes.size(), steps.size()) << chain;
    std::map<std::size_t, int> holds;  // the last step that wrote each pool
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const auto step = static_cast<int>(i);
      const bool is_finish = steps[i].kind == StepKind::kDistanceFinish;
      EXPECT_EQ(routes[i].from, is_finish ? readAtTheEnd(steps, i) : step - 1) << chain << ", step " << i;
      if (routes[i].from >= 0) {
        const std::size_t read = routes[static_cast<std::size_t>(routes[i].from)].pool;
        EXPECT_EQ(holds.at(read), routes[i].from) << chain << ", step " << i << " reads what was written over";
        EXPECT_NE(routes[i].pool, read) << chain << ", step " << i << " writes what it reads";
      }
      EXPECT_EQ(routes[i].in_place, is_finish) << chain << ", step " << i;
      if (routes[i].in_place) {
        EXPECT_EQ(holds.at(routes[i].pool), step - 1) << chain << ", step " << i;
      }
      EXPECT_LE(routes[i].pool, FilterRoute::kResult);
      holds[routes[i].pool] = step;
    }
    EXPECT_EQ(routes.back().pool, FilterRoute::kResult) << chain;
  }
}

std::size_t scratchPools(const std::string& chain) {
  std::set<std::size_t> pools;
  for (const FilterRoute& route : routesOf(stepsOf(chain))) pools.insert(route.pool);
  pools.erase(FilterRoute::kResult);
  return pools.size();
}

// A chain of n steps that each read the one before needs n - 1 pools, but no more than two; a distance that begins with
// another's densities keeps these in a third.
TEST(FilterRoute, NeedsAsManyPoolsAsAreReadAtOnce) {
  EXPECT_EQ(scratchPools("median:1"), 0U);
  EXPECT_EQ(scratchPools("median:1 median:1"), 1U);
  EXPECT_EQ(scratchPools("gaussian:1"), 2U);
  EXPECT_EQ(scratchPools("diffuse:50:kappa=1"), 2U);
  EXPECT_EQ(scratchPools("distance:3"), 2U);
  EXPECT_EQ(scratchPools("median:1 distance:3"), 3U);
  EXPECT_EQ(scratchPools("gaussian:1 distance:3 gaussian:1"), 3U);
}

class ScratchOfChains : public testing::Test {
 protected:
  // No two voxels alike, so that every brick is stored.
  const Volume volume_ = makeField({20, 20, 20}, [](int i, int j, int k) { return static_cast<float>(i * 7 + j * k); });
  gpu::Gpu gpu_{{}};
  gpu::Transfer transfer_{gpu_};
  BrickPool pool_{gpu_, transfer_, volume_};
};

// A whole run keeps none; regions keep as many pools as the route has.
TEST_F(ScratchOfChains, IsFreedByAWholeRunAndKeptByRegions) {
  for (const char* text : {"median:1", "median:1 median:1", "diffuse:9:kappa=1", "median:1 distance:3"}) {
    const std::uint64_t before = gpu_.bytesInUse();
    FilterChain chain(gpu_, transfer_, pool_, stepsOf(text));
    chain.run();
    EXPECT_EQ(chain.scratchBytes(), 0U) << text;
    chain.prepare();
    const std::size_t pools = scratchPools(text);
    const std::size_t pages = pool_.brickCount() * sizeof(layout::BrickPage);
    EXPECT_GE(chain.scratchBytes(), pools * pages) << text;
    EXPECT_EQ(chain.scratchBytes() > 0, pools > 0) << text;
    EXPECT_EQ(chain.scratchBytes() % std::max<std::size_t>(pools, 1), 0U) << text;  // all alike
    EXPECT_LE(chain.scratchBytes(), gpu_.bytesInUse() - before) << text;
    chain.abandon();
    EXPECT_EQ(chain.scratchBytes(), 0U) << text;
  }
}

// Steps with the same taps share them: buffers of a diffusion do not grow with its steps.
TEST_F(ScratchOfChains, TapsOfEqualStepsAreThereOnce) {
  const auto bytesOf = [&](const char* text) {
    const std::uint64_t before = gpu_.bytesInUse();
    const FilterChain chain(gpu_, transfer_, pool_, stepsOf(text));
    return gpu_.bytesInUse() - before;
  };
  EXPECT_EQ(bytesOf("diffuse:500:kappa=1"), bytesOf("diffuse:1:kappa=1"));
  EXPECT_GT(bytesOf("diffuse:1:kappa=1 diffuse:1:kappa=2"), bytesOf("diffuse:1:kappa=1"));
}

TEST_F(ScratchOfChains, RefusesAChainOfTooManySteps) {
  const FilterChain longest(gpu_, transfer_, pool_, stepsOf("diffuse:500:kappa=1 diffuse:500:kappa=1"));
  EXPECT_EQ(longest.steps().size(), kMostFilterSteps);
  try {
    const FilterChain longer(gpu_, transfer_, pool_, stepsOf("diffuse:500:kappa=1 diffuse:500:kappa=1 median:1"));
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("it takes 1001 passes over the volume, and 1000 are the most"));
  }
}

}  // namespace filter_route_test
}  // namespace palpate
