// SPDX-License-Identifier: Apache-2.0
// An output folder that cannot take the results: one line, and what was there stays as it was.
#include <set>

#include <fcntl.h>
#include <unistd.h>

#include "nrrd_bytes.hpp"
#include "program_test.hpp"
#include "tests/support/as_nobody.hpp"

namespace palpate {
namespace refused_output_test {

namespace fs = std::filesystem;

class RefusedOutput : public ProgramTest {
 protected:
  [[nodiscard]] Outcome touch(const std::string& out, const Words& more = {}) const {
    return run(Words{"touch", "phantom:sphere?size=16", "--seconds", "0.3", "--clock", "simulated", "--picture", "off",
                     "--out", out} +
               more);
  }
  // By name; folders too.
  [[nodiscard]] std::set<std::string> everything() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder())) {
      names.insert(fs::relative(entry.path(), folder()).string());
    }
    return names;
  }
};

TEST_F(RefusedOutput, EmptyName) {
  expectRefusal(touch(""), "--out ''", "names no folder", 4);
}

TEST_F(RefusedOutput, AFileIsInTheWay) {
  write("out", "mine");
  expectRefusal(touch("out"), "out", "nothing can be written there", 4);
  expectRefusal(touch("out/inner"), "out/inner", "nothing can be written there", 4);
  EXPECT_EQ(contentsOf(file("out")), "mine");
}

// Holds for the superuser too, whom file permissions do not stop.
TEST_F(RefusedOutput, AFileSystemThatTakesNoFolders) {
  expectRefusal(touch("/proc/palpate"), "/proc/palpate", "nothing can be written there", 4);
  expectRefusal(touch("/proc/self"), "/proc/self", "nothing can be written there", 4);
}

// As nobody, since the superuser may write everywhere.
TEST_F(RefusedOutput, AFolderWithoutPermission) {
  fs::create_directory(file("out"));
  fs::permissions(file("out"), fs::perms(0555));
  fs::permissions(folder(), fs::perms(0755));
  {
    const AsNobody nobody;
    ASSERT_TRUE(nobody.isSet());
    if (faccessat(AT_FDCWD, PALPATE_PROGRAM, X_OK, AT_EACCESS) != 0)
      GTEST_SKIP() << "the checkout lies where only the superuser may run the program: move it";
    expectRefusal(touch("out"), "out", "Permission denied", 4);
  }
  fs::permissions(file("out"), fs::perms::owner_all);
}

TEST_F(RefusedOutput, FoldersMadeForARefusedRunAreGone) {
  expectRefusal(touch("a/b/c", {"--iso", "99999"}), "phantom:sphere", "isovalue", 2);
  expectRefusal(touch("d/", {"--iso", "99999"}), "phantom:sphere", "isovalue", 2);
  expectRefusal(touch("e/" + std::string(300, 'x')), "e/xxx", "too long", 4);
  EXPECT_THAT(everything(), testing::IsEmpty());
}

TEST_F(RefusedOutput, FoldersThatWereThereStay) {
  fs::create_directories(file("a/b"));
  expectRefusal(touch("a/b/c", {"--iso", "99999"}), "phantom:sphere", "isovalue", 2);
  expectRefusal(touch("a/b", {"--iso", "99999"}), "phantom:sphere", "isovalue", 2);
  EXPECT_THAT(everything(), testing::ElementsAre("a", "a/b"));
}

// A disk that is full after 1 byte, in the middle of the first file, and only in the last one to be written: the
// report, which holds the plots' program, is larger than the trace of 300 ticks (under 100 KB).
TEST_F(RefusedOutput, FullDiskLeavesNothing) {
  for (const std::uint64_t limit : {1ULL, 20'000ULL, 110'000ULL}) {
    const Outcome outcome =
        runPalpate({.arguments = quickTouch("phantom:sphere?size=16"), .folder = folder(), .file_size_limit = limit});
    expectRefusal(outcome, "out/", "cannot be written", 4);
    EXPECT_THAT(everything(), testing::IsEmpty()) << limit;
  }
}

TEST_F(RefusedOutput, FullDiskLeavesEarlierResultsAsTheyWere) {
  expectSuccess(touch("out"));
  const auto before = everything();
  const std::string trace = contentsOf(file("out/trace.csv")), summary = contentsOf(file("out/summary.json"));
  const Outcome outcome = runPalpate({.arguments = quickTouch("phantom:sphere?size=16", {"--depth", "2"}),
                                      .folder = folder(),
                                      .file_size_limit = 110'000});
  expectRefusal(outcome, "out/", "cannot be written", 4);
  EXPECT_EQ(everything(), before);
  EXPECT_EQ(contentsOf(file("out/trace.csv")), trace);
  EXPECT_EQ(contentsOf(file("out/summary.json")), summary);
}

TEST_F(RefusedOutput, AFolderOfAResultsNameIsNotReplaced) {
  fs::create_directories(file("out/summary.json"));
  expectRefusal(touch("out"), "out/summary.json", "not a plain file", 4);
  EXPECT_THAT(everything(), testing::ElementsAre("out", "out/summary.json"));
}

// A check that wrote its result into the scan would lose the scan.
TEST_F(RefusedOutput, AChecksResultReplacesNoVolume) {
  const std::string scan = ballNrrd().bytes();
  write("scan.nrrd", scan);
  for (const char* what : {"gradient", "filters", "edits", "all"}) {
    for (const Words& name : {Words{"scan.nrrd"}, Words{"scan.nrrd", "--nan", "0"}}) {
      expectRefusal(run(Words{"check", what} + name + Words{"--json", "./scan.nrrd"}), "./scan.nrrd", "it is the input",
                    2);
    }
  }
  expectRefusal(run({"check", "all", "scan.nrrd", "--page", "scan.nrrd"}), "scan.nrrd", "it is the input", 2);
  expectRefusal(run({"check", "all", "--quick", "--json", "a.txt", "--page", "./a.txt"}), "./a.txt",
                "two of the outputs", 2);
  EXPECT_EQ(contentsOf(file("scan.nrrd")), scan);
  EXPECT_THAT(everything(), testing::ElementsAre("scan.nrrd"));
}

TEST_F(RefusedOutput, StandardOutputThatIsFull) {
  for (const Words& words : {Words{"scene"}, Words{"info", "phantom:sphere?size=16"}, Words{"--help"}}) {
    expectRefusal(runPalpate({.arguments = words, .folder = folder(), .output_file = "/dev/full"}), "standard output",
                  "cannot be written", 4);
  }
}

}  // namespace refused_output_test
}  // namespace palpate
