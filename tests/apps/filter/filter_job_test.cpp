// SPDX-License-Identifier: Apache-2.0
// `palpate filter`: its file, read back, against the twin; what it refuses, and that an older file stays then.
#include "apps/filter/filter_job.hpp"

#include <csignal>
#include <cstdio>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "apps/console/interrupt.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/reference/filter.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace filter_job_test {

using ::testing::HasSubstr;
constexpr const char* kKnot = "phantom:knot?size=21x17x19&spacing=0.5x0.7x0.8mm&noise=0.05";

class FilterFile : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  static void expectRefused(const FilterRequest& request, Error::Code code, const std::string& words) {
    Progress progress;
    try {
      (void)filterFile(request, progress);
      ADD_FAILURE() << "no error, wanted: " << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }
  std::string savedKnot(const std::string& name) {
    (void)saveVolume(loadVolume(kKnot), file(name));
    return file(name);
  }

  TemporaryFolder folder_;
};

// .vdb and .nrrd keep floats as they are.
TEST_F(FilterFile, HoldsWhatTheTwinMakes) {
  const Volume volume = loadVolume(kKnot);
  for (const char* out : {"out.vdb", "out.nrrd"}) {
    Progress progress;
    const FilterRequest request{kKnot, file(out), "median:1 gaussian:0.8mm distance:3", "", 10.0};
    const FilterResult result = filterFile(request, progress);
    const auto steps = lowerFilters(filterChain(request.filter), volume.lattice().spacing_m, 10.0F);
    EXPECT_EQ(loadVolume(file(out)).toDense(), reference::applyFilters(reference::denseField(volume), steps).values);
    EXPECT_EQ(result.bytes, std::filesystem::file_size(file(out)));
    EXPECT_EQ(result.steps, steps.size());
    EXPECT_EQ(result.surface, 0);
  }
}

// Its voxels are 0 and 1, and what a filter makes of them is between: the surface stays half-way, as `palpate touch`
// takes it of the mask with the same filter. Of a scan nobody knows it.
TEST_F(FilterFile, AMaskKeepsItsSurface) {
  std::vector<float> values = loadVolume("phantom:sphere?size=24").toDense();
  for (float& value : values) value = value > 4 ? 1 : 0;  // small, so that the object is few of the voxels
  (void)saveVolume(Volume::fromDense(Vec3i::Constant(24), {}, values, {}), file("mask.nrrd"));
  Progress progress;
  const FilterResult result = filterFile({file("mask.nrrd"), file("out.vdb"), "gaussian:1.5", "", {}}, progress);
  EXPECT_EQ(result.surface, 0.5);
  EXPECT_EQ(defaultIsovalue(loadVolume(file("out.vdb"))), 0.5);
  values[5] = 0.3F;
  (void)saveVolume(Volume::fromDense(Vec3i::Constant(24), {}, values, {}), file("scan.nrrd"));
  EXPECT_FALSE(filterFile({file("scan.nrrd"), file("out.vdb"), "gaussian:1.5", "", {}}, progress).surface);
  std::fill(values.begin(), values.end(), 2.0F);
  (void)saveVolume(Volume::fromDense(Vec3i::Constant(24), {}, values, {}), file("even.nrrd"));
  EXPECT_FALSE(filterFile({file("even.nrrd"), file("out.vdb"), "gaussian:1.5", "", {}}, progress).surface);
}

// Each figure of the result against what is in the file, and the words that tell them.
TEST_F(FilterFile, TellsWhatItMade) {
  Progress progress;
  const FilterRequest request{kKnot, file("out.vdb"), "gaussian:1.2", ""};
  const FilterResult result = filterFile(request, progress);
  const Volume before = loadVolume(kKnot), after = loadVolume(file("out.vdb"));
  EXPECT_EQ(result.size, before.size());
  EXPECT_EQ(result.lowest, after.minimum());
  EXPECT_EQ(result.highest, after.maximum());
  EXPECT_NE(result.lowest, before.minimum());
  EXPECT_EQ(result.reach, totalReach(lowerFilters(filterChain(request.filter), before.lattice().spacing_m)));
  EXPECT_NE(result.device, "");
  EXPECT_EQ(result.bricks, 27U);
  EXPECT_EQ(result.stored_before, before.storedBricks());
  EXPECT_EQ(result.stored_after, after.storedBricks());
  ASSERT_TRUE(before.facts().declared_isovalue);
  EXPECT_EQ(after.facts().kept_isovalue, before.facts().declared_isovalue);  // a smoothing leaves it where it is
  EXPECT_EQ(result.surface, after.facts().kept_isovalue);
  EXPECT_GT(result.filter_s, 0);
  EXPECT_GE(result.seconds, result.filter_s);
  const std::string words = filterWords(request, result);
  EXPECT_THAT(words, HasSubstr(": 21 x 17 x 19 voxels, densities"));
  EXPECT_THAT(words, HasSubstr(fmt::format(", {}\n", bytesInWords(result.bytes))));
  EXPECT_THAT(words, HasSubstr("27 of 27 bricks stored before and 27 after"));
}

// What a file says of its surface, without noise: sparse, so that bricks are left out, before and after differently.
TEST_F(FilterFile, CountsTheBricksThatAreStored) {
  Progress progress;
  const FilterRequest request{"phantom:sphere?size=96", file("out.vdb"), "gaussian:1.2", ""};
  const FilterResult result = filterFile(request, progress);
  EXPECT_EQ(result.bricks, 1728U);
  EXPECT_EQ(result.stored_before, loadVolume(request.in).storedBricks());
  EXPECT_GT(result.stored_after, result.stored_before);
  EXPECT_LT(result.stored_after, result.bricks);
}

// A stream that is no terminal: each stage has its line.
TEST_F(FilterFile, TellsItsStages) {
  std::FILE* stream = std::tmpfile();
  {
    Progress progress(stream, 0);
    (void)filterFile({kKnot, file("out.vdb"), "median:1", ""}, progress);
  }
  std::rewind(stream);
  std::string text(4096, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), stream));
  std::fclose(stream);
  for (const char* stage : {"loading phantom:knot", "filtering on Vulkan ...", "filtering on Vulkan: 100 % ...",
                            "bringing the result back ...", "writing "})
    EXPECT_THAT(text, HasSubstr(stage));
}

// Every figure another, so that none stands for another.
TEST(FilterWords, TellEveryFigure) {
  FilterResult result;
  result.device = "a device";
  result.size = {21, 22, 23};
  result.steps = 1;
  result.reach = {4, 5, 6};
  result.stored_before = 7;
  result.stored_after = 8;
  result.bricks = 9;
  result.lowest = -1.5F;
  result.highest = 2.5F;
  result.filter_s = 0.125;
  result.seconds = 0.25;
  result.bytes = 1536;
  const FilterRequest request{"in", "out.vdb", "median:1", ""};
  const std::string first = "out.vdb: 21 x 22 x 23 voxels, densities -1.5 to 2.5, 1.5 KiB\na device: ";
  const std::string last = ", 7 of 9 bricks stored before and 8 after; 0.125 s filtering, 0.25 s in all\n";
  EXPECT_EQ(filterWords(request, result), first + "1 pass reaching 4 x 5 x 6 voxels" + last);
  result.steps = 2;
  result.surface = 3;
  EXPECT_EQ(filterWords(request, result),
            first + "2 passes reaching 4 x 5 x 6 voxels" + last + "its surface is at 3, which the file keeps\n");
  result.steps = 0;
  result.surface.reset();
  EXPECT_EQ(filterWords(request, result),
            first + "no pass, since no size reaches a neighbouring voxel: densities are as they were" + last);
}

TEST_F(FilterFile, RefusesWhatItCannotDo) {
  const auto bad = Error::Code::kBadInput;
  expectRefused({kKnot, file("a.png"), "median:1", ""}, bad, "its suffix names no format");
  expectRefused({kKnot, file("a.vdb"), "mean:1", ""}, bad, "mean");
  expectRefused({kKnot, file("a.vdb"), "gaussian:99", ""}, bad, "gaussian");
  expectRefused({kKnot, file("a.vdb"), "distance:3", "", 1e9}, bad, "isovalue");
  expectRefused({kKnot, file("a.vdb"), "median:1", "Voodoo"}, Error::Code::kNotFound, "Voodoo");
  expectRefused({kKnot, file("none/a.vdb"), "median:1", ""}, Error::Code::kIo, "none");
  expectRefused({file("none.nrrd"), file("a.vdb"), "median:1", ""}, Error::Code::kNotFound, "no such file");
  EXPECT_EQ(folder_.files(), 0);
}

// An isovalue that nothing reads was meant for something.
TEST_F(FilterFile, RefusesAnIsovalueWithoutADistance) {
  expectRefused({kKnot, file("a.vdb"), "gaussian:1 median:1", "", 10.0}, Error::Code::kBadInput,
                "--iso: no filter of \"gaussian:1 median:1\" has a use for an isovalue");
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(FilterFile, NeverReplacesItsInput) {
  const std::string in = savedKnot("in.nrrd");
  const std::string before = contentsOf(in);
  std::filesystem::create_hard_link(in, file("b.nrrd"));
  std::filesystem::create_symlink(in, file("c.nrrd"));
  for (const char* out : {"in.nrrd", "b.nrrd", "c.nrrd"}) {
    expectRefused({in, file(out), "median:1", ""}, Error::Code::kBadInput, "it is the input");
  }
  EXPECT_EQ(contentsOf(in), before);
  EXPECT_EQ(folder_.files(), 3);
}

TEST_F(FilterFile, FailedLeavesTheOlderFile) {
  std::ofstream(file("out.vdb")) << "old";
  expectRefused({kKnot, file("out.vdb"), "median:1", "Voodoo"}, Error::Code::kNotFound, "Voodoo");
  EXPECT_EQ(contentsOf(file("out.vdb")), "old");
  EXPECT_EQ(folder_.files(), 1);
}

// Ctrl-C leaves the older file and nothing beside it. Last: the request to stop stays.
TEST_F(FilterFile, ZStoppedLeavesTheOlderFile) {
  std::ofstream(file("out.vdb")) << "old";
  catchInterrupts();
  // A test program that ends slowly is not to be ended by the thread that watches for such ones; so this stays.
  [[maybe_unused]] static const KeptWork& kept = *new KeptWork;
  std::raise(SIGINT);
  expectRefused({kKnot, file("out.vdb"), "median:1", ""}, Error::Code::kCancelled, "palpate filter");
  EXPECT_EQ(contentsOf(file("out.vdb")), "old");
  EXPECT_EQ(folder_.files(), 1);
}

}  // namespace filter_job_test
}  // namespace palpate
