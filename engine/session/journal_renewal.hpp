// SPDX-License-Identifier: Apache-2.0
// engine/session/journal_renewal.hpp: when a journal that has ended, on a full disk or as its file was removed, begins
// anew from the volume as edits have made it (JournalWriter::beginAnew()).
//
// It is tried at once, and then every second, or less often where trying takes long: it takes one twentieth of the time
// at most, and half of it where somebody waits for an undo. Threads: the engine's; what begin() returns runs in the
// saver's, and until it is done nothing else is asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "engine/field/volume.hpp"
#include "engine/journal/journal_writer.hpp"
#include "engine/session/edited_state.hpp"

namespace palpate {

class JournalRenewal {
 public:
  // Both outlive this.
  JournalRenewal(JournalWriter& journal, EditedState& state) noexcept : journal_(journal), state_(state) {}

  [[nodiscard]] bool isDue(std::int64_t now_ns) const noexcept;
  // Whether it has begun anew since this was asked last.
  [[nodiscard]] bool takeBegun() noexcept { return std::exchange(has_begun_, false); }
  void hurry() noexcept { not_before_ns_ = undo_not_before_ns_ = kAtOnce; }
  // If it is due, when the saver's volume holds every change: what makes the file from that. It throws the first time
  // that it fails for a reason which the journal's failure does not name. One that is not called fails, too. `made`:
  // edits until now, undo and redo included. `in_effect`: those that are not undone.
  [[nodiscard]] std::function<void(const Volume&)> begin(std::int64_t now_ns, std::uint64_t made,
                                                         std::size_t in_effect);

 private:
  class Attempt;
  void makeFile(const EditMark& mark, const Volume& volume, std::int64_t began_ns);

  static constexpr std::int64_t kAtOnce = std::numeric_limits<std::int64_t>::min();
  JournalWriter& journal_;
  EditedState& state_;
  std::int64_t not_before_ns_ = kAtOnce;       // after a failure
  std::int64_t undo_not_before_ns_ = kAtOnce;  // where it has only come behind its beginning
  bool has_begun_ = false;
  std::string told_;  // why it failed last
};

}  // namespace palpate
