// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/edit_trail.hpp"

#include <vector>

#include "engine/journal/byte_stream.hpp"

namespace palpate {

EditTrail::EditTrail(const JournalHeader& header) {
  JournalHeader nameless = header;
  nameless.volume.source.clear();
  nameless.id = 0;
  marks_.push_back({0, bytesHash(headerBytes(nameless))});
}

EditMark EditTrail::after(const EditMark& before, std::span<const EditCommand> commands) {
  ByteWriter bytes;
  bytes.add(before.hash);
  bytes.addRaw(editContent(commands, std::vector<std::uint32_t>(commands.size())));
  for (const EditCommand& command : commands) {
    if (!isStamp(command.kind) || !command.stamp) continue;
    if (command.stamp != last_stamp_) {
      last_stamp_hash_ = bytesHash(stampContent(*command.stamp));
      last_stamp_ = command.stamp;
    }
    bytes.add(last_stamp_hash_);
  }
  return {before.edits + 1, bytesHash(bytes.bytes())};
}

void EditTrail::edit(std::span<const EditCommand> commands, bool goes_on) noexcept {
  try {
    const EditMark next = after(marks_[at_], commands);
    marks_.resize(at_ + 1);
    if (goes_on && at_ > 0) {
      marks_[at_] = next;
      return;
    }
    marks_.push_back(next);
    ++at_;
  } catch (...) {
    lost_ = true;
  }
}

void EditTrail::undo() noexcept {
  if (at_ == 0) lost_ = true;  // further than it remembers
  if (!lost_) --at_;
}

void EditTrail::redo() noexcept {
  if (at_ + 1 >= marks_.size()) lost_ = true;
  if (!lost_) ++at_;
}

void EditTrail::forgetAllBut(std::size_t steps) noexcept {
  for (; at_ > steps; --at_) marks_.pop_front();
}

std::optional<EditMark> EditTrail::mark() const noexcept {
  return lost_ ? std::nullopt : std::optional(marks_[at_]);
}

}  // namespace palpate
