// SPDX-License-Identifier: Apache-2.0
// The job in this process, by the simulated clock: what it returns, what it announces and what it leaves in its folder.
// As a user has it: tests/apps/palpate.
#include "apps/touch/touch_job.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/report/html_report.hpp"
#include "apps/report/summary.hpp"
#include "apps/report/trace_csv.hpp"
#include "apps/scene/object_table.hpp"
#include "apps/touch/object_volume.hpp"
#include "base/stopwatch.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/journal_reader.hpp"
#include "engine/journal/volume_identity.hpp"
#include "temporary_folder.hpp"
#include "tests/support/progress_words.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace touch_job_test {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kVolume = "phantom:sphere?size=32";  // 1 mm voxels, densities from -1000 to 1000, surface at 0

class TouchJob : public testing::Test {
 protected:
  TouchJob() {
    scene_.volume = kVolume;
    scene_.simulated_clock = true;
    scene_.duration_s = 0.5;
    scene_.picture = false;
    scene_.out = file("out");
  }
  [[nodiscard]] std::string file(const char* name) const { return (folder_.path() / name).string(); }
  TouchRun touch() {
    ProgressWords words;
    try {
      TouchRun run = runTouchJob(scene_, "a command", "a commit", words.progress());
      stages_ = words.stages();
      return run;
    } catch (...) {
      stages_ = words.stages();
      throw;
    }
  }
  [[nodiscard]] std::set<std::string> outputs() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(scene_.out)) names.insert(entry.path().filename());
    return names;
  }
  // What is on disk is what was returned.
  void expectFiles(const TouchRun& run) const {
    EXPECT_EQ(contentsOf(scene_.out + "/summary.json"), makeSummary(run).dump(2) + "\n");
    EXPECT_EQ(contentsOf(scene_.out + "/report.html"), makeReport(run, contentsOf(scene_.out + "/view.png")));
  }
  TemporaryFolder folder_;
  Scene scene_;
  std::vector<std::string> stages_;
};

std::vector<std::string> namesOf(const std::vector<StageTime>& stages) {
  std::vector<std::string> names;
  for (const StageTime& stage : stages) names.push_back(stage.name);
  return names;
}

// The volume's own words are a note of the run; with the filter that they name there is none.
TEST_F(TouchJob, TellsThatAMaskIsFeltAsStairs) {
  const Volume ball = loadVolume(kVolume);
  std::vector<float> values = ball.toDense();
  for (float& value : values) value = value > 0 ? 1 : 0;
  saveVolume(Volume::fromDense(ball.size(), ball.lattice(), values, {}), file("mask.nrrd"));
  scene_.volume = file("mask.nrrd");
  scene_.out = file("stairs");
  EXPECT_THAT(touch().notes,
              Contains(HasSubstr("mask.nrrd: it holds 2 values (0, 1), so its surface is felt as stairs")));
  scene_.filter = "gaussian:1.5";
  scene_.out = file("smooth");
  EXPECT_THAT(touch().notes, ::testing::Not(Contains(HasSubstr("stairs"))));
}

TEST_F(TouchJob, TellsAllOfARun) {
  scene_.picture = true;
  scene_.image_width = 480;
  scene_.image_height = 270;
  const Stopwatch watch;
  const TouchRun run = touch();
  const double wall_s = watch.seconds();
  EXPECT_THAT(stages_, ElementsAre(std::string("loading ") + kVolume + " ...", "computing on Vulkan ...",
                                   "building the path ...", "making ready to palpate ...",
                                   "palpating with hri on " + run.vulkan.device + " ...", "assessing what was felt ...",
                                   "drawing ...", "writing " + scene_.out + " ..."));
  EXPECT_EQ(run.command, "a command");
  EXPECT_EQ(run.commit, "a commit");
  EXPECT_GE(run.machine.cores, 1);
  EXPECT_FALSE(run.vulkan.device.empty() || run.vulkan.driver.empty() || run.vulkan.api_version.empty());
  EXPECT_EQ(run.volume.name, kVolume);
  EXPECT_EQ(run.volume.format, "phantom");
  EXPECT_EQ(run.volume.size, Vec3i(32, 32, 32));
  EXPECT_EQ(run.volume.spacing_m, Vec3::Constant(1e-3));
  EXPECT_EQ(run.volume.minimum, -1000);
  EXPECT_EQ(run.volume.maximum, 1000);
  EXPECT_EQ(run.volume.isovalue, 0);
  // What was chosen stands in the scene, so that it can be asked for: for a ball of 22 samples across as path_fit.hpp
  // says.
  EXPECT_EQ(run.scene.isovalue, 0);
  EXPECT_EQ(run.scene.press_depth_m, 1e-3);
  EXPECT_NEAR(run.scene.approach_m.value_or(0), 10e-3, 1e-12);
  EXPECT_NEAR(run.scene.slide_length_m.value_or(0), 0.7 * 22e-3, 1e-9);
  // The engine's stages are taken out of the time that opening it took: together they are no longer than it all was.
  EXPECT_THAT(namesOf(run.stages), ElementsAre("load", "open Vulkan device", "upload", "brick bounds", "gradient",
                                               "window", "path", "servo", "picture"));
  double sum_s = 0;
  for (const StageTime& stage : run.stages) {
    EXPECT_GT(stage.seconds, 0) << stage.name;
    sum_s += stage.seconds;
  }
  EXPECT_LE(sum_s, wall_s);
  EXPECT_THAT(run.plan, Contains("left out: contact effects (the scene names none)"));
  EXPECT_THAT(run.plan, Contains("done: isosurface picture (view.png and report.html show it)"));
  EXPECT_THAT(run.plan, Contains(HasSubstr("(the scene names none: the volume itself is felt); saves 0.1 MiB")));
  EXPECT_THAT(run.realtime, ElementsAre("simulated clock: ticks as fast as they compute, no deadlines"));
  EXPECT_THAT(run.notes, IsEmpty());
  EXPECT_THAT(run.faults, IsEmpty());
  EXPECT_EQ(run.ended_early, "");
  ASSERT_EQ(run.phases.size(), 4U);
  EXPECT_EQ(run.phases.back().end_s, 0.5);
  EXPECT_EQ(run.records.size(), 500U);
  EXPECT_EQ(run.grid_points, 500);
  ASSERT_TRUE(run.figures);
  EXPECT_EQ(run.figures->ticks, 500);
  EXPECT_GT(run.figures->contact_ticks, 300);  // press, slide and some of the retreat: 0.7 of the time
  EXPECT_EQ(run.stability.verdict, ContactVerdict::kQuiet);
  ASSERT_TRUE(run.exact);
  EXPECT_TRUE(run.exact->slide_only);
  EXPECT_LT(run.exact->vhip_p99_voxel.value_or(1), 0.05);
  EXPECT_FALSE(run.edits);
  ASSERT_GE(run.memory.size(), 3U);
  EXPECT_EQ(run.memory[run.memory.size() - 2].name, "volume on the CPU");
  EXPECT_GT(run.memory[run.memory.size() - 2].bytes, 0U);
  EXPECT_EQ(run.memory.back().name, "process peak");
  EXPECT_GT(run.memory.back().bytes, 16U << 20U);
  EXPECT_THAT(run.files, ElementsAre(file("out/view.png"), file("out/report.html"), file("out/summary.json"),
                                     file("out/trace.csv")));
  EXPECT_EQ(outputs(), (std::set<std::string>{"view.png", "report.html", "summary.json", "trace.csv"}));
  expectFiles(run);
  writeTraceCsv(file("again.csv"), run.records);
  EXPECT_EQ(contentsOf(file("out/trace.csv")), contentsOf(file("again.csv")));
}

// A second run into the same folder, which asks for less, leaves no file of the first behind. Its algorithm touches a
// mesh.
TEST_F(TouchJob, LeavesOutWhatIsNotAskedFor) {
  static_cast<void>(touch());
  EXPECT_EQ(outputs(), (std::set<std::string>{"report.html", "summary.json", "trace.csv"}));
  scene_.trace = false;
  scene_.algorithm = "god-object";
  scene_.stiffness_N_per_m = 2000;
  scene_.encoder_resolution_m = 0.2e-3;
  const TouchRun run = touch();
  EXPECT_EQ(outputs(), (std::set<std::string>{"report.html", "summary.json"}));
  EXPECT_THAT(run.files, ElementsAre(file("out/report.html"), file("out/summary.json")));
  EXPECT_THAT(stages_, Contains("extracting the isosurface's mesh ..."));
  EXPECT_THAT(stages_, testing::Not(Contains("drawing ...")));
  EXPECT_THAT(namesOf(run.stages), Contains("isosurface mesh"));
  EXPECT_THAT(run.plan, Contains(testing::MatchesRegex("done: mesh of the isosurface, [0-9]{4} triangles .*")));
  EXPECT_THAT(run.notes, Contains(HasSubstr("each step of the encoders, 0.2 mm, changes the force by 0.4 N")));
  EXPECT_GT(run.figures->contact_ticks, 300);
}

// The filtered field is felt, and the volume is edited, saved and told of.
TEST_F(TouchJob, TellsWhatWasEdited) {
  scene_.filter = "gaussian:1mm";
  scene_.edit = "remove:radius=2mm:rate=20";
  scene_.journal = file("journal");
  scene_.save = file("sculpted.vdb");
  const TouchRun run = touch();
  ASSERT_TRUE(run.edits);
  EXPECT_GT(run.edits->count, 20U);
  EXPECT_EQ(run.edits->published, run.edits->count);
  EXPECT_EQ(run.edits->edit_to_window_ms.size(), run.edits->count);
  EXPECT_EQ(run.edits->refused, 0U);
  EXPECT_EQ(run.edits->saves, 1U);
  EXPECT_EQ(run.edits->save_version, run.edits->count);
  EXPECT_EQ(run.edits->save_bytes, std::filesystem::file_size(scene_.save));
  EXPECT_EQ(run.edits->journal_saved, run.edits->count);
  EXPECT_EQ(readJournal(scene_.journal).last_sequence, run.edits->count);
  const Volume sculpted = loadVolume(scene_.save), original = loadVolume(kVolume);
  EXPECT_EQ(run.edits->content, contentHash(sculpted));
  EXPECT_LT(run.edits->added_m3.value_or(0), 0);
  EXPECT_NEAR(run.edits->added_m3.value_or(0), objectVolume_m3(sculpted, 0) - objectVolume_m3(original, 0), 1e-15);
  EXPECT_EQ(sculpted.facts().kept_isovalue, 0);
  EXPECT_FALSE(run.exact);  // where the tool edits nothing exact is known
  EXPECT_EQ(run.files.back(), scene_.save);
  EXPECT_THAT(stages_, Contains("making edits ready ..."));
  EXPECT_THAT(stages_, Contains("saving " + scene_.save + " ..."));
  EXPECT_THAT(namesOf(run.stages), Contains("edit set-up"));
  EXPECT_THAT(namesOf(run.stages), Contains("filter"));
  expectFiles(run);
}

// A path from a file has its own length and no phases; at another isovalue than the phantom's nothing exact is known.
TEST_F(TouchJob, FollowsAFileAmongObjects) {
  scene_.path_file = file("way.csv");
  std::ofstream(scene_.path_file) << "time_s,x_m,y_m,z_m\n0,0,0,0.02\n0.1,0,0,0.015\n0.2,0,0,0.01\n0.3,0,0,0.005\n";
  scene_.isovalue = 100;
  scene_.objects = {parseObject("sphere:centre=0,0,21:radius=3")};
  const TouchRun run = touch();
  EXPECT_EQ(run.scene.duration_s, 0.3);
  EXPECT_EQ(run.records.size(), 300U);
  EXPECT_EQ(run.volume.isovalue, 100);
  EXPECT_EQ(run.scene.isovalue, 100);
  EXPECT_THAT(run.phases, IsEmpty());
  EXPECT_FALSE(run.scene.press_depth_m || run.scene.slide_length_m || run.scene.approach_m);
  EXPECT_THAT(run.notes, Contains("object 1 (sphere): the tool starts inside it "
                                  "and does not feel it until it has been outside; move it, or the path"));
  EXPECT_EQ(run.object_outlines.size(), 3U);
  EXPECT_THAT(run.plan, Contains("done: 1 object beside the volume (as the scene says)"));
  EXPECT_FALSE(run.exact);
  EXPECT_TRUE(run.records.back().in_contact);
  scene_.objects.clear();
  EXPECT_FALSE(touch().exact);  // the isovalue alone is reason enough
}

// Faults of the command line are told before a volume is loaded.
TEST_F(TouchJob, RefusesEarly) {
  const auto refusal = [this](Error::Code code = Error::Code::kBadInput) {
    const std::string words = refusalOf([this] { static_cast<void>(touch()); }, code);
    EXPECT_THAT(stages_, IsEmpty());
    return words;
  };
  const Scene good = scene_;
  scene_.volume = "";
  EXPECT_EQ(refusal(),
            "palpate touch: "
            "no volume is given; name a file, a DICOM folder or a phantom, for example 'phantom:sphere?size=64'");
  scene_ = good;
  scene_.velocity = "no estimate";
  EXPECT_THAT(refusal(), HasSubstr("no estimate"));
  scene_ = good;
  scene_.friction_dynamic = 0.3;
  EXPECT_THAT(refusal(), HasSubstr("dynamic friction: 0.3"));
  scene_ = good;
  scene_.save = file("a.vdb");
  EXPECT_THAT(refusal(), HasSubstr("nothing is edited"));
  scene_ = good;
  scene_.duration_s = 1e12;
  EXPECT_THAT(refusal(Error::Code::kOutOfMemory), HasSubstr("make it shorter or the rate lower"));
  EXPECT_FALSE(std::filesystem::exists(scene_.out));
  scene_ = good;
  std::filesystem::create_directory(scene_.out);
  std::ofstream(scene_.out + "/report.html") << "mine";
  EXPECT_THAT(refusal(), HasSubstr("it is not a result of palpate"));
  EXPECT_EQ(contentsOf(scene_.out + "/report.html"), "mine");
}

}  // namespace touch_job_test
}  // namespace palpate
