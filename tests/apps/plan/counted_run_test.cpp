// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/counted_run.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "counting_program.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace counted_run_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;

Scene bareTouch() {
  Scene scene;
  scene.volume = "phantom:sphere";
  return scene;
}

TEST(CountedRun, ReadsWhatTheRunCounted) {
  const CountingProgram program;
  Scene scene = bareTouch();
  scene.filter = "gaussian:1";
  scene.friction_static = 0.5;
  const RunCounts counts = countedRun(scene, program.folder(), program.path());
  ASSERT_EQ(counts.gpu.kernels.size(), 3U);
  EXPECT_EQ(counts.gpu.kernels[1].name, "gradient");
  EXPECT_THAT(counts.gpu.kernels[1].constants, ElementsAre(Pair("kHalf", 0U), Pair("kRun", 8U)));
  EXPECT_DOUBLE_EQ(counts.gpu.kernels[0].made_s, 2.5e-3);
  EXPECT_EQ(counts.dispatches(), 12U);
  ASSERT_EQ(counts.gpu.buffers.size(), 1U);
  EXPECT_EQ(counts.gpu.buffers[0].name, "window slot");
  EXPECT_EQ(counts.gpu.buffers[0].count, 3U);
  EXPECT_EQ(counts.gpu.buffers[0].bytes, 900U);
  EXPECT_EQ(counts.gpu.submissions, 6U);
  EXPECT_EQ(counts.gpu.peak_bytes, 1500U);
  EXPECT_THAT(counts.threads, ElementsAre("palpate", "engine"));
  EXPECT_THAT(counts.libraries, ElementsAre("openvdb.so", "libc.so.6", "libcairo.so.2"));
  EXPECT_THAT(counts.plan, ElementsAre("done: this"));
  EXPECT_EQ(counts.effect_runs, 7);
  EXPECT_EQ(counts.start_ms, 21);
  EXPECT_EQ(counts.tick_us, 3);
  EXPECT_EQ(counts.main_bytes, 3145728U);
  ASSERT_EQ(counts.stages.size(), 1U);
  EXPECT_EQ(counts.stages[0].seconds, 0.25);
  EXPECT_GT(counts.wall_ms, 0);
}

// Nothing of the user's is written, and an earlier run's journal goes: a journal is never written twice.
TEST(CountedRun, WritesIntoItsFolderAlone) {
  const CountingProgram program;
  Scene scene = bareTouch();
  scene.edit = "remove:radius=2mm";
  scene.journal = "/home/someone/journal";
  scene.save = "/home/someone/sculpted.vdb";
  scene.out = "/home/someone/out";
  scene.simulated_clock = true;
  scene.require_real_time = true;
  scene.duration_s = 100;
  std::filesystem::create_directories(program.folder() / "journal");
  std::ofstream(program.folder() / "journal" / "old") << "old";
  std::ofstream(program.folder() / "saved.vdb") << "old";
  scene.device = "another";
  (void)countedRun(scene, program.folder(), program.path());
  EXPECT_FALSE(std::filesystem::exists(program.folder() / "journal"));
  EXPECT_FALSE(std::filesystem::exists(program.folder() / "saved.vdb"));
  ASSERT_EQ(program.called().size(), 1U);
  const std::string words = program.called()[0];
  EXPECT_THAT(words, Not(HasSubstr("/home/someone")));
  for (const char* part : {"touch ", "seconds = 0.2", "journal = ", "save = ", "brush = \"remove:radius=2mm\""})
    EXPECT_THAT(words, HasSubstr(part));
  EXPECT_THAT(words, Not(HasSubstr("another")));  // the device
  EXPECT_THAT(words, Not(HasSubstr("simulated")));
  EXPECT_THAT(words, Not(HasSubstr("require_real_time")));
}

// What a volume's name holds already is not said twice.
TEST(CountedRun, ShortPathsAreKeptAndLongOnesAreNot) {
  const CountingProgram program;
  std::filesystem::create_directories(program.folder());
  const auto pathOf = [&](double end_s) {
    const std::filesystem::path file = program.folder() / "way.csv";
    std::ofstream(file) << "time_s,x_m,y_m,z_m\n1,0,0,0\n" << 1 + end_s << ",0,0,1\n";
    Scene scene = bareTouch();
    scene.path_file = file.string();
    scene.nan = "0";
    scene.series = "2";
    return shortRun(scene, program.folder());
  };
  EXPECT_NE(pathOf(1.9).path_file, "");
  EXPECT_EQ(pathOf(2.1).path_file, "");
  EXPECT_EQ(pathOf(1).nan, "");
  EXPECT_EQ(pathOf(1).series, "");
}

TEST(CountedRun, TellsWhyTheProgramRefused) {
  const CountingProgram program;
  Scene scene = bareTouch();
  scene.texture = "density";
  const std::string message =
      refusalOf([&] { (void)countedRun(scene, program.folder(), program.path()); }, Error::Code::kBadInput);
  EXPECT_THAT(message, HasSubstr("phantom:sphere: the run that should be counted failed: texture: too rough; sand it"));
  // A crash is no refusal, and its last message no reason.
  const std::filesystem::path crashing = program.folder() / "crashing";
  std::ofstream(crashing) << "#!/bin/sh\necho 'palpate: loading ...' >&2\nkill -SEGV $$\n";
  std::filesystem::permissions(crashing, std::filesystem::perms::owner_all);
  EXPECT_THAT(refusalOf([&] { (void)countedRun(scene, program.folder(), crashing); }, Error::Code::kDevice),
              HasSubstr("failed: it was ended by signal 11; this is a fault of Palpate"));
  std::ofstream(crashing) << "#!/bin/sh\necho 'palpate: a: no room; make some' >&2\nexit 5\n";
  EXPECT_THAT(refusalOf([&] { (void)countedRun(scene, program.folder(), crashing); }, Error::Code::kOutOfMemory),
              HasSubstr("failed: a: no room; make some"));
  EXPECT_THAT(refusalOf([&] { (void)countedRun(scene, program.folder(), "/no/such/program"); }, Error::Code::kIo),
              HasSubstr("no process"));
}

}  // namespace counted_run_test
}  // namespace palpate
