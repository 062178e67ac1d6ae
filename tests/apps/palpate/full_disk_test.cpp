// SPDX-License-Identifier: Apache-2.0
// A disk that gets full while a session is journalled and saved: the session goes on, the user is told up to which
// record edits are saved, nothing is half-written, and what was told is what `recover` gives back.
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/journal/journal_reader.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/small_disk.hpp"

namespace palpate {
namespace full_disk_test {

using ::testing::HasSubstr;

// Some 7000 edits of 98 bytes each; the 64^3 volume takes 1 MiB as .nrrd.
Words session(const std::string& place, const Words& more = {}) {
  return Words{"touch",      "phantom:sphere?size=64",
               "--seconds",  "6",
               "--rate",     "1500",
               "--clock",    "simulated",
               "--picture",  "off",
               "--trace",    "off",
               "--edit",     "remove:radius=0.5mm:strength=0.01:period=0.1",
               "--approach", "1",
               "--journal",  place + "journal",
               "--save",     place + "sculpted.nrrd",
               "--out",      "out"} +
         more;
}

std::string lineWith(const Words& lines, const std::string& words) {
  for (const std::string& line : lines) {
    if (line.find(words) != std::string::npos) return line;
  }
  return "";
}

class FullDisk : public ProgramTest {
 protected:
  // `place`: the folder that got full, where "sculpted.nrrd" holds "old".
  void expectAllIsTold(const Outcome& outcome, const std::string& place) const {
    ASSERT_EQ(outcome.status, 4) << outcome.err;  // who asked for journal and file has neither whole
    Words lines = errorLines(outcome.err);
    std::erase_if(lines, isBrushWarning);
    EXPECT_EQ(lines.size(), 2U) << outcome.err;
    const std::string journal_line = lineWith(lines, "edits after number ");
    const std::string save_line = lineWith(lines, "was not saved");
    ASSERT_NE(journal_line, "") << outcome.err;
    ASSERT_NE(save_line, "") << outcome.err;
    for (const std::string& line : {journal_line, save_line}) EXPECT_THAT(line, HasSubstr("make room"));
    // A tool makes edits alone: number and record are one.
    EXPECT_THAT(journal_line,
                testing::ContainsRegex("edits after number ([0-9]+) \\(record [0-9]+ of the journal\\) "));
    const std::uint64_t saved = std::strtoull(journal_line.c_str() + journal_line.find("number ") + 7, nullptr, 10);

    const auto summary = nlohmann::json::parse(contentsOf(file("out") / "summary.json"));
    const auto& edits = summary["edits"];
    EXPECT_GT(edits["count"], saved);  // it went on
    EXPECT_GT(saved, 0U);
    EXPECT_EQ(edits["journal_saved"], saved);
    EXPECT_THAT(edits["journal_failure"].get<std::string>(), HasSubstr("make room"));
    EXPECT_EQ(edits["saves"], 0);
    EXPECT_EQ(edits["save_failures"], 1);
    EXPECT_EQ(summary["notes"].size(), 3U);  // and of the brush

    EXPECT_EQ(contentsOf(file(place + "sculpted.nrrd")), "old");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(file(place)))
      EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr("palpate-part")));
    const Journal journal = readJournal(file(place + "journal"));
    EXPECT_FALSE(journal.damage);
    EXPECT_EQ(journal.last_sequence, saved);
    const Outcome recovered = run({"recover", place + "journal", "--out", "back.vdb"});
    expectSuccess(recovered);
    EXPECT_THAT(recovered.out, HasSubstr(fmt::format("Journal   {} edits", saved)));
    EXPECT_THAT(recovered.out, testing::Not(HasSubstr("Lost")));
  }
};

// A limit on the size of files, above the report (some 480 KB) and below the journal: one that begins anew is small
// again, and has every edit.
TEST_F(FullDisk, AJournalThatGotTooLongBeginsAnew) {
  PALPATE_LONG_ONLY();
  write("sculpted.nrrd", "old");
  const Outcome outcome = runPalpate({.arguments = session(""), .folder = folder(), .file_size_limit = 560'000});
  EXPECT_EQ(outcome.status, 4) << outcome.err;  // of the file that was not saved
  EXPECT_NE(lineWith(errorLines(outcome.err), "edits after number "), "") << outcome.err;
  EXPECT_NE(lineWith(errorLines(outcome.err), "is kept again, and holds every edit"), "") << outcome.err;
  const auto& edits = nlohmann::json::parse(contentsOf(file("out") / "summary.json"))["edits"];
  EXPECT_EQ(edits["journal_saved"], edits["count"]);
  EXPECT_EQ(edits["journal_failure"], "");
  const Journal journal = readJournal(file("journal"));
  EXPECT_FALSE(journal.damage);
  EXPECT_TRUE(journal.base);
  EXPECT_EQ(journal.last_sequence, edits["count"]);
  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  expectSuccess(recovered);
  EXPECT_THAT(recovered.out, HasSubstr(fmt::format("Journal   {} edits", edits["count"].get<int>())));
}

// The trace of 5000 ticks takes about a MB. It is written as a draft in a hidden folder, which the message does not
// name.
TEST_F(FullDisk, AResultIsNamedByItsPlace) {
  const Outcome outcome = runPalpate({.arguments = {"touch", "phantom:sphere?size=16", "--seconds", "5", "--clock",
                                                    "simulated", "--picture", "off", "--out", "out"},
                                      .folder = folder(),
                                      .file_size_limit = 560'000});
  expectRefusal(outcome, "palpate: out/trace.csv: cannot be written", "make room", 4);
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr(".palpate-")));
  EXPECT_FALSE(exists("out"));
}

// A recording of 60,000 ticks takes more than 24 bytes a tick. It is written last, so that the report is there.
TEST_F(FullDisk, ARecordingThatFindsNoRoomLeavesTheReport) {
  write("s.rec", "PALPREC: an old one");
  const Outcome outcome =
      runPalpate({.arguments = {"touch", "phantom:sphere?size=16", "--seconds", "6", "--rate", "10000", "--clock",
                                "simulated", "--picture", "off", "--trace", "off", "--record", "s.rec", "--out", "out"},
                  .folder = folder(),
                  .file_size_limit = 1'000'000});
  expectRefusal(outcome, "s.rec", "make room", 4);
  EXPECT_EQ(nlohmann::json::parse(contentsOf(file("out") / "summary.json"))["servo"]["ticks"], 60'000);
  EXPECT_TRUE(exists("out/report.html"));
  EXPECT_EQ(contentsOf(file("s.rec")), "PALPREC: an old one");
  for (const auto& entry : std::filesystem::directory_iterator(folder()))
    EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr("palpate-part")));
}

// A file system of 256 KiB that is full.
TEST_F(FullDisk, OnAFullFileSystemTheSessionGoesOn) {
  const SmallDisk disk(file("disk"));
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  write("disk/sculpted.nrrd", "old");
  const Outcome outcome = run(session("disk/"));
  expectAllIsTold(outcome, "disk/");
}

// The log of the run lies there too: what cannot be told is no reason to end. The journal says less than it might.
TEST_F(FullDisk, WithItsLogOnTheFullFileSystemTheSessionGoesOn) {
  PALPATE_LONG_ONLY();
  const SmallDisk disk(file("disk"));
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  write("disk/sculpted.nrrd", "old");
  write("disk/log", "");
  const Outcome outcome =
      runPalpate({.arguments = session("disk/"), .folder = folder(), .error_file = file("disk/log").string()});
  EXPECT_EQ(outcome.status, 4) << "signal " << outcome.signal;
  const auto summary = nlohmann::json::parse(contentsOf(file("out") / "summary.json"));
  EXPECT_EQ(summary["servo"]["ticks"], 9000);
  EXPECT_TRUE(summary["ended_early"].is_null());
  EXPECT_GT(summary["edits"]["count"], summary["edits"]["journal_saved"]);
  EXPECT_THAT(outcome.out, HasSubstr("Touched "));
  EXPECT_EQ(contentsOf(file("disk/sculpted.nrrd")), "old");
}

// A limit of the file size, below the journal and above nothing: log and journal end, the session does not.
TEST_F(FullDisk, WithALogThatIsFullTheSessionGoesOn) {
  PALPATE_LONG_ONLY();
  write("log", std::string(600'000, 'x'));
  write("sculpted.nrrd", "old");
  const Outcome outcome = runPalpate(
      {.arguments = session(""), .folder = folder(), .file_size_limit = 560'000, .error_file = file("log").string()});
  EXPECT_EQ(outcome.status, 4) << "signal " << outcome.signal;
  EXPECT_EQ(contentsOf(file("log")).size(), 600'000U);
  EXPECT_EQ(nlohmann::json::parse(contentsOf(file("out") / "summary.json"))["servo"]["ticks"], 9000);
}

TEST_F(FullDisk, NotEvenAJournalsBeginningIsARefusal) {
  const Outcome outcome = runPalpate({.arguments = session(""), .folder = folder(), .file_size_limit = 100});
  expectRefusal(outcome, "journal", "no journal can be kept there", 4);
  EXPECT_FALSE(exists("out"));
  EXPECT_FALSE(exists("journal/journal.palpate"));
}

}  // namespace full_disk_test
}  // namespace palpate
