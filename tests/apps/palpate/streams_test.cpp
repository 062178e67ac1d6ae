// SPDX-License-Identifier: Apache-2.0
// Standard streams that are closed or full: the files are those of any other run, and what could not be told is known
// by the status. Every verb but bench, whose shortest takes seconds: so this takes a while.
#include <csignal>

#include <fmt/format.h>

#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/journal_writer.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace streams_test {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct VerbCase {
  const char* name;
  Words arguments;
  Words files;  // that it writes, the same bytes each time; a .vdb has a number of its own in each file
};

const VerbCase kVerbs[] = {
    {"Touch", quickTouch("phantom:sphere?size=16"), {"out/trace.csv"}},
    {"Edit", {"edit", "phantom:sphere?size=16", "o.nrrd", "--do", "remove:radius=2mm:at=0,0,0"}, {"o.nrrd"}},
    {"Recover", {"recover", "journal", "--out", "o.nrrd"}, {"o.nrrd"}},
    {"Convert", {"convert", "phantom:sphere?size=16", "o.nii.gz"}, {"o.nii.gz"}},
    {"Filter", {"filter", "phantom:sphere?size=16", "-o", "o.mha", "--filter", "median:1"}, {"o.mha"}},
    {"Gradient", {"gradient", "phantom:sphere?size=16", "-o", "o.vdb"}, {"o.vdb"}},
    {"Render",
     {"render", "phantom:sphere?size=16", "-o", "o.png", "--depth", "d.pfm", "--size", "32x24"},
     {"o.png", "d.pfm"}},
    {"Check", {"check", "edits", "phantom:sphere?size=16", "--edits", "3", "--json", "o.json"}, {}},
    {"Info", {"info", "phantom:sphere?size=16"}, {}},
    {"Plan", {"plan", "phantom:sphere?size=16", "--rounds", "0"}, {}},
    {"Tune", {"tune", "phantom:sphere?size=16", "--seconds", "0.3", "--error", "1N"}, {}},
    {"Devices", {"devices"}, {}},
    {"Scene", {"scene"}, {}},
    {"Faults", {"faults"}, {}},
    {"Help", {"help"}, {}},
    {"HelpFlag", {"touch", "--help"}, {}},
    {"Version", {"--version"}, {}},
    {"Completion", {"completion", "bash"}, {}},
};

class Streams : public ProgramTest, public testing::WithParamInterface<VerbCase> {
 protected:
  Streams() {
    const Volume volume = loadVolume("phantom:sphere?size=16");
    JournalWriter writer(file("journal"), {identityOf(volume), brushProfile(volume, defaultIsovalue(volume))});
    EditCommand command;
    command.radius_m = 0.002;
    writer.edit({&command, 1});
  }

  // What a run in good order leaves in each file.
  [[nodiscard]] std::vector<std::string> filesOfAnyOtherRun() const {
    expectSuccess(run(GetParam().arguments));
    return taken();
  }
  [[nodiscard]] std::vector<std::string> taken() const {
    std::vector<std::string> contents;
    for (const std::string& name : GetParam().files) {
      contents.push_back(contentsOf(file(name)));
      if (name.ends_with(".vdb")) contents.back() = std::to_string(fs::file_size(file(name)));
      fs::remove(file(name));
    }
    return contents;
  }
  void expectNothingElse() const {
    for (const auto& entry : fs::recursive_directory_iterator(folder())) {
      EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("palpate-part")));
      EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::StartsWith(".palpate")));
    }
  }
};

TEST_P(Streams, ThatAreClosedFullOrUnreadChangeNoFile) {
  const std::string name = GetParam().name;
  // Those that take seconds, and one that is to a volume what Gradient is.
  const bool is_left_out = name == "Plan" || name == "Tune" || name == "Filter";
  if (is_left_out) PALPATE_LONG_ONLY();
  const bool has_every_case = isLongRun() || name == "Edit" || name == "Info";
  const std::vector<std::string> files = filesOfAnyOtherRun();
  const auto expectFiles = [&](const std::string& how) {
    EXPECT_EQ(taken(), files) << how;
    expectNothingElse();
  };
  // Closed: every combination for a verb that opens many files (but in a long run without two pairs), the telling ones
  // for the others.
  for (int closed = 1; closed < 8; ++closed) {
    if ((name != "Edit" || (!isLongRun() && closed % 3 == 0)) && closed != 4 && closed != 7) continue;
    Command command{.arguments = GetParam().arguments, .folder = folder()};
    for (int stream = 0; stream < 3; ++stream) {
      if ((closed >> stream & 1) != 0) command.closed.push_back(stream);
    }
    const Outcome outcome = runPalpate(command);
    const bool has_output = (closed & 2) == 0, has_errors = (closed & 4) == 0;
    EXPECT_EQ(outcome.status, has_output ? 0 : 4) << closed << ", signal " << outcome.signal << ": " << outcome.err;
    if (!has_output && has_errors) expectRefusal(outcome, "standard output", "cannot be written", 4);
    expectFiles(fmt::format("closed {}", closed));
  }
  // Full: a message that is lost is no error, a result is.
  const Outcome no_errors =
      runPalpate({.arguments = GetParam().arguments, .folder = folder(), .error_file = "/dev/full"});
  EXPECT_EQ(no_errors.status, 0) << "signal " << no_errors.signal;
  expectFiles("stderr full");
  const Outcome no_output =
      runPalpate({.arguments = GetParam().arguments, .folder = folder(), .output_file = "/dev/full"});
  expectRefusal(no_output, "standard output", "cannot be written", 4);
  expectFiles("stdout full");
  if (has_every_case) {
    const Outcome neither = runPalpate(
        {.arguments = GetParam().arguments, .folder = folder(), .output_file = "/dev/full", .error_file = "/dev/full"});
    EXPECT_EQ(neither.status, 4) << "signal " << neither.signal;
    expectFiles("both full");
  }
  // Unread, `palpate ... | head -1`: it ends as every program in a pipe does, but not before its files are there.
  const Outcome unread = runPalpate({.arguments = GetParam().arguments, .folder = folder(), .output_unread = true});
  EXPECT_EQ(unread.signal, SIGPIPE) << unread.status;
  EXPECT_THAT(errorLines(unread.err), testing::IsEmpty());
  expectFiles("stdout unread");
}

INSTANTIATE_TEST_SUITE_P(Each, Streams, testing::ValuesIn(kVerbs),
                         [](const auto& verb) { return std::string(verb.param.name); });

class ClosedInput : public ProgramTest {};

// No empty script: the commands that were meant are lost.
TEST_F(ClosedInput, IsNoEmptyScript) {
  const Outcome outcome = runPalpate(
      {.arguments = {"edit", "phantom:sphere?size=16", "o.nrrd", "--script", "-"}, .folder = folder(), .closed = {0}});
  expectRefusal(outcome, "standard input", "reading failed", 4);
  EXPECT_FALSE(exists("o.nrrd"));
}

}  // namespace streams_test
}  // namespace palpate
