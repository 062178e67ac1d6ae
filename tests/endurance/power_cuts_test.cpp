// SPDX-License-Identifier: Apache-2.0
// The power is cut at the syncs of a service's journal, checkpoints and saves, from its start on, with a disk that gets
// full in between and a journal that begins anew. What the disk holds then (unsynced_disk.hpp) gives a state that the
// session had, none older than what it had acknowledged; and a saved file is whole: the one that was acknowledged last,
// or a later one. Every session begins from what such a cut has left.
//
// PALPATE_POWER_CUTS: how many (150; `./dev kills N` makes 20 for each kill).
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/serve/served_engine.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "child_process.hpp"
#include "endurance_figures.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/recovery.hpp"
#include "engine/journal/volume_identity.hpp"
#include "temporary_folder.hpp"
#include "tests/support/file_size_limit.hpp"
#include "unsynced_disk.hpp"

namespace palpate {
namespace power_cuts_test {

namespace fs = std::filesystem;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

constexpr const char* kIntroduction =
    "A service's engine edits, undoes, redoes, saves, and writes checkpoints, on a disk that is full now and then. The "
    "power is cut before and after syncs, renames, links and removals, from the start on. Of what was not synced each "
    "sector, each length and each entry of a folder is then there or not, in any order; where there is only the "
    "length, there are zeros or bytes of something else. A rename is atomic. Then a recovery must give a state that "
    "the session had, no older than what it had acknowledged, and a saved file must be the one acknowledged last, or a "
    "later one, whole. All bits are compared.";

// What is on the disk for sure, at some moment.
struct Known {
  std::size_t state = 0;                        // index of the newest state that was acknowledged
  std::optional<std::size_t> saved_state = {};  // of the newest that a file was acknowledged to have at least
};
struct Cut {
  UnsyncedDisk::Image image;
  Known known;
};

struct Counts {
  int cuts = 0, sessions = 0, with_edits = 0, at_checkpoints = 0, at_saves = 0, renewed = 0, from_checkpoints = 0;
  int told_of_losses = 0, missing = 0, other_files = 0;
  std::uint64_t changes = 0, acknowledged = 0;
};

// From the start of a service to its end.
class PoweredSession {
 public:
  // `cut` is set to what takes a cut of this session.
  PoweredSession(const fs::path& place, unsigned seed, std::function<void(UnsyncedDisk::Image)>& cut)
      : place_(place), random_(seed) {
    cut = [this](UnsyncedDisk::Image image) {
      const std::lock_guard lock(mutex_);
      cuts.push_back({std::move(image), known()});
    };
    Scene scene;
    scene.volume = "phantom:sphere?size=16";
    Progress silent(nullptr);
    served_.emplace(scene, place_ / "journal", silent, [this](const std::string& words) { tell(words); });
    lost_records = served_->live().lostRecords();
    edits_.emplace(served_->size(), served_->lattice(), -1, 1, seed);
    noteState();
    const std::lock_guard lock(mutex_);
    journal_ = served_->live().session().journal();
  }

  void run(int steps) {
    for (int step = 0; step < steps; ++step) {
      RigEdits& edits = served_->live().edits();
      switch (std::uniform_int_distribution(0, 19)(random_)) {
        case 0:
        case 1:
          change([&](auto done) { edits.undo(std::move(done)); });
          break;
        case 2:
          change([&](auto done) { edits.redo(std::move(done)); });
          break;
        case 3:
          save();
          break;
        case 4:
          full_.reset();
          if (std::bernoulli_distribution(0.3)(random_))
            full_.emplace(served_->live().session().journal()->bytes() +
                          std::uniform_int_distribution<std::uint64_t>(0, 300)(random_));
          break;
        case 5:
          now_ns_ += 2 * kSecond_ns;
          break;
        default:
          change([&](auto done) { edits.edit({edits_->next()}, std::move(done)); });
      }
      const bool failed = journal_->failed();
      served_->live().edits().look(ToolPose{}, now_ns_ += kSecond_ns / 50);
      served_->lookAfterJournal(now_ns_);
      if (std::bernoulli_distribution(0.3)(random_)) static_cast<void>(served_->live().journalHolds());
      if (std::bernoulli_distribution(0.3)(random_)) served_->live().session().saver()->wait();
      renewed += failed && !journal_->failed();
    }
    full_.reset();
  }
  // An end in good order, which keeps the journal.
  void end() {
    served_->live().close(LiveVolume::KeepJournal::kAlways);
    {
      const std::lock_guard lock(mutex_);
      known_at_end_ = known().state;
      journal_ = nullptr;
    }
    served_.reset();
  }

  std::vector<Cut> cuts;
  std::vector<std::uint64_t> states;  // what the volume was, from the start on, after each change
  std::vector<std::string> told;
  std::uint64_t lost_records = 0;
  int renewed = 0;

 private:
  void tell(const std::string& words) {
    const std::lock_guard lock(mutex_);
    told.push_back(words);
  }
  template <typename Ask>
  void change(const Ask& ask) {
    bool is_made = false;
    ask([&](const std::optional<Error>& refusal) { is_made = !refusal; });
    served_->live().edits().look(ToolPose{}, now_ns_);
    if (is_made) noteState();
  }
  void noteState() {
    const Engine& engine = served_->live().engine();
    Volume volume = loadVolume("phantom:sphere?size=16");
    const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
    for (std::uint32_t brick = 0; brick < static_cast<std::uint32_t>(grid.brickCount()); ++brick)
      putBrick(volume, grid.brick(brick), engine.content(brick).values);
    const std::lock_guard lock(mutex_);
    states.push_back(contentHash(volume));
    at_record_[served_->live().session().journal()->appended()] = states.size() - 1;
  }
  void save() {
    const std::size_t state = states.size() - 1;
    served_->live().save((place_ / "out.vdb").string(), 0, [this, state](const LiveVolume::Saved& saved) {
      const std::lock_guard lock(mutex_);
      if (saved.written) saved_ = state;
    });
  }
  // Under the lock.
  [[nodiscard]] Known known() const {
    Known known{.state = known_at_end_, .saved_state = saved_};
    if (journal_ == nullptr) return known;
    const auto next = at_record_.upper_bound(journal_->acknowledged());
    if (next != at_record_.begin()) known.state = std::prev(next)->second;
    return known;
  }

  const fs::path place_;
  std::mt19937 random_;
  std::mutex mutex_;  // guards what the saver's thread and the journal's use, too
  std::map<std::uint64_t, std::size_t> at_record_;
  std::optional<std::size_t> saved_;
  const JournalWriter* journal_ = nullptr;
  std::size_t known_at_end_ = 0;
  std::int64_t now_ns_ = 0;
  std::optional<RandomEdits> edits_;
  std::optional<FileSizeLimit> full_;
  std::optional<ServedEngine> served_;
};

void writeFigures(const Counts& counts, int wanted, double seconds) {
  BenchResult result = beginEndurance("power-cuts", runPalpate({.arguments = {"--version"}}).out,
                                      fmt::format("./dev kills {}", wanted / 20));
  result.rows.push_back({{"part", "all"},
                         {"cuts", counts.cuts},
                         {"sessions", counts.sessions},
                         {"changes", static_cast<std::int64_t>(counts.changes)},
                         {"cuts_with_acknowledged_changes", counts.with_edits},
                         {"acknowledged_changes", static_cast<std::int64_t>(counts.acknowledged)},
                         {"cuts_at_checkpoints", counts.at_checkpoints},
                         {"cuts_at_saved_files", counts.at_saves},
                         {"cuts_of_a_journal_begun_anew_or_helped_by_a_checkpoint", counts.from_checkpoints},
                         {"journals_begun_anew", counts.renewed},
                         {"told_of_records_lost", counts.told_of_losses},
                         {"missing", counts.missing},
                         {"files_neither_old_nor_whole", counts.other_files},
                         {"time_s", seconds}});
  result.targets.push_back({"cuts after which an acknowledged change is missing", 1. * counts.missing, 0});
  result.targets.push_back({"cuts after which a saved file is neither old nor whole", 1. * counts.other_files, 0});
  const auto line = [](const char* what, auto count) { return fmt::format("{:70}{:>9}\n", what, count); };
  writeEndurance(
      result, "What a power cut costs", kIntroduction,
      line("cuts", counts.cuts) + line("sessions, each from what a cut of the last one left", counts.sessions) +
          line("edits, undos and redos in them", counts.changes) +
          line("cuts where some of the session's own were acknowledged", counts.with_edits) +
          line("cuts at a checkpoint's file", counts.at_checkpoints) + line("cuts at a saved file", counts.at_saves) +
          line("cuts whose journal begins with bricks, or has a checkpoint", counts.from_checkpoints) +
          line("journals that began anew, after a full disk", counts.renewed) +
          line("cuts after which an acknowledged change is missing", counts.missing) +
          line("cuts after which a saved file is neither old nor whole", counts.other_files) +
          line("cuts where recovery says that records are lost, though none was acknowledged", counts.told_of_losses));
}

// What `recover` makes of the journal in an image; empty: there is none.
std::optional<std::uint64_t> recovered(const fs::path& place, Counts& counts) {
  const fs::path folder = countingJournal(place / "journal");
  if (!fs::exists(journalFile(folder))) return std::nullopt;
  Volume volume = loadVolume("phantom:sphere?size=16");
  const Journal journal = readJournal(folder);
  const Recovered found = recoverSession(journal, checkpointFolder(folder), volume);
  counts.told_of_losses += found.lost_records > 0;
  counts.from_checkpoints += !found.before.empty() || found.begins_with_bricks;
  makeEdits(found.edits, journal.header.profile, volume);
  return contentHash(volume);
}

std::optional<std::uint64_t> savedIn(const fs::path& place) {
  if (!fs::exists(place / "out.vdb")) return std::nullopt;
  return contentHash(loadVolume((place / "out.vdb").string()));
}

// Whether one of the states from `first` on is this.
bool isOneOf(const std::vector<std::uint64_t>& states, std::size_t first, std::uint64_t content) {
  return std::find(states.begin() + static_cast<std::ptrdiff_t>(first), states.end(), content) != states.end();
}

struct Before {
  std::optional<std::uint64_t> state, saved;
};

// `place` is made for it, and removed.
void check(const Cut& one, const std::vector<std::uint64_t>& states, const Before& before, const fs::path& place,
           const std::string& of, Counts& counts) {
  const auto& [image, known] = one;
  image.write(place);
  const std::string what = of + ", " + image.moment;
  counts.with_edits += known.state > 0;
  counts.acknowledged += known.state;
  counts.at_checkpoints += image.moment.find("checkpoint") != std::string::npos;
  counts.at_saves += image.moment.find("out.vdb") != std::string::npos;
  try {
    const std::optional<std::uint64_t> back = recovered(place, counts);
    const bool is_there = back ? isOneOf(states, known.state, *back) : !before.state && known.state == 0;
    EXPECT_TRUE(is_there) << what << ": older than state " << known.state << " of " << states.size();
    counts.missing += !is_there;
    const std::optional<std::uint64_t> saved = savedIn(place);
    const bool is_whole = (saved == before.saved && !known.saved_state) ||
                          (saved && isOneOf(states, known.saved_state.value_or(0), *saved));
    EXPECT_TRUE(is_whole) << what << ": the saved file";
    counts.other_files += !is_whole;
  } catch (const Error& error) {
    ADD_FAILURE() << what << ": " << error.what();
    ++counts.missing;
  }
  fs::remove_all(place);
}

TEST(PowerCuts, LoseNothingThatWasAcknowledged) {
  const Stopwatch watch;
  const int wanted = static_cast<int>(numberOf("PALPATE_POWER_CUTS", 150));
  Counts counts;
  std::mt19937 random(7);
  std::optional<UnsyncedDisk::Image> left;  // by the last cut
  for (unsigned seed = 1; counts.cuts < wanted; ++seed, ++counts.sessions) {
    const TemporaryFolder folder;
    const fs::path place = folder.path() / "disk";
    fs::create_directory(place);
    if (left && seed % 4 != 1) {
      left->write(place);
    } else {
      left.reset();
    }
    // Two in turn: what the first has not synced is still not there for the second.
    std::function<void(UnsyncedDisk::Image)> cut;
    UnsyncedDisk disk(place, seed, 3, [&cut](UnsyncedDisk::Image image) { cut(std::move(image)); });
    for (const unsigned turn : {0U, 1U}) {
      Counts ignored;
      const std::optional<std::uint64_t> begins = recovered(place, ignored), saved_before = savedIn(place);
      PoweredSession session(place, 2 * seed + turn, cut);
      if (begins) {
        ASSERT_EQ(session.states.at(0), *begins) << "session " << seed;
      }
      session.run(150);
      session.end();
      counts.renewed += session.renewed;
      counts.changes += session.states.size();
      ASSERT_FALSE(session.cuts.empty());
      const std::string what = fmt::format("session {}, {}", seed, turn);
      for (std::size_t i = 0; i < session.cuts.size() && counts.cuts < wanted; ++i, ++counts.cuts)
        check(session.cuts[i], session.states, {begins, saved_before}, folder.path() / "cut", what, counts);
      left = session.cuts[std::uniform_int_distribution<std::size_t>(0, session.cuts.size() - 1)(random)].image;
    }
  }
  EXPECT_GE(counts.with_edits, wanted / 2);
  EXPECT_GE(counts.at_checkpoints, wanted / 100);
  EXPECT_GE(counts.at_saves, wanted / 30);
  EXPECT_GE(counts.renewed, wanted / 100);
  writeFigures(counts, wanted, watch.seconds());
}

}  // namespace power_cuts_test
}  // namespace palpate
