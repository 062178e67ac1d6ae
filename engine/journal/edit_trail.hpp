// SPDX-License-Identifier: Apache-2.0
// engine/journal/edit_trail.hpp: names every state that the edits of a session lead through, so that a copy of the
// volume (checkpoint.hpp) can say of which one it is.
//
// A state's name is the number of edits in effect and a hash of the volume at the start and of these edits, in their
// order. It depends neither on what was undone in between nor on how a journal numbers its records and stamps. So a
// copy stays good when the edits in effect are written to another journal.
// Thread: one. Cost of an edit: its encoding, about 1 us, and of a stamp a pass over its distances.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>

#include "engine/journal/journal_format.hpp"

namespace palpate {

class EditTrail {
 public:
  // Of a volume and a profile, whatever the volume's file is called.
  explicit EditTrail(const JournalHeader& header);
  // Of a volume as other edits have made it.
  explicit EditTrail(const EditMark& start) { marks_.push_back(start); }

  // `goes_on`: it is undone together with the one before (EditHistory). An edit without memory for its mark ends the
  // trail: mark() is empty from then on.
  void edit(std::span<const EditCommand> commands, bool goes_on) noexcept;
  void undo() noexcept;  // takes back a step: an edit, and those that went on with it
  void redo() noexcept;
  // Only so many steps can be undone.
  void forgetAllBut(std::size_t steps) noexcept;

  [[nodiscard]] std::optional<EditMark> mark() const noexcept;

 private:
  [[nodiscard]] EditMark after(const EditMark& before, std::span<const EditCommand> commands);

  std::deque<EditMark> marks_;  // one for each step that can be undone or redone, after the one before them all
  std::size_t at_ = 0;          // the one in effect
  bool lost_ = false;
  std::shared_ptr<const Stamp> last_stamp_;  // of a row of dabs: it is hashed once
  std::uint64_t last_stamp_hash_ = 0;
};

}  // namespace palpate
