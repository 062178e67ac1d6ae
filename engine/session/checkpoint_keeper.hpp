// SPDX-License-Identifier: Apache-2.0
// engine/session/checkpoint_keeper.hpp: when a session writes which checkpoint (engine/journal/checkpoint.hpp), and of
// which bricks.
//
// One is due once the edits since the last one took 0.3 s to make. So a session that comes back from its journal makes
// edits of about twice that time again, however many there were. A large checkpoint comes less often: writing takes one
// twentieth of the time at most. One is also due where the journal begins with bricks: a damaged bit among them would
// cost all edits. Threads: the engine's; what writer() returns runs in the saver's, and until it is done
// no brick is noted and nothing else is asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "engine/journal/checkpoint.hpp"
#include "engine/session/edited_state.hpp"

namespace palpate {

class CheckpointKeeper {
 public:
  static constexpr double kEditsBetween_s = 0.3;
  static constexpr double kShareForWriting = 1. / 20;  // of the time, at most
  // `state` outlives this and knows of each change before this does. `journal`: JournalHeader::id. `held`: what
  // putCheckpoint() said of the volume that the session begins with; such files of the session before are written anew
  // soon, since they do not say that they are of this journal. `told` gets the words of a failure, once, in the saver's
  // thread: edits go on, and a later start takes longer.
  CheckpointKeeper(std::filesystem::path folder, const EditedState& state, std::uint64_t journal, const Headstart& held,
                   std::function<void(const std::string&)> told, double edits_between_s = kEditsBetween_s);

  // Every edit and undo that was made, in order.
  void edited(double seconds) noexcept;
  void undone() noexcept;
  // The journal begins with the volume as earlier edits have made it, and no other file has these: one is due.
  void journalBeganAnew() noexcept { is_alone_ = true; }
  // Whether one of these is due and can be written.
  [[nodiscard]] bool journalIsAlone() const noexcept { return is_alone_ && state_.mark(); }
  // At the end: what is due does not wait for its turn any more.
  void hurry() noexcept { hurries_ = true; }

  // When the saver's volume holds every change: whether it is to be written, and what does that with it. `sequence`: of
  // the journal's newest record. The keeper outlives the saver.
  [[nodiscard]] bool isDue(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::function<void(const Volume&)> writer(std::int64_t now_ns, std::uint64_t sequence);

 private:
  [[nodiscard]] std::size_t placeForNext() const noexcept;
  void write(const Volume& volume, const CheckpointHead& head, std::size_t place);

  std::filesystem::path folder_;
  const EditedState& state_;
  std::uint64_t journal_;
  std::function<void(const std::string&)> told_;
  double edits_between_s_;
  CheckpointMarks marks_;   // of the files; empty: it may be overwritten
  double edits_s_ = 0;      // that the newest checkpoint lacks
  bool is_others_ = false;  // the newest checkpoint is of the journal before
  bool is_alone_ = false;   // the journal has what no checkpoint has
  bool hurries_ = false;
  std::int64_t not_before_ns_ = std::numeric_limits<std::int64_t>::min();
  // Of the last one that was begun. The saver's thread writes them before it is ready again.
  struct Attempt {
    std::size_t place = 0;
    std::int64_t began_ns = 0;
    double seconds = 0;
    bool was_alone = false, failed = false;
    bool is_new = false;
  };
  Attempt attempt_;
  bool was_told_ = false;
};

}  // namespace palpate
