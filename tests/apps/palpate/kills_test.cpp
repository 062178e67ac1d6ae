// SPDX-License-Identifier: Apache-2.0
// An editing session is killed (SIGKILL) at random moments, again and again. Each time every acknowledged edit must be
// in the journal, and the recovered volume must be what the slow, obvious twin makes of the edits.
//
// PALPATE_KILLS: how often (5; `./dev kills` takes 100). PALPATE_KILLS_SEED: of the moments.
#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include "engine/journal/replay.hpp"
#include "engine/reference/edit.hpp"
#include "program_test.hpp"

extern char** environ;

namespace palpate {
namespace {

constexpr const char* kVolume = "phantom:sphere?size=32";

// The tool drills all along its slide: more than a thousand edits. With the simulated clock every run makes the same
// ones.
constexpr double kRealSeconds = 2;
Words session(bool real_clock) {
  return {"touch",      kVolume,
          "--seconds",  real_clock ? fmt::format("{}", kRealSeconds) : "12",
          "--clock",    real_clock ? "real" : "simulated",
          "--picture",  "off",
          "--trace",    "off",
          "--edit",     "remove:radius=1mm:strength=0.02:period=1",
          "--journal",  "journal",
          "--approach", "1",
          "--out",      "out"};
}

int numberFrom(const char* name, int standard) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : standard;
}

class Kills : public ProgramTest {
 protected:
  // Starts a session in a folder of its own and kills it after `delay`, or waits for its end.
  bool runAndKill(const std::filesystem::path& where, bool real_clock, std::chrono::microseconds delay) {
    std::filesystem::create_directories(where);
    Words words = session(real_clock);
    std::vector<char*> arguments = {const_cast<char*>(PALPATE_PROGRAM)};
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const auto old = std::filesystem::current_path();
    std::filesystem::current_path(where);
    setenv("PALPATE_ACKNOWLEDGED", "acknowledged", 1);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, "stdout", O_WRONLY | O_CREAT, 0666);
    posix_spawn_file_actions_addopen(&actions, 2, "stderr", O_WRONLY | O_CREAT, 0666);
    pid_t child = 0;
    const int failed = posix_spawn(&child, PALPATE_PROGRAM, &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    unsetenv("PALPATE_ACKNOWLEDGED");
    std::filesystem::current_path(old);
    EXPECT_EQ(failed, 0);
    std::this_thread::sleep_for(delay);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }

  static std::uint64_t acknowledgedIn(const std::filesystem::path& where) {
    return std::strtoull(contentsOf(where / "acknowledged").c_str(), nullptr, 10);
  }
};

// "content 0123456789abcdef" of what `recover` printed.
std::string contentIn(const std::string& out) {
  const std::size_t at = out.find("content ");
  return at == std::string::npos ? "" : out.substr(at + 8, 16);
}

std::string contentOfDenseTwin(const Journal& journal) {
  const Volume start = loadVolume(kVolume);
  reference::DenseField field = reference::denseField(start);
  for (const auto& commands : lastingEdits(journal))
    reference::applyEdits(field, lowerEdits(commands, field.size, field.lattice, journal.header.profile));
  return fmt::format("{:016x}", contentHash(Volume::fromDense(field.size, field.lattice, field.values, {})));
}

TEST_F(Kills, LoseNoAcknowledgedEdit) {
  const auto begin = std::chrono::steady_clock::now();
  // The whole session, for its edits and its length; once before that, so that files and kernels are at hand.
  std::filesystem::create_directories(folder() / "first");
  expectSuccess(runPalpate({.arguments = session(false), .folder = folder() / "first"}));
  std::filesystem::create_directories(folder() / "whole");
  const auto start = std::chrono::steady_clock::now();
  expectSuccess(runPalpate({.arguments = session(false), .folder = folder() / "whole"}));
  const auto whole_us =
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start).count();
  const std::string whole = contentsOf(journalFile(folder() / "whole" / "journal"));
  const std::uint64_t all = readJournal(folder() / "whole" / "journal").last_sequence;
  ASSERT_GE(all, 100U) << "the tool hardly edits";

  const int kills = numberFrom("PALPATE_KILLS", 5);
  std::mt19937 random(static_cast<unsigned>(numberFrom("PALPATE_KILLS_SEED", 1)));
  int with_edits = 0;
  int killed = 0;
  std::uint64_t acknowledged_most = 0;
  // A session that ends before its moment counts for nothing.
  for (int i = 0; killed < kills && i < 4 * kills; ++i) {
    const std::filesystem::path where = folder() / fmt::format("kill{}", i);
    const bool real_clock = i % 3 == 2;
    const auto delay =
        std::chrono::microseconds(std::uniform_int_distribution<long long>(whole_us / 20, whole_us * 19 / 20)(random));
    killed += runAndKill(where, real_clock, delay) ? 1 : 0;
    const std::uint64_t acknowledged = acknowledgedIn(where);
    if (!std::filesystem::exists(journalFile(where / "journal"))) {
      ASSERT_EQ(acknowledged, 0U);
      continue;
    }
    const Journal journal = readJournal(where / "journal");
    ASSERT_GE(journal.last_sequence, acknowledged) << "acknowledged edits are missing after " << delay.count() << " us";
    if (!real_clock) {  // what is there is what the undisturbed session had, byte for byte
      const std::string bytes = contentsOf(journalFile(where / "journal"));
      const std::size_t sound = journal.damage ? journal.damage->first_byte : bytes.size();
      ASSERT_EQ(bytes.substr(0, sound), whole.substr(0, sound));
    }
    const Outcome recovered = runPalpate({.arguments = {"recover", "journal", "--out", "back.vdb"}, .folder = where});
    ASSERT_EQ(recovered.status, 0) << recovered.err;
    ASSERT_EQ(contentIn(recovered.out), contentOfDenseTwin(journal)) << recovered.out;
    if (acknowledged > 0) ++with_edits;
    acknowledged_most = std::max(acknowledged_most, acknowledged);
    std::filesystem::remove_all(where);
  }
  fmt::print("{} sessions were killed; {} had acknowledged edits (at most {} of {}); {:.0f} s\n", killed, with_edits,
             acknowledged_most, all, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  EXPECT_EQ(killed, kills);
  EXPECT_GE(with_edits, kills / 4);
}

}  // namespace
}  // namespace palpate
