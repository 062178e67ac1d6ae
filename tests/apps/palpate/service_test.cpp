// SPDX-License-Identifier: Apache-2.0
// `palpate touch --service`: the servo in a process of its own. The same trace and recording, bit for bit; small,
// without Vulkan and OpenVDB; and words where it ends before its time.
#include <nlohmann/json.hpp>

#include "program_test.hpp"

namespace palpate {
namespace service_test {

using testing::HasSubstr;
using testing::Not;

class Service : public ProgramTest {
 protected:
  // The trace and the recording of a simulated run, with and without.
  void expectSame(const Words& scene) const {
    const Words touch = Words{"touch"} + scene + Words{"--clock", "simulated", "--picture", "off"};
    expectSuccess(run(touch + Words{"--out", "one", "--record", "one.rec"}));
    expectSuccess(run(touch + Words{"--out", "two", "--record", "two.rec", "--service"}));
    const std::string trace = contentsOf(file("one") / "trace.csv");
    EXPECT_GT(trace.size(), 10'000U);
    EXPECT_TRUE(contentsOf(file("two") / "trace.csv") == trace) << "the traces differ";
    EXPECT_TRUE(contentsOf(file("two.rec")) == contentsOf(file("one.rec"))) << "the recordings differ";
  }
};

TEST_F(Service, FeelsTheSameBitForBit) {
  write("tetrahedron.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  write("way.csv", "time_s,x_m,y_m,z_m\n0,0.013,0,0\n0.2,0.009,0,0\n0.4,0.009,0.002,0\n");
  expectSame({"phantom:knot?size=32&noise=0.02", "--hand", "spring", "--encoder", "0.05", "--seconds", "0.4"});
  expectSame({"phantom:sphere?size=32", "--edit", "remove:radius=1mm", "--friction-static", "0.4", "--texture",
              "density", "--seconds", "0.4"});
  expectSame({"phantom:sphere?size=32", "--algorithm", "god-object", "--seconds", "0.4"});
  expectSame({"phantom:sphere?size=32", "--path", "way.csv", "--filter", "gaussian:1", "--object",
              "mesh:position=0,0,0:file=tetrahedron.obj"});
  std::filesystem::copy_file(file("one.rec"), file("session.rec"));
  expectSame({"phantom:sphere?size=32", "--device", "recorded", "--recording", "session.rec"});
}

// What the loader of the servo's program brings.
TEST_F(Service, TheServoIsSmall) {
  const std::filesystem::path program = std::filesystem::path(PALPATE_PROGRAM).parent_path() / "palpate-servo";
  ASSERT_TRUE(std::filesystem::exists(program));
  EXPECT_LT(std::filesystem::file_size(program), std::filesystem::file_size(PALPATE_PROGRAM) / 3);
  const Outcome outcome = runPalpate({.arguments = {},
                                      .program = program.string(),
                                      .folder = folder(),
                                      .environment = {{"LD_TRACE_LOADED_OBJECTS", "1"}}});
  EXPECT_THAT(outcome.out, HasSubstr("libc.so"));
  for (const char* none : {"vulkan", "openvdb", "ITK", "glfw", "tbb"}) EXPECT_THAT(outcome.out, Not(HasSubstr(none)));
}

TEST_F(Service, IsStartedByAnEngine) {
  const std::filesystem::path program = std::filesystem::path(PALPATE_PROGRAM).parent_path() / "palpate-servo";
  for (const Words& words : {Words{}, Words{"--channel"}, Words{"--chanel", "3"}, Words{"--channel", "3", "4"}}) {
    const Outcome outcome = runPalpate({.arguments = words, .program = program.string(), .folder = folder()});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("palpate servo --connect SOCKET"));
  }
}

TEST_F(Service, RunsByTheRealClock) {
  expectSuccess(run({"touch", "phantom:sphere?size=32", "--seconds", "0.5", "--picture", "off", "--service"}));
  const auto summary = nlohmann::json::parse(contentsOf(file("out") / "summary.json"));
  EXPECT_EQ(summary["scene"]["servo"]["service"], "yes");
  const auto& threads = summary["work"]["threads"].dump();
  EXPECT_THAT(threads, HasSubstr("\"servo link\""));
  EXPECT_THAT(threads, Not(HasSubstr("\"servo\"")));
}

// The servo is killed: the run ends with words, and the edits until then are kept.
TEST_F(Service, AKilledServoIsTold) {
  const std::string touch = std::string(PALPATE_PROGRAM) +
                            " touch 'phantom:sphere?size=32' --seconds 20 --picture off --service --edit "
                            "remove:radius=1mm --journal journal --approach 1";
  // Once some edits are on the disk, of 100 bytes each after a shorter header.
  const std::string waits =
      "n=0; while [ $(stat -c %s journal/journal.palpate || echo 0) -lt 600 ] && [ $((n += 1)) -lt 1200 ]; do sleep "
      "0.05; done 2> /dev/null; ";
  const Outcome outcome =
      runPalpate({.arguments = {"-c", touch + " & run=$!; " + waits +
                                          "pkill -KILL -P $run palpate-servo; wait $run; echo ended $?"},
                  .program = "/bin/sh",
                  .folder = folder()});
  EXPECT_THAT(outcome.out, HasSubstr("ended 6"));
  EXPECT_THAT(outcome.err, HasSubstr("the servo: its process has ended"));
  EXPECT_THAT(outcome.err, HasSubstr("journal"));
  expectSuccess(run({"recover", "journal", "--out", "back.vdb"}));
}

TEST_F(Service, RefusalsAreThoseOfOneProcess) {
  for (const Words& scene : {Words{"--device", "recorded", "--recording", "none.rec"}, Words{"--device", "polhem-v1"},
                             Words{"--object", "mesh:position=0,0,0:file=none.obj"}, Words{"--stiffness", "-1"}}) {
    const Words touch = Words{"touch", "phantom:sphere?size=16", "--picture", "off"} + scene;
    const Outcome one = run(touch), two = run(touch + Words{"--service"});
    EXPECT_NE(one.status, 0);
    EXPECT_EQ(two.status, one.status);
    EXPECT_EQ(two.err, one.err);
  }
}

}  // namespace service_test
}  // namespace palpate
