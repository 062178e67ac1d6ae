// SPDX-License-Identifier: Apache-2.0
// All checks on a list of volumes: what the list holds, how scans are cut, and that every promise holds.
#include "apps/check/check_all.hpp"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/phantoms/phantom_spec.hpp"

namespace palpate {
namespace check_all_test {

using testing::Contains;
using testing::HasSubstr;

constexpr auto kQuiet = [](double) {};
constexpr auto kNoStage = [](const std::string&) {};
constexpr auto kLoad = [](const std::string& name) { return loadVolume(name); };

TEST(CheckAll, QuickHolds) {
  CheckAllRequest request;
  request.quick = true;
  std::vector<std::string> stages;
  double last = 0;
  const CheckAll all = checkAll(
      request, [&](const std::string& stage) { stages.push_back(stage); }, [&](double done) { last = done; }, kLoad);
  EXPECT_TRUE(allHold(all.checks)) << checkTable(all.checks);
  std::vector<std::string> expected;
  for (const std::string& volume : checkedVolumes(true)) expected.push_back("checking " + volume);
  EXPECT_EQ(stages, expected);
  EXPECT_EQ(last, 1);
  EXPECT_EQ(all.checks[0].compared, 4U * 19 * 17 * 21);  // a phantom is small enough as it is
  // One of them is a voxel thin; edits are left out of that one alone.
  EXPECT_THAT(all.left_out, testing::ElementsAre("phantom:random?size=1x17x9&seed=2: "
                                                 "edits, since a volume one voxel thick is not touched"));
  EXPECT_EQ(std::count_if(all.checks.begin(), all.checks.end(), [](const Check& c) { return c.name == "edits"; }), 2);
  std::set<std::string> names;
  for (const Check& check : all.checks) names.insert(check.name);
  EXPECT_EQ(names, (std::set<std::string>{"distance", "edits", "filter", "gradient"}));
}

TEST(CheckAll, ListHasEveryPhantomAndThinVolumes) {
  const std::vector<std::string> volumes = checkedVolumes(false);
  for (const PhantomKind& kind : phantomKinds())
    EXPECT_THAT(volumes, Contains(testing::StartsWith("phantom:" + kind.name)));
  for (const char* thin : {"size=1x", "x1x", "x1&", "size=1&"}) EXPECT_THAT(volumes, Contains(HasSubstr(thin)));
}

TEST(CheckAll, TakesOneVolumeAndCutsIt) {
  CheckAllRequest request;
  request.quick = true;
  request.volume = "phantom:box?size=40x12x40";
  request.crop = 11;
  request.seed = 7;
  std::vector<std::string> stages;
  std::vector<double> told = {0};
  const CheckAll all = checkAll(
      request, [&](const std::string& stage) { stages.push_back(stage); }, [&](double done) { told.push_back(done); },
      kLoad);
  EXPECT_TRUE(allHold(all.checks)) << checkTable(all.checks);
  EXPECT_THAT(stages, testing::ElementsAre("checking " + request.volume));
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
  EXPECT_THAT(all.left_out, testing::IsEmpty());
  std::vector<std::string> gradients;
  for (const Check& check : all.checks) {
    if (check.name == "gradient") gradients.push_back(check.what);
  }
  EXPECT_THAT(gradients,
              testing::ElementsAre("central, floats", "sobel, floats", "central4, floats", "gaussian:1.2, floats",
                                   "central, halves", "sobel, halves", "central4, halves", "gaussian:1.2, halves"));
  EXPECT_EQ(all.checks.back().what, "20 at random, seed 7");
  EXPECT_EQ(all.checks[0].compared, 4U * 11 * 11 * 11);
  EXPECT_THAT(all.checks[0].volume, HasSubstr("its middle 11 x 11 x 11 voxels"));
}

// The middle: as many voxels are cut on either side, and each stays where it is in the world.
TEST(CheckAll, CutsTheMiddle) {
  const Volume whole = loadVolume("phantom:knot?size=21x16x9&spacing=0.3x0.7x1.1mm");
  const Volume middle = cropped(loadVolume("phantom:knot?size=21x16x9&spacing=0.3x0.7x1.1mm"), 11);
  EXPECT_EQ(middle.size(), Vec3i(11, 11, 9));
  const Vec3i first(5, 2, 0);
  for (const Vec3i& voxel : {Vec3i(0, 0, 0), Vec3i(10, 10, 8), Vec3i(3, 7, 2)}) {
    EXPECT_EQ(middle.value(voxel), whole.value(voxel + first));
    EXPECT_LT((middle.lattice().toWorld(voxel.cast<double>()) - whole.lattice().toWorld((voxel + first).cast<double>()))
                  .norm(),
              1e-12);
  }
  EXPECT_EQ(cropped(loadVolume("phantom:knot?size=9"), 11).size(), Vec3i(9, 9, 9));
  EXPECT_EQ(cropped(loadVolume("phantom:knot?size=9"), 1).size(), Vec3i(2, 2, 2));  // no surface in less
  EXPECT_EQ(cropped(loadVolume("phantom:knot?size=21x16x9"), 18).facts().source,
            "phantom:knot?size=21x16x9 (its middle 18 x 16 x 9 voxels)");
}

// A volume with one density has no surface: what needs one is left out, and it is said.
TEST(CheckAll, SaysWhatItLeavesOut) {
  CheckAllRequest request;
  request.quick = true;
  request.volume = "phantom:sphere?size=2";  // eight voxels at one distance from the centre
  std::vector<double> told = {0};
  const CheckAll all = checkAll(
      request, kNoStage, [&](double done) { told.push_back(done); }, kLoad);
  EXPECT_TRUE(allHold(all.checks)) << checkTable(all.checks);
  EXPECT_THAT(all.left_out,
              testing::ElementsAre("phantom:sphere?size=2: distances and edits, since it has no surface"));
  for (const Check& check : all.checks) {
    EXPECT_NE(check.name, "distance");
    EXPECT_THAT(check.what, testing::Not(HasSubstr("halves")));
  }
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
}

// Two voxels are thick enough to be edited.
TEST(CheckAll, EditsAVolumeOfTwoVoxels) {
  CheckAllRequest request;
  request.quick = true;
  request.volume = "phantom:random?size=2x9x3";
  const CheckAll all = checkAll(request, kNoStage, kQuiet, kLoad);
  EXPECT_TRUE(allHold(all.checks)) << checkTable(all.checks);
  EXPECT_THAT(all.left_out, testing::IsEmpty());
  EXPECT_EQ(all.checks.back().name, "edits");
  EXPECT_EQ(all.checks[0].compared, 4U * 2 * 9 * 3);  // whole, since no crop was asked for
}

TEST(CheckAll, CanBeCancelledAndRefuses) {
  CheckAllRequest request;
  request.quick = true;
  const auto cancel = [](const std::string&) { throw Error(Error::Code::kCancelled, "x", "y", "z"); };
  EXPECT_THROW((void)checkAll(request, cancel, kQuiet, kLoad), Error);
  request.volume = "nowhere.nrrd";
  EXPECT_THROW((void)checkAll(request, kNoStage, kQuiet, kLoad), Error);
}

}  // namespace check_all_test
}  // namespace palpate
