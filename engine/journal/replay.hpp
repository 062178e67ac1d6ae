// SPDX-License-Identifier: Apache-2.0
// engine/journal/replay.hpp: rebuilds the volume of a journal's session. The CPU twin applies the edits that were not
// undone to the volume that the session began with. The result equals what the GPU held, bit for bit. Any thread. Cost:
// depends on the edits.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/journal/edit_trail.hpp"
#include "engine/journal/journal_reader.hpp"

namespace palpate {

// An edit that is in effect at the end of a journal.
struct LastingEdit {
  std::vector<EditCommand> commands;
  bool goes_on = false;  // it is undone together with the one before
};
// All of them, in order.
[[nodiscard]] std::vector<LastingEdit> lastingEdits(const Journal& journal);

// What names the state after them all, which were made one by one from `start` on. Nothing can be undone in it.
[[nodiscard]] EditTrail trailAfter(const EditMark& start, std::span<const LastingEdit> edits);

// Throws Error(kBadInput) unless `volume` is the one that the journal began with; `input` names it in the message.
void checkStart(const Journal& journal, const Volume& volume, const std::string& input);

// Applies the edits to `volume`. `before_each` is called before each edit with the fraction done, [0, 1). It may throw
// to cancel.
void makeEdits(std::span<const LastingEdit> edits, const BrushProfile& profile, Volume& volume,
               const std::function<void(double)>& before_each = {});
// All that a whole journal says, to the volume that it began with. Throws as checkStart() does, with the volume's name
// as `input`.
void replay(const Journal& journal, Volume& volume, const std::function<void(double)>& before_each = {});

}  // namespace palpate
