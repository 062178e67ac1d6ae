// SPDX-License-Identifier: Apache-2.0
// The job in this process. As a user has it, and against the twin: tests/apps/palpate/edit_verb_test.cpp.
#include "apps/edit/edit_job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "temporary_folder.hpp"
#include "tests/support/progress_words.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace edit_job_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr const char* kVolume = "phantom:sphere?size=32";  // radius some 10 mm, 1 mm voxels

class EditJob : public testing::Test {
 protected:
  EditJob() {
    request_.in = kVolume;
    request_.out = name("out.nrrd");
  }
  [[nodiscard]] std::string name(const char* file) const { return (folder_.path() / file).string(); }
  EditResult edit() {
    ProgressWords words;
    told_.clear();
    EditResult result;
    try {
      result = editVolume(request_, words.progress(), [this](const std::string& text) { told_.push_back(text); });
    } catch (...) {
      stages_ = words.stages();
      throw;
    }
    stages_ = words.stages();
    return result;
  }
  [[nodiscard]] std::string refusal() {
    return refusalOf([this] { static_cast<void>(edit()); });
  }
  TemporaryFolder folder_;
  EditRequest request_;
  std::vector<std::string> told_, stages_;
};

std::size_t changedBricks(const Volume& a, const Volume& b) {
  std::size_t count = 0;
  const Vec3i bricks = a.size() / 8;
  for (int n = 0; n < bricks.prod(); ++n) {
    const Vec3i first = 8 * Vec3i(n % bricks.x(), n / bricks.x() % bricks.y(), n / bricks.x() / bricks.y());
    bool same = true;
    for (int i = 0; i < 512; ++i) {
      const Vec3i voxel = first + Vec3i(i % 8, i / 8 % 8, i / 64);
      same = same && a.value(voxel) == b.value(voxel);
    }
    count += same ? 0 : 1;
  }
  return count;
}

TEST_F(EditJob, TellsWhatItDid) {
  request_.commands = {"remove:radius=5mm:at=6,0,0",
                       "undo",
                       "redo",
                       "redo",
                       "remove:radius=2:at=14,14,14",
                       "remove:radius=1um:at=9.7,0,0",
                       "add:radius=2:at=0,11,0"};
  request_.keep_going = true;
  request_.journal = name("journal");
  const EditResult result = edit();
  EXPECT_THAT(told_, ElementsAre("--do 'redo': redo: nothing was undone; undo an edit first (left out)",
                                 "--do 'remove:radius=2:at=14,14,14': it changed nothing: no density is in its reach "
                                 "that it would change; 'palpate info' says where the volume lies (mm)",
                                 StartsWith("--do 'remove:radius=1um:at=9.7,0,0': its radius of 0.001 mm is below")));
  EXPECT_THAT(stages_, ElementsAre(std::string("loading ") + kVolume + " ...", "computing on Vulkan ...",
                                   "applying the edits ...", "reading back ...", "writing " + request_.out + " ..."));
  EXPECT_EQ(result.edits, 4U);
  EXPECT_EQ(result.undone, 1U);
  EXPECT_EQ(result.redone, 1U);
  EXPECT_EQ(result.refused, 1U);
  EXPECT_EQ(result.idle, 1U);
  EXPECT_EQ(result.edit_ms.count, 6U);
  EXPECT_GT(result.edit_ms.p50, 0);
  EXPECT_LE(result.edit_ms.max, 1e3 * result.seconds);
  EXPECT_EQ(result.history_steps, 4U);
  EXPECT_EQ(result.history_forgotten, 0U);
  EXPECT_GT(result.history_bytes, 0U);
  EXPECT_EQ(result.journal_records, 6U);
  EXPECT_EQ(result.journal_saved, 6U);
  EXPECT_EQ(result.journal_bytes, std::filesystem::file_size(request_.journal + "/journal.palpate"));
  EXPECT_GT(result.gpu_budgeted_bytes, 0U);
  EXPECT_GT(result.gpu_bytes, result.gpu_budgeted_bytes);
  EXPECT_FALSE(result.gpu.empty());
  EXPECT_EQ(result.isovalue, 0);
  const Volume before = loadVolume(kVolume), after = loadVolume(request_.out);
  EXPECT_EQ(result.content, contentHash(after));
  EXPECT_EQ(result.changed_bricks, changedBricks(before, after));
  EXPECT_GT(result.changed_bricks, 0U);
  EXPECT_EQ(result.file.bytes, std::filesystem::file_size(request_.out));
  EXPECT_EQ(result.file.size, Vec3i(32, 32, 32));
}

TEST_F(EditJob, EndsAtARefusalAndSaysWhatBecomesOfTheRest) {
  request_.commands = {"remove:radius=5mm:at=6,0,0", "redo"};
  const std::string why = "--do 'redo': redo: nothing was undone; undo an edit first; " + request_.out;
  EXPECT_EQ(refusal(), why + " was not written, 1 command had been applied");
  request_.journal = name("journal");
  EXPECT_EQ(refusal(), why + " was not written, 1 command had been applied and the journal " + request_.journal +
                           " holds them: see 'palpate recover'");
  // One without a record is not left in the way of the next try.
  request_.journal = name("other");
  request_.commands = {"redo"};
  EXPECT_EQ(refusal(), why + " was not written, 0 commands had been applied");
  EXPECT_FALSE(std::filesystem::exists(request_.journal + "/journal.palpate"));
  EXPECT_FALSE(std::filesystem::exists(request_.out));
}

// A stroke has many pieces.
TEST_F(EditJob, TellsOnceThatABrushIsFine) {
  request_.commands = {"remove:radius=1um:at=9.7,0,0", "add:radius=2um:at=9.7,0,0"};
  static_cast<void>(edit());
  EXPECT_EQ(std::count_if(told_.begin(), told_.end(),
                          [](const std::string& words) { return words.find("its radius of") != std::string::npos; }),
            1);
  ASSERT_FALSE(told_.empty());
  EXPECT_THAT(told_[0], StartsWith("--do 'remove:radius=1um:at=9.7,0,0': its radius of 0.001 mm is below"));
}

// Of many the first ten are told, and that there are more.
TEST_F(EditJob, CountsIdleEditsAndTellsTen) {
  request_.commands.assign(12, "remove:radius=2:at=14,14,14");
  request_.history_bytes = 0;
  const EditResult result = edit();
  EXPECT_EQ(result.idle, 12U);
  EXPECT_EQ(result.history_steps, 0U);
  EXPECT_EQ(result.changed_bricks, 0U);
  ASSERT_EQ(told_.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_THAT(told_[i], testing::EndsWith(i < 9 ? "; 'palpate info' says where the volume lies (mm)"
                                                  : "; others like it are counted and no longer told"));
  }
}

// A script of nothing copies the volume; refused lines are something.
TEST_F(EditJob, AnEmptyScriptIsTold) {
  request_.script = name("a.txt");
  std::ofstream(request_.script) << "# nothing\n";
  const EditResult result = edit();
  EXPECT_EQ(result.content, contentHash(loadVolume(kVolume)));
  EXPECT_EQ(result.edit_ms.count, 0U);
  EXPECT_THAT(told_, ElementsAre(request_.script + ": it has no command, so there was nothing to do; " + request_.out +
                                 " holds the volume as it was"));
  std::ofstream(request_.script) << "nonsense\n";
  request_.keep_going = true;
  EXPECT_EQ(edit().refused, 1U);
  EXPECT_THAT(told_, ElementsAre(StartsWith(request_.script + " line 1 'nonsense': ")));
}

// The isovalue asked for is kept where the format can, and a mesh is taken at it.
TEST_F(EditJob, TakesTheIsovalueThatIsAskedFor) {
  request_.commands = {"remove:radius=5mm:at=6,0,0"};
  request_.isovalue = 150;
  request_.out = name("out.vdb");
  EXPECT_EQ(edit().isovalue, 150);
  EXPECT_EQ(loadVolume(request_.out).facts().kept_isovalue, 150);
  request_.out = name("out.stl");
  const EditResult mesh = edit();
  EXPECT_TRUE(mesh.file.is_mesh);
  EXPECT_EQ(mesh.file.isovalue, 150);
  EXPECT_GT(mesh.file.triangles, 100U);
}

// Before anything takes long: no volume is loaded.
TEST_F(EditJob, RefusesEarly) {
  EXPECT_EQ(refusal(),
            "palpate edit: "
            "there is nothing to do; give --do COMMAND, for example --do remove:radius=2mm:at=0,0,0, or --script FILE");
  request_.commands = {"undo", "remove:radius=0mm:at=6,0,0"};
  EXPECT_THAT(refusal(), StartsWith("--do 'remove:radius=0mm:at=6,0,0'"));
  request_.commands = {"undo"};
  request_.script = name("a.nrrd");
  std::ofstream(request_.script) << "undo\n";
  request_.json = request_.script;
  EXPECT_THAT(refusal(), HasSubstr("it is the input"));
  request_.json = "";
  request_.out = request_.script;
  EXPECT_THAT(refusal(), HasSubstr("it is the input"));
  EXPECT_THAT(stages_, IsEmpty());
  EXPECT_EQ(contentsOf(request_.script), "undo\n");
}

TEST_F(EditJob, NeverReplacesAStampsMesh) {
  const std::string mesh = name("tet.obj");
  std::ofstream(mesh) << "v 0 0 0\nv 6 0 0\nv 0 6 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  request_.commands = {"stamp-add:mesh=" + mesh + ":at=8,0,0:mirror=x"};
  const EditResult stamped = edit();
  EXPECT_EQ(stamped.edits, 1U);
  EXPECT_EQ(stamped.idle, 0U);
  request_.json = mesh;
  EXPECT_THAT(refusal(), HasSubstr("it is the input"));
  request_.keep_going = true;
  EXPECT_THAT(refusal(), HasSubstr("it is the input"));
}

}  // namespace edit_job_test
}  // namespace palpate
