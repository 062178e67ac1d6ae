// SPDX-License-Identifier: Apache-2.0
#include "apps/check/check_page.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace check_page_test {

using testing::HasSubstr;
using testing::Not;

Check checkOf(const std::string& what, const std::string& volume, float gpu) {
  Check check;
  check.name = "filter";
  check.what = what;
  check.volume = volume;
  check.device = "a device";
  check.compare({0, 0, 0}, "density", gpu, 1);
  check.compare({1, 0, 0}, "density", 2, 2);
  return check;
}

const CheckRun kRun{"palpate check all --page p.md", "abc", "a machine", {"/a/folder/x.nrrd: why"}};

TEST(CheckPage, PutsAllVolumesOfAFilterIntoOneRow) {
  const std::vector<Check> checks = {checkOf("gaussian:1.5", "phantom:box", 1),
                                     checkOf("gaussian:2mm", "phantom:knot", 1), checkOf("median:1", "phantom:box", 1)};
  const std::string page = checkPage(checks, kRun);
  EXPECT_THAT(page, HasSubstr("**3 of 3 checks hold.**"));
  EXPECT_THAT(page, HasSubstr("| yes | filter | `gaussian` | 2 | 4 | 0 | 0 |  | 0 differing bits |"));
  EXPECT_THAT(page, HasSubstr("| yes | filter | `median` | 1 | 2 | 0 | 0 |  | 0 differing bits |"));
  for (const char* words :
       {"machine: a machine", "Vulkan device: a device", "commit: abc", "`palpate check all --page p.md`"})
    EXPECT_THAT(page, HasSubstr(words));
}

TEST(CheckPage, TellsWhatDoesNotHold) {
  const std::vector<Check> checks = {checkOf("median:1", "phantom:box", 1), checkOf("median:2", "phantom:box", 3)};
  const std::string page = checkPage(checks, kRun);
  EXPECT_THAT(page, HasSubstr("**1 of 2 checks hold.**"));
  EXPECT_THAT(page, HasSubstr("| **no** | filter | `median` | 1 | 4 | 1 | 1 |"));
}

// A bound and bits are two promises; where bounds hold the reason is told once.
TEST(CheckPage, KeepsPromisesApart) {
  Check bounded;
  bounded.name = "filter";
  bounded.what = "diffuse:1:g=exp";
  bounded.reason = "exponentials";
  bounded.compareWithin({0, 0, 0}, "density", 1.5F, 1, 1);
  const std::vector<Check> checks = {checkOf("diffuse:1", "phantom:box", 1), bounded, bounded};
  const std::string page = checkPage(checks, kRun);
  EXPECT_THAT(page, HasSubstr("| `diffuse` | 1 | 2 | 0 | 0 |  | 0 differing bits |"));
  EXPECT_THAT(page, HasSubstr("| `diffuse` | 1 | 2 | 2 | 0 | 0.5 | a bound of each value's own |"));
  EXPECT_EQ(page.find("\nexponentials\n"), page.rfind("\nexponentials\n"));
}

// A page is for everybody: where files lay on one machine is of no use to others.
TEST(CheckPage, LeavesFoldersOut) {
  const std::string page =
      checkPage(std::vector{checkOf("median:1", "/a/folder/scan.nrrd (its middle 40^3 voxels)", 1)}, kRun);
  EXPECT_THAT(page, HasSubstr("- `scan.nrrd (its middle 40^3 voxels)`"));
  EXPECT_THAT(page, HasSubstr("Left out: x.nrrd: why"));
  EXPECT_THAT(page, Not(HasSubstr("folder")));
}

}  // namespace check_page_test
}  // namespace palpate
