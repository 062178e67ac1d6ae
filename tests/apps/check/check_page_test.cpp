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

// A whole page, written down by hand.
TEST(CheckPage, IsOneRowForEachKindAndPromise) {
  struct Told {
    const char *name, *what, *volume, *reason;
    std::uint64_t compared, differing, broken;
    double share;
  };
  std::vector<Check> checks;
  for (const Told& t : {Told{"filter", "median:1", "phantom:box", "", 10, 1, 0, 0},
                        {"filter", "median:2", "phantom:box", "", 20, 2, 1, 0},
                        {"filter", "median:1 close:1", "/d/b.nrrd", "", 30, 3, 0, 0},
                        {"distance", "median:1", "/d/b.nrrd", "because", 40, 4, 0, 0.75},
                        {"distance", "median:1", "/d/b.nrrd", "because", 50, 5, 0, 0.5},
                        {"filter", "median:1", "phantom:box", "therefore", 60, 6, 0, 0.25}}) {
    Check check;
    check.name = t.name;
    check.what = t.what;
    check.volume = t.volume;
    check.reason = t.reason;
    check.compared = t.compared;
    check.differing = t.differing;
    check.broken = t.broken;
    check.largest_share = t.share;
    check.device = "device of check " + std::to_string(checks.size());
    checks.push_back(check);
  }
  const std::string page = checkPage(checks, {"the command", "abc", "a machine", {"/d/x.nrrd: why", "y"}});
  EXPECT_THAT(page, testing::StartsWith("# What the GPU computes, against the CPU twins\n\n"));
  const std::size_t facts = page.find("- machine: ");
  ASSERT_NE(facts, std::string::npos);
  EXPECT_EQ(
      page.substr(facts),
      "- machine: a machine\n- Vulkan device: device of check 0\n- commit: abc\n- command: `the command`\n\n"
      "**5 of 6 checks hold.**\n\n"
      "| holds | check | of | volumes | values | differing bits | broken | largest share of its bound | promise |\n"
      "|---|---|---|---|---|---|---|---|---|\n"
      "| **no** | filter | `median` | 1 | 30 | 3 | 1 |  | 0 differing bits |\n"
      "| yes | filter | `chain of median:1 close:1` | 1 | 30 | 3 | 0 |  | 0 differing bits |\n"
      "| yes | distance | `median:1` | 1 | 90 | 9 | 0 | 0.75 | a bound of each value's own |\n"
      "| yes | filter | `median` | 1 | 60 | 6 | 0 | 0.25 | a bound of each value's own |\n"
      "\nVolumes:\n\n- `phantom:box`\n- `b.nrrd`\n- `phantom:box`\n"
      "\nbecause\n\ntherefore\n\nLeft out: x.nrrd: why\n\nLeft out: y\n");
  EXPECT_THAT(checkPage({}, kRun), HasSubstr("Vulkan device: none\n"));
}

}  // namespace check_page_test
}  // namespace palpate
