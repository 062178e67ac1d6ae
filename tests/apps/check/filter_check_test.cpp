// SPDX-License-Identifier: Apache-2.0
// Filters against their twins: all of the table is checked and holds, and a difference is found where it is.
#include "apps/check/filter_check.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "apps/check/rounding_bound.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/filter/filter_spec.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/reference/filter.hpp"

namespace palpate {
namespace filter_check_test {

constexpr auto kQuiet = [](double) {};

void expectAllHold(const std::vector<Check>& checks) {
  EXPECT_TRUE(allHold(checks)) << checkTable(checks);
}

TEST(FilterCheck, NamesEveryFilterTwiceAndBothBorders) {
  const Volume volume = loadVolume("phantom:knot?size=20");
  std::multiset<std::string> names;
  std::set<std::string> mirrored;
  for (const std::string& chain : checkedFilters(volume)) {
    if (chain.find(' ') != std::string::npos) continue;
    const std::string name = chain.substr(0, chain.find(':'));
    names.insert(name);
    if (chain.find("border=mirror") != std::string::npos) mirrored.insert(name);
  }
  std::set<std::string> once;
  for (const std::string& chain : checkedFilters(volume, true)) once.insert(chain.substr(0, chain.find(':')));
  for (const FilterWords& words : filterTable()) {
    const std::string name(words.name);
    EXPECT_GE(names.count(name), 2U) << name;
    EXPECT_EQ(once.count(name), 1U) << name;
    const bool has_border = words.keys.find("border") != std::string_view::npos;
    EXPECT_EQ(mirrored.count(name), has_border ? 1U : 0U) << name;
  }
}

// Ranges are parts of the contrast, 20, and slopes and lengths go by the smallest spacing, 0.5 mm.
TEST(FilterCheck, SuitsItsChainsToTheVolume) {
  const Volume volume = Volume::fromDense({2, 1, 1}, {Vec3::Zero(), Mat3::Identity(), Vec3(2e-3, 0.5e-3, 1e-3)},
                                          std::vector<float>{-5, 15}, {});
  const std::vector<std::string> chains = checkedFilters(volume);
  for (const char* chain :
       {"bilateral:1:range=2", "diffuse:2:kappa=4", "gaussian:0.85mm:truncate=2:border=mirror",
        "bilateral:0.6mm:range=6.67:border=mirror", "diffuse:2:kappa=2:g=exp", "open:1.05mm:shape=ball:border=mirror"})
    EXPECT_THAT(chains, testing::Contains(chain));
}

// Each check says of what it is; those of a chain are its steps and the whole.
TEST(FilterCheck, NamesWhatItChecks) {
  const Volume volume = loadVolume("phantom:random?size=9x8x7");
  const auto checks = checkFilters(volume, {"", {"median:1 median:1", "distance:2", "median:1"}, 0.5F}, kQuiet);
  std::vector<std::string> told;
  for (const Check& check : checks) {
    told.push_back(check.name + " " + check.what + ", " + check.part);
    EXPECT_EQ(check.volume, "phantom:random?size=9x8x7");
    EXPECT_EQ(check.compared, 9U * 8 * 7);
    EXPECT_TRUE(check.finite);
    EXPECT_NE(check.device, "");
    const bool has_twin = check.part != "chain against its steps";
    EXPECT_EQ(check.cpu_seconds > 0, has_twin) << told.back();
    EXPECT_EQ(check.gpu_seconds > 0, check.name == "filter") << told.back();
  }
  EXPECT_THAT(told,
              testing::ElementsAre("filter median:1 median:1, step 1 of 2", "filter median:1 median:1, step 2 of 2",
                                   "filter median:1 median:1, chain against its steps", "filter distance:2, ",
                                   "distance distance:2, ", "filter median:1, "));
}

class FilterCheckOf : public testing::TestWithParam<std::string> {};
TEST_P(FilterCheckOf, Holds) {
  FilterCheckRequest request;
  request.isovalue = 0.5F;
  expectAllHold(checkFilters(loadVolume(GetParam()), request, kQuiet));
}
INSTANTIATE_TEST_SUITE_P(Volumes, FilterCheckOf,
                         testing::Values("phantom:random?size=19x17x21", "phantom:random?size=2x9x17&seed=3",
                                         "phantom:knot?size=26x19x21&spacing=0.3x0.7x1.1mm&noise=0.05"),
                         [](const auto& volume) { return "number" + std::to_string(volume.index); });

// One voxel of the twin's field is another number.
class FilterCheckSees : public testing::Test {
 protected:
  [[nodiscard]] static std::vector<Check> checkWithChanged(const std::string& chain, const Vec3i& voxel, float by) {
    std::vector<float> values;
    for (int n = 0; n < 12 * 11 * 10; ++n) values.push_back(static_cast<float>(n * 7919 % 1024) + 1024);
    const Volume volume =
        Volume::fromDense({12, 11, 10}, {Vec3::Zero(), Mat3::Identity(), Vec3(1e-3, 1e-3, 1e-3)}, values, {});
    reference::DenseField field = reference::denseField(volume);
    float& value = field.values[field.offset(voxel.x(), voxel.y(), voxel.z())];
    value += by;
    return checkFilters(volume, field, {"", {chain}, 1500.0F}, kQuiet);
  }
  static void expectSeenNear(const Check& check, const Vec3i& voxel, int reach) {
    EXPECT_FALSE(check.holds()) << check.what;
    EXPECT_GT(check.broken, 0U);
    EXPECT_LE((check.voxel - voxel).cwiseAbs().maxCoeff(), reach);
    EXPECT_NE(check.gpu_value, check.cpu_value);
    EXPECT_EQ(check.component, "density");
  }
};

// A value that is the highest of its surroundings goes to each voxel of the window.
TEST_F(FilterCheckSees, AVoxelOfAWindow) {
  const auto checks = checkWithChanged("dilate:1:shape=ball", {5, 6, 7}, 2000);
  ASSERT_EQ(checks.size(), 1U);
  expectSeenNear(checks[0], {5, 6, 7}, 1);
  EXPECT_EQ(checks[0].differing, 7U);
}

// The first step differs; what comes after is compared for what the GPU made of it, and is right.
TEST_F(FilterCheckSees, TheStepInWhichADifferenceArises) {
  const auto checks = checkWithChanged("gaussian:1", {5, 6, 7}, 100);
  ASSERT_EQ(checks.size(), 4U);
  expectSeenNear(checks[0], {5, 6, 7}, 3);
  EXPECT_EQ(checks[0].differing, 7U);  // sigma 1, three sigmas either way
  EXPECT_EQ(checks[0].part, "step 1 of 3");
  for (std::size_t i = 1; i < 4; ++i) EXPECT_TRUE(checks[i].holds()) << checks[i].part;
}

// Steps that are promised by their bits: a change of one voxel is found within the chain's reach of it.
TEST_F(FilterCheckSees, AChangeInEachKindOfStep) {
  for (const char* chain : {"erode:1", "median:1", "diffuse:1:kappa=50", "distance:2"}) {
    const float by = chain[0] == 'm' ? 3000 : 0.3F;  // a median takes the middle voxel only if it stays in the middle
    const auto checks = checkWithChanged(chain, {3, 4, 5}, chain[0] == 'e' ? -1500 : by);
    expectSeenNear(checks.at(0), {3, 4, 5}, 6);
  }
}

// Where the promise is a bound, half a density in a thousand is too much.
TEST_F(FilterCheckSees, MoreThanItsBoundWhereThereAreExponentials) {
  for (const char* chain : {"bilateral:1:range=200", "diffuse:1:kappa=200:g=exp"}) {
    const auto checks = checkWithChanged(chain, {5, 6, 7}, 0.5F);
    expectSeenNear(checks.at(0), {5, 6, 7}, 2);
    EXPECT_FALSE(checks[0].reason.empty());
  }
}

// The bound is near the rounding of one number, so it would let no wrong result through: a few thousand roundings of
// the largest density, 125 voxels with their 2 * 125 + 4 roundings, on a field with slopes of some ranges.
TEST(RoundingBound, IsSmall) {
  const Volume volume = loadVolume("phantom:knot?size=16&noise=0.05");
  const reference::DenseField field = reference::denseField(volume);
  for (const char* chain : {"bilateral:1:range=200", "diffuse:1:kappa=200:g=exp"}) {
    const FilterStep step = lowerFilters(filterChain(chain), volume.lattice().spacing_m).at(0);
    ASSERT_TRUE(hasExponential(step));
    double largest = 0;
    for (int i = 0; i < 16; ++i) largest = std::max(largest, roundingBound(field, {i, 8, 7}, step, field.at(i, 8, 7)));
    EXPECT_GT(largest, 0);
    EXPECT_LT(largest, 4096 * 0x1p-24 * std::max(std::abs(volume.minimum()), std::abs(volume.maximum())));
  }
  for (const char* chain : {"gaussian:1", "diffuse:1:kappa=200", "median:1"}) {
    EXPECT_FALSE(hasExponential(lowerFilters(filterChain(chain), Vec3::Constant(1e-3)).at(0)));
  }
}

TEST(FilterCheck, TellsHowFarItIsAndCanBeCancelled) {
  const Volume volume = loadVolume("phantom:random?size=12");
  std::vector<double> told = {0};
  (void)checkFilters(volume, {"", {"gaussian:1", "distance:2", "median:1"}, {}},
                     [&](double done) { told.push_back(done); });
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
  EXPECT_NEAR(told[told.size() - 2], 1, 1e-12);  // of the last comparison: parts of one size add up to the whole
  EXPECT_THROW((void)checkFilters(volume, {"", {"median:1"}, {}},
                                  [](double) { throw Error(Error::Code::kCancelled, "x", "y", "z"); }),
               Error);
}

// A twin goes through a large volume for minutes: it tells after each slice, and so does the comparison.
TEST(FilterCheck, CanBeCancelledWithinAStep) {
  const Volume volume = loadVolume("phantom:random?size=7x9x12");
  const reference::DenseField field = reference::denseField(volume);
  for (const char* chain : {"median:1", "distance:2", "gaussian:1 diffuse:2:kappa=10"}) {
    const auto steps = lowerFilters(filterChain(chain), volume.lattice().spacing_m, 0.0F);
    std::vector<double> told;
    (void)reference::applyFilters(field, steps, [&](double done) { told.push_back(done); });
    const std::size_t rounds = hasDistance(filterChain(chain)) ? steps.size() + 1 : steps.size();
    EXPECT_EQ(told.size(), rounds * 12) << chain;
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << chain;
    EXPECT_NEAR(told.front(), 1.0 / static_cast<double>(told.size()), 1e-12) << chain;
    EXPECT_NEAR(told.back(), 1, 1e-12) << chain;
  }
  std::vector<double> told;
  (void)checkFilters(volume, {"", {"median:1"}, {}}, [&](double done) { told.push_back(done); });
  EXPECT_GE(told.size(), 2 * 12U);
  std::size_t left = 15;  // which ends within the comparison
  const auto stop = [&](double) {
    if (--left == 0) throw Error(Error::Code::kCancelled, "x", "y", "z");
  };
  EXPECT_THROW((void)checkFilters(volume, {"", {"median:1"}, {}}, stop), Error);
  EXPECT_EQ(left, 0U);
}

TEST(FilterCheck, RefusesWhatCannotBe) {
  const Volume volume = loadVolume("phantom:box?size=8");
  EXPECT_THROW((void)checkFilters(volume, {"Voodoo", {"median:1"}, {}}, kQuiet), Error);
  EXPECT_THROW((void)checkFilters(volume, {"", {"mean:1"}, {}}, kQuiet), Error);
}

}  // namespace filter_check_test
}  // namespace palpate
