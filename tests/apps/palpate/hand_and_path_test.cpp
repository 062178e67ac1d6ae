// SPDX-License-Identifier: Apache-2.0
// How the tool is moved: by a hand that yields, along a path from a file, by another algorithm.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "trace.hpp"

namespace palpate {
namespace hand_and_path_test {

class HandAndPath : public ProgramTest {
 protected:
  [[nodiscard]] Trace touch(const Words& more) const {
    expectSuccess(run(quickTouch("phantom:sphere?size=24", more)));
    return readTrace(file("out/trace.csv"));
  }
  [[nodiscard]] Trace along(const std::string& path) const {
    expectSuccess(run(quickTouchAlong(path, "phantom:sphere?size=24")));
    return readTrace(file("out/trace.csv"));
  }
  static double deepest(const Trace& trace) {
    double depth_m = 0;
    for (const TraceRow& row : trace.rows) depth_m = std::max(depth_m, (row.vhip_W() - row.hip_W()).norm());
    return depth_m;
  }
  static double medianDepth(const Trace& trace) {
    std::vector<double> depths_m;
    for (const TraceRow& row : trace.rows) {
      if (row.inContact()) depths_m.push_back((row.vhip_W() - row.hip_W()).norm());
    }
    if (depths_m.empty()) return 0;
    std::nth_element(depths_m.begin(), depths_m.begin() + static_cast<long>(depths_m.size() / 2), depths_m.end());
    return depths_m[depths_m.size() / 2];
  }
};

// Path 2 mm deep: a rigid hand goes there. A spring hand of 400 N/m against 500 N/m of contact comes to rest where
// 400 (2 mm - d) = 500 d, d = 0.889 mm. Slow enough that the masses and the hand's damping matter little: at 12 mm/s, 3
// N s/m move it by 0.09 mm.
TEST_F(HandAndPath, SpringHandFeelsTheForceAndYields) {
  const Words slow = {"touch",     "phantom:sphere?size=24",
                      "--depth",   "2",
                      "--seconds", "3",
                      "--clock",   "simulated",
                      "--picture", "off",
                      "--out",     "out"};
  expectSuccess(run(slow));
  EXPECT_NEAR(medianDepth(readTrace(file("out/trace.csv"))), 2e-3, 0.1e-3);
  expectSuccess(run(slow + Words{"--hand", "spring"}));
  EXPECT_NEAR(medianDepth(readTrace(file("out/trace.csv"))), 0.889e-3, 0.1e-3);
}

TEST_F(HandAndPath, StifferContactIsPressedLessDeep) {
  const Words hand = {"--depth", "2", "--hand", "spring"};
  EXPECT_LT(deepest(touch(hand + Words{"--stiffness", "2000"})), deepest(touch(hand + Words{"--stiffness", "200"})));
}

// The device of a rigid hand is exactly where the file says, between its rows too when these lie on a straight line.
TEST_F(HandAndPath, PathFileIsFollowed) {
  write("way.csv", "time_s,x_m,y_m,z_m\n5,0,0,0.02\n5.1,0,0,0.01\n5.2,0,0,0\n");
  const Trace trace = along("way.csv");
  ASSERT_EQ(trace.rows.size(), 200U);  // the path's 0.2 s at 1 kHz; it begins at its first row
  for (const TraceRow& row : trace.rows) {
    EXPECT_NEAR(row.hip_W().x(), 0, 1e-15);
    EXPECT_NEAR(row.hip_W().z(), 0.02 - 0.1 * row.time_s(), 1e-12) << row.time_s();
  }
  EXPECT_FALSE(trace.rows.front().inContact());
  EXPECT_TRUE(trace.rows.back().inContact());
}

TEST_F(HandAndPath, PathFileWithWindowsLineEnds) {
  write("way.csv", "time_s,x_m,y_m,z_m\r\n0,0,0,0.02\r\n0.1,0,0,0.01\r\n");
  EXPECT_EQ(along("way.csv").rows.size(), 100U);
}

// Excel writes a byte order mark in front of a CSV file in UTF-8.
TEST_F(HandAndPath, PathFileWithAByteOrderMark) {
  write("way.csv", "\xEF\xBB\xBFtime_s,x_m,y_m,z_m\r\n0,0,0,0.02\r\n0.1,0,0,0.01\r\n");
  EXPECT_EQ(along("way.csv").rows.size(), 100U);
}

// The 0.3 s of --seconds count for nothing, which is told: where the scene names the file too.
TEST_F(HandAndPath, SecondsHaveNoEffectWithAPathFile) {
  write("way.csv", "time_s,x_m,y_m,z_m\n0,0,0,0.02\n0.1,0,0,0.01\n");
  write("s.toml", "volume = 'phantom:sphere?size=24'\npath.file = 'way.csv'\n");
  for (const Words& words : {quickTouch("phantom:sphere?size=24", {"--path", "way.csv"}), quickTouch("s.toml")}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(errorLines(outcome.err),
                testing::ElementsAre(
                    "palpate: --seconds has no effect: the run is as long as the path of --path, or the recording"));
    EXPECT_EQ(readTrace(file("out/trace.csv")).rows.size(), 100U);
  }
}

TEST_F(HandAndPath, ThePapersAlgorithmRuns) {
  const Trace trace = touch({"--algorithm", "hri-paper", "--n", "1"});
  ASSERT_EQ(trace.rows.size(), 300U);
  EXPECT_NEAR(deepest(trace), 1e-3, 0.2e-3);  // the path's default depth
}

// The engine renews the window only after its box has moved by several voxels; where the volume's border stops the box,
// the tool then runs out of the old one. Disabled until engine/service renews it there.
TEST_F(HandAndPath, WindowFollowsTheToolToTheBorder) {
  // Beside the ball, from 19 to 0 voxels before the border: the first window begins 3 voxels from it.
  write("way.csv", "time_s,x_m,y_m,z_m\n0,0,-0.005,0.0195\n0.1,0,-0.015,0.0195\n0.2,0,-0.025,0.0195\n");
  expectSuccess(run({"touch", "phantom:sphere?size=48", "--path", "way.csv", "--clock", "simulated", "--picture", "off",
                     "--out", "out"}));
  for (const TraceRow& row : readTrace(file("out/trace.csv")).rows) EXPECT_EQ(row.faults(), 0) << row.tick();
}

// World frame: the tool comes from where it was asked to, which is not against the normal here, and starts where asked
// to.
TEST_F(HandAndPath, DirectionAndStartAreKept) {
  const Trace trace = touch({"--toward", "-1,-1,0", "--start", "9,0,0", "--approach", "5"});
  const Vec3 way_W = (trace.rows[30].hip_W() - trace.rows[0].hip_W()).normalized();
  EXPECT_NEAR((way_W - Vec3(-1, -1, 0).normalized()).norm(), 0, 1e-6);
  EXPECT_NEAR(trace.rows[45].hip_W().y(), 0, 1e-4);  // the approach ends after 15 % of 300 ticks, at the start
  EXPECT_NEAR(trace.rows[45].hip_W().z(), 0, 1e-4);
}

// The run goes on, and the user knows that it is not the one that was meant.
TEST_F(HandAndPath, FlagsThatNothingUsesAreTold) {
  const Outcome outcome = run({"touch", "phantom:sphere?size=16", "--seconds", "0.3", "--clock", "simulated",
                               "--picture", "off", "--out", "out", "--hand-mass", "0.2", "--texture-amplitude", "0.1"});
  EXPECT_EQ(outcome.status, 0);
  const Words told = errorLines(outcome.err);
  ASSERT_EQ(told.size(), 2U) << outcome.err;
  EXPECT_THAT(told[0], testing::StartsWith("palpate: --texture-amplitude has no effect: "));
  EXPECT_THAT(told[1], testing::StartsWith("palpate: --hand-mass has no effect: "));
}

class Recorded : public ProgramTest {};

TEST_F(Recorded, ASimulatedSessionIsPlayedBackBitForBit) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--hand", "spring", "--record", "s.rec"})));
  const std::string trace = contentsOf(file("out") / "trace.csv");
  expectSuccess(run({"touch", "phantom:sphere?size=24", "--device", "recorded", "--recording", "s.rec", "--clock",
                     "simulated", "--picture", "off", "--out", "again"}));
  EXPECT_EQ(contentsOf(file("again") / "trace.csv"), trace);
}

// The session's contact comes with it; what is given goes first.
TEST_F(Recorded, IsFeltWithTheStiffnessOfTheSession) {
  expectSuccess(
      run(quickTouch("phantom:sphere?size=24", {"--stiffness", "321", "--damping", "0.25", "--record", "s.rec"})));
  const auto felt = [&](const Words& more) {
    expectSuccess(run(Words{"touch", "phantom:sphere?size=24", "--device", "recorded", "--recording", "s.rec",
                            "--clock", "simulated", "--picture", "off", "--out", "again"} +
                      more));
    const auto servo = nlohmann::json::parse(contentsOf(file("again") / "summary.json"))["scene"]["servo"];
    return std::pair<double, double>(servo["stiffness_N_per_m"], servo["damping_Ns_per_m"]);
  };
  EXPECT_EQ(felt({}), std::pair(321.0, 0.25));
  EXPECT_EQ(felt({"--stiffness", "200"}), std::pair(200.0, 0.25));
  EXPECT_EQ(felt({"--damping", "1"}), std::pair(321.0, 1.0));
}

// A recording takes the place of an earlier one and of nothing else: no other result of the run, no file of the user's.
TEST_F(Recorded, ReplacesRecordingsOnly) {
  const std::string sphere = "phantom:sphere?size=16";
  const auto refused = [&](const Words& more, const std::string& words) {
    const Outcome outcome = run(quickTouch(sphere, more));
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(words));
  };
  refused({"--edit", "remove:radius=1mm", "--save", "s.vdb", "--record", "s.vdb"}, "named for two of the outputs");
  for (const char* result : {"summary.json", "report.html", "trace.csv", "view.png"})
    refused({"--record", std::string("out/") + result}, "named for two of the outputs");
  write("precious.txt", "mine");
  refused({"--record", "precious.txt"}, "precious.txt: it is there, and is no recording");
  EXPECT_EQ(contentsOf(file("precious.txt")), "mine");
  EXPECT_FALSE(exists("s.vdb"));
  write("s.rec", "");  // as mktemp(1) makes it
  expectSuccess(run(quickTouch(sphere, {"--record", "s.rec"})));
  EXPECT_GT(std::filesystem::file_size(file("s.rec")), 0U);
  expectSuccess(run(quickTouch(sphere, {"--record", "s.rec"})));
}

// One bit, in the middle: what is before is played, and it is told how much that is.
TEST_F(Recorded, SaysThatItIsDamaged) {
  expectSuccess(run({"touch", "phantom:sphere?size=16", "--seconds", "2", "--clock", "simulated", "--picture", "off",
                     "--out", "out", "--record", "s.rec"}));
  std::string bytes = contentsOf(file("s.rec"));
  bytes[bytes.size() * 6 / 10] ^= 4;
  write("damaged.rec", bytes);
  const Outcome played = run({"touch", "phantom:sphere?size=16", "--device", "recorded", "--recording", "damaged.rec",
                              "--clock", "simulated", "--picture", "off", "--out", "again"});
  EXPECT_EQ(played.status, 0) << played.err;
  EXPECT_THAT(played.out, testing::ContainsRegex("the recording damaged.rec is damaged: block [0-9]+ of 256 ticks, at "
                                                 "byte [0-9]+, is damaged; the 1\\.[0-9] s before that are played"));
  const auto notes = nlohmann::json::parse(contentsOf(file("again") / "summary.json"))["notes"];
  EXPECT_THAT(notes.dump(), testing::HasSubstr("damaged.rec is damaged"));
}

TEST_F(Recorded, RefusesWhatCannotBePlayed) {
  const Words touch = {"touch", "phantom:sphere?size=16", "--device", "recorded"};
  expectRefusal(run(touch), "--device recorded", "no recording is given", 2);
  expectRefusal(run(touch + Words{"--recording", "none.rec"}), "none.rec", "cannot be opened", 3);
  expectRefusal(run(touch + Words{"--recording", "."}), ".", "the recording is no plain file", 2);
  expectRefusal(run(touch + Words{"--recording", "/dev/zero"}), "/dev/zero", "the recording is no plain file", 2);
  write("text.rec", "no recording");
  expectRefusal(run(touch + Words{"--recording", "text.rec"}), "text.rec", "it is no recording of a device", 2);
  expectSuccess(run(quickTouch("phantom:sphere?size=16", {"--record", "s.rec"})));
  expectRefusal(run(touch + Words{"--recording", "s.rec", "--rate", "500"}), "device recorded",
                "it was recorded at 1000 Hz, and the servo runs at 500 Hz", 2);
  const std::string bytes = contentsOf(file("s.rec"));
  expectRefusal(run(touch + Words{"--recording", "s.rec", "--record", "s.rec"}), "s.rec", "it would be overwritten", 2);
  EXPECT_EQ(contentsOf(file("s.rec")), bytes);
  expectRefusal(run(quickTouch("phantom:sphere?size=16", {"--record", "none/s.rec"})), "none/s.rec", "", 4);
}

}  // namespace hand_and_path_test
}  // namespace palpate
