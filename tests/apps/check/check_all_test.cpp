// SPDX-License-Identifier: Apache-2.0
// All checks on a list of volumes: what the list holds, how scans are cut, and that every promise holds.
#include "apps/check/check_all.hpp"

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
  EXPECT_EQ(stages.size(), checkedVolumes(true).size());
  EXPECT_EQ(last, 1);
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
  const CheckAll all = checkAll(request, kNoStage, kQuiet, kLoad);
  EXPECT_TRUE(allHold(all.checks)) << checkTable(all.checks);
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
}

// A volume with one density has no surface: what needs one is left out, and it is said.
TEST(CheckAll, SaysWhatItLeavesOut) {
  CheckAllRequest request;
  request.quick = true;
  request.volume = "phantom:sphere?size=2";  // eight voxels at one distance from the centre
  const CheckAll all = checkAll(request, kNoStage, kQuiet, kLoad);
  EXPECT_TRUE(allHold(all.checks)) << checkTable(all.checks);
  ASSERT_EQ(all.left_out.size(), 1U);
  EXPECT_THAT(all.left_out[0], HasSubstr("no surface"));
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
