// SPDX-License-Identifier: Apache-2.0
// Editing sessions of several kinds are killed (SIGKILL) at random moments, again and again. Each time every
// acknowledged edit must be in the journal, the recovered volume must be what the slow, obvious twin makes of the
// edits, and a file that was saved beside the session must be its volume after one of its edits.
//
// PALPATE_KILLS: how often (4, in a long run 12; `./dev kills` takes 100). PALPATE_KILLS_SEED: of the moments.
// PALPATE_KILLS_RESULTS: the folder that gets what was counted.
#include <chrono>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>

#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/replay.hpp"
#include "engine/reference/edit.hpp"
#include "kill_figures.hpp"
#include "kill_sessions.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

extern char** environ;

namespace palpate {
namespace kills_test {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

// Half of the kills are of scripts, a quarter of each of the others.
constexpr std::array<KillKind, 4> kTurns = {KillKind::kScript, KillKind::kTool, KillKind::kScript,
                                            KillKind::kToolAndSave};

int numberFrom(const char* name, int standard) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : standard;
}

// "content 0123456789abcdef" of what `recover` printed.
std::string contentIn(const std::string& out) {
  const std::size_t at = out.find("content ");
  return at == std::string::npos ? "" : out.substr(at + 8, 16);
}

// A kill in the middle of a record leaves half of it, which is lost.
int statusOfRecover(const Journal& journal) {
  return journal.damage ? 4 : 0;
}

std::string contentOfDenseTwin(const Journal& journal) {
  const Volume start = loadVolume(kKilledVolume);
  reference::DenseField field = reference::denseField(start);
  for (const LastingEdit& edit : lastingEdits(journal))
    reference::applyEdits(field, lowerEdits(edit.commands, field.size, field.lattice, journal.header.profile));
  return fmt::format("{:016x}", contentHash(Volume::fromDense(field.size, field.lattice, field.values, {})));
}

std::string contentOfFile(const std::filesystem::path& file) {
  try {
    return fmt::format("{:016x}", contentHash(loadVolume(file)));
  } catch (const Error& error) {
    return error.what();
  }
}

// Of the volume after each edit. A tool undoes nothing.
std::set<std::string> contentsOnTheWay(const Journal& journal) {
  Volume volume = loadVolume(kKilledVolume);
  std::set<std::string> contents;
  for (const JournalRecord& record : journal.records) {
    reference::applyEdits(volume, lowerEdits(record.commands, volume.size(), volume.lattice(), journal.header.profile));
    contents.insert(fmt::format("{:016x}", contentHash(volume)));
  }
  return contents;
}

struct Undisturbed {
  long long whole_us = 0;
  long long real_us = 0;  // in real time, of the kind that has it
  std::string journal;    // its bytes
  std::uint64_t records = 0;
  std::set<std::string> contents;  // of the volume on the way, where it is saved
};

class Kills : public ProgramTest {
 protected:
  // Starts a session in a folder of its own; kills it after `delay`, or waits for its end. Whether it was killed.
  static bool runSession(KillKind kind, bool real_clock, const std::filesystem::path& where,
                         std::optional<microseconds> delay) {
    makeReady(kind, where);
    Words words = killArguments(kind, real_clock);
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
    if (failed != 0) return false;
    if (delay) {
      std::this_thread::sleep_for(*delay);
      kill(child, SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0) << contentsOf(where / "stderr");
    return WIFSIGNALED(status);
  }

  static long long timeOf(KillKind kind, bool real_clock, const std::filesystem::path& where) {
    const auto start = Clock::now();
    runSession(kind, real_clock, where, std::nullopt);
    return std::chrono::duration_cast<microseconds>(Clock::now() - start).count();
  }

  // Once before it counts, so that files and kernels are at hand.
  [[nodiscard]] Undisturbed undisturbed(KillKind kind) const {
    const std::filesystem::path first = folder() / fmt::format("first{}", static_cast<int>(kind));
    const std::filesystem::path whole = folder() / fmt::format("whole{}", static_cast<int>(kind));
    runSession(kind, false, first, std::nullopt);
    Undisturbed session;
    session.whole_us = timeOf(kind, false, whole);
    if (kind == KillKind::kTool)
      session.real_us = timeOf(kind, true, folder() / fmt::format("real{}", static_cast<int>(kind)));
    const Journal journal = readJournal(whole / "journal");
    session.journal = contentsOf(journalFile(whole / "journal"));
    session.records = journal.last_sequence;
    if (kind == KillKind::kToolAndSave) session.contents = contentsOnTheWay(journal);
    if (kind != KillKind::kTool) {  // what the session held on the GPU at its end
      const std::filesystem::path file = whole / (kind == KillKind::kScript ? kKilledResult : kKilledSave);
      EXPECT_EQ(contentOfFile(file), contentOfDenseTwin(journal)) << killName(kind);
    }
    return session;
  }

  // The file that was saved before the kill is whole; the next one of its name takes with it what a killed save left.
  void checkSaved(const std::filesystem::path& where, const Undisturbed& session, KillFigures& figures) const {
    const std::filesystem::path saved = where / kKilledSave;
    if (std::filesystem::exists(saved)) {
      ++figures.saves;
      const std::string content = contentOfFile(saved);
      const bool whole = session.contents.contains(content);
      EXPECT_TRUE(whole) << saved << " is none of the session's volumes: " << content;
      figures.other_saves += whole ? 0 : 1;
    }
    const Outcome again = runPalpate({.arguments = {"recover", "journal", "--out", kKilledSave}, .folder = where});
    EXPECT_EQ(again.status, statusOfRecover(readJournal(where / "journal"))) << again.err;
    for (const auto& entry : std::filesystem::directory_iterator(where))
      EXPECT_NE(entry.path().extension(), ".palpate-part") << entry.path();
  }

  void checkKilled(KillKind kind, bool real_clock, const std::filesystem::path& where, const Undisturbed& session,
                   KillFigures& figures) const {
    const std::uint64_t acknowledged = std::strtoull(contentsOf(where / "acknowledged").c_str(), nullptr, 10);
    figures.acknowledged += acknowledged;
    figures.most_acknowledged = std::max(figures.most_acknowledged, acknowledged);
    figures.with_records += acknowledged > 0 ? 1 : 0;
    if (!std::filesystem::exists(journalFile(where / "journal"))) {
      EXPECT_EQ(acknowledged, 0U);
      figures.missing += acknowledged;
      return;
    }
    const Journal journal = readJournal(where / "journal");
    EXPECT_GE(journal.last_sequence, acknowledged) << "acknowledged edits are missing";
    figures.recovered += journal.last_sequence;
    figures.missing += acknowledged - std::min(acknowledged, journal.last_sequence);
    figures.torn += journal.damage ? 1 : 0;
    if (!real_clock) {  // what is there is what the undisturbed session had, byte for byte, behind the journal's number
      const std::string bytes = contentsOf(journalFile(where / "journal"));
      const std::size_t sound = journal.damage ? journal.damage->first_byte : bytes.size();
      JournalHeader header;
      const std::size_t begin = readHeader(bytes, "journal", header);
      EXPECT_TRUE(bytes.substr(begin, sound - begin) == session.journal.substr(begin, sound - begin));
    }
    const Outcome recovered = runPalpate({.arguments = {"recover", "journal", "--out", "back.vdb"}, .folder = where});
    EXPECT_EQ(recovered.status, statusOfRecover(journal)) << recovered.err;
    const bool equal = contentIn(recovered.out) == contentOfDenseTwin(journal);
    EXPECT_TRUE(equal) << recovered.out;
    ++figures.volumes;
    figures.other_volumes += equal ? 0 : 1;
    if (kind == KillKind::kToolAndSave) checkSaved(where, session, figures);
  }

  [[nodiscard]] std::string commit() const {  // of "palpate 0.1.0 (0123456789)"
    const std::string version = run({"--version"}).out;
    return version.substr(version.find('(') + 1, version.find(')') - version.find('(') - 1);
  }
  [[nodiscard]] std::string vulkanDevice() const {
    const std::filesystem::path tool = folder() / fmt::format("whole{}", static_cast<int>(KillKind::kTool));
    const auto vulkan = nlohmann::json::parse(contentsOf(tool / "out" / "summary.json"))["vulkan"];
    return fmt::format("{}, {}", vulkan["device"].get<std::string>(), vulkan["driver"].get<std::string>());
  }
};

TEST_F(Kills, LoseNoAcknowledgedEdit) {
  const auto begin = Clock::now();
  std::map<KillKind, Undisturbed> sessions;
  std::map<KillKind, KillFigures> figures;
  for (const KillKind kind : kKillKinds) {
    sessions[kind] = undisturbed(kind);
    ASSERT_GE(sessions[kind].records, 100U) << killName(kind) << " hardly edits";
    figures[kind] = {.kind = killName(kind), .records_in_all = sessions[kind].records};
  }
  const int kills = numberFrom("PALPATE_KILLS", isLongRun() ? 12 : 4);
  const int seed = numberFrom("PALPATE_KILLS_SEED", 1);
  std::mt19937 random(static_cast<unsigned>(seed));
  int killed = 0;
  // A session that ends before its moment counts for nothing.
  for (int i = 0; killed < kills && i < 4 * kills; ++i) {
    const KillKind kind = kTurns[static_cast<std::size_t>(killed) % kTurns.size()];
    const bool real_clock = kind == KillKind::kTool && figures[kind].kills % 2 == 1;
    const long long whole_us = real_clock ? sessions[kind].real_us : sessions[kind].whole_us;
    const microseconds delay(std::uniform_int_distribution<long long>(whole_us / 20, whole_us * 19 / 20)(random));
    const std::filesystem::path where = folder() / fmt::format("kill{}", i);
    SCOPED_TRACE(fmt::format("{} killed after {} us", killName(kind), delay.count()));
    if (!runSession(kind, real_clock, where, delay)) continue;
    ++killed;
    ++figures[kind].kills;
    checkKilled(kind, real_clock, where, sessions[kind], figures[kind]);
    std::filesystem::remove_all(where);
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::vector<KillFigures> counted;
  int with_records = 0;
  for (const KillKind kind : kKillKinds) {
    const KillFigures& k = counted.emplace_back(figures[kind]);
    with_records += k.with_records;
    fmt::print("{}: {} killed, {} with acknowledged records (at most {} of {}), {} with a saved file\n", k.kind,
               k.kills, k.with_records, k.most_acknowledged, k.records_in_all, k.saves);
  }
  EXPECT_EQ(killed, kills);
  EXPECT_GE(with_records, kills / 4);
  EXPECT_GE(figures[KillKind::kToolAndSave].saves, kills / 16);
  if (const char* results = std::getenv("PALPATE_KILLS_RESULTS"); results != nullptr) {
    const std::string command =
        fmt::format("{}./dev kills {}", seed == 1 ? "" : fmt::format("PALPATE_KILLS_SEED={} ", seed), kills);
    writeKillFigures(counted, command, commit(), vulkanDevice(), seconds, results);
  }
}

}  // namespace kills_test
}  // namespace palpate
