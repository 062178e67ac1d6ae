// SPDX-License-Identifier: Apache-2.0
// A path file that cannot be followed: one line that names the file (and line), the reason and the remedy; no output.
#include <sys/stat.h>

#include "program_test.hpp"

namespace palpate {
namespace refused_path_test {

struct BadPath {
  const char* name;
  const char* text;
  const char* input;
  const char* reason;
  int status = 2;
};

const std::string kHeader = "time_s,x_m,y_m,z_m\n";

const BadPath kBadPaths[] = {
    {"Empty", "", "way.csv", "empty"},
    {"OtherHeader", "t,x,y,z\n0,0,0,0\n1,0,0,0\n", "way.csv, line 1", "header"},
    {"MillimetreHeader", "time_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,0,0,0\n", "way.csv, line 1", "header"},
    {"NoRow", "time_s,x_m,y_m,z_m\n", "way.csv", "two rows"},
    {"OneRow", "time_s,x_m,y_m,z_m\n0,0,0,0\n", "way.csv", "two rows"},
    {"ThreeNumbers", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0,0\n", "way.csv, line 3", "four numbers"},
    {"FiveNumbers", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0,0,0,0\n", "way.csv, line 3", "four numbers"},
    {"Word", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,left,0,0\n", "way.csv, line 3", "left"},
    {"Nan", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,nan,0,0\n", "way.csv, line 3", "nan"},
    {"Infinity", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,inf,0,0\n", "way.csv, line 3", "inf"},
    {"Hole", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.01,0,0,0\n0.02,0,0,0\n0.03,0,0,0\n0.5,0,0,0\n0.51,0,0,0\n",
     "way.csv, line 6", "hole"},
    {"Backwards", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.2,0,0,0\n0.1,0,0,0\n", "way.csv, line 4", "goes back"},
    {"StandsStill", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.2,0,0,0\n0.2,0,0,0\n", "way.csv, line 4", "does not move on"},
    {"NoTick", "time_s,x_m,y_m,z_m\n0,0,0,0\n1e-5,0,0,0\n", "way.csv", "no tick"},
    {"Endless", "time_s,x_m,y_m,z_m\n0,0,0,0\n1e12,0,0,0\n", "way.csv", "GiB", 5},
    {"BeyondCounting", "time_s,x_m,y_m,z_m\n0,0,0,0\n1e300,0,0,0\n", "way.csv", "GiB", 5},
};

class RefusedPath : public ProgramTest, public testing::WithParamInterface<BadPath> {};

TEST_P(RefusedPath, InOneLineAndWithoutAnOutputFolder) {
  write("way.csv", GetParam().text);
  const Outcome outcome = run(quickTouchAlong("way.csv", "phantom:sphere?size=16"));
  expectRefusal(outcome, GetParam().input, GetParam().reason, GetParam().status);
  EXPECT_FALSE(exists("out"));
}

INSTANTIATE_TEST_SUITE_P(Each, RefusedPath, testing::ValuesIn(kBadPaths),
                         [](const auto& path) { return std::string(path.param.name); });

class RefusedPathFile : public ProgramTest {};

// Nobody writes into the pipe: whoever waits for that waits for ever.
TEST_F(RefusedPathFile, PipesAreNotWaitedFor) {
  ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
  expectRefusal(run(quickTouchAlong("pipe", "phantom:sphere?size=16")), "pipe", "cannot be read", 4);
  expectRefusal(run({"touch", "pipe.toml"}), "pipe.toml", "cannot be opened", 3);
  ASSERT_EQ(mkfifo(file("pipe.toml").c_str(), 0600), 0);
  expectRefusal(run({"touch", "pipe.toml"}), "pipe.toml", "it is no plain file", 2);
  std::filesystem::create_directory(file("journal"));
  ASSERT_EQ(mkfifo(file("journal/journal.palpate").c_str(), 0600), 0);
  expectRefusal(run({"recover", "journal", "--out", "back.vdb"}), "journal.palpate", "it is no plain file", 2);
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--device", "recorded", "--recording", "pipe"}), "pipe",
                "the recording is no plain file", 2);
  EXPECT_FALSE(exists("out"));
}

TEST_F(RefusedPathFile, MissingOrNoFile) {
  std::filesystem::create_directory(file("way"));
  expectRefusal(run(quickTouchAlong("nowhere.csv", "phantom:sphere?size=16")), "nowhere.csv", "does not exist", 3);
  expectRefusal(run(quickTouchAlong("way", "phantom:sphere?size=16")), "way", "cannot be read", 4);
  expectRefusal(run(quickTouchAlong(std::string(300, 'a'), "phantom:sphere?size=16")), "aaa", "too long", 4);
  EXPECT_FALSE(exists("out"));
}

// Points that no volume holds are no fault of the file: the tool is just far away. The index of such a point fits no
// int.
TEST_F(RefusedPathFile, FarAwayPointsAreFollowedWithoutAForce) {
  write("way.csv", kHeader + "0,1e15,0,0\n0.1,1e15,0,0\n");
  expectSuccess(run(quickTouchAlong("way.csv", "phantom:sphere?size=16")));
}

}  // namespace refused_path_test
}  // namespace palpate
