// SPDX-License-Identifier: Apache-2.0
// engine/journal/replay.hpp: the volume that a journal's session had: its starting volume and the edits that were not
// undone, through the CPU twin. Bit for bit what the session's GPU held. Any thread. Cost: follows the edits.
#pragma once

#include <functional>

#include "engine/journal/journal_reader.hpp"

namespace palpate {

// The edits that count, in order: each undo takes back the last, so what is left gives the volume.
[[nodiscard]] std::vector<std::vector<EditCommand>> lastingEdits(const Journal& journal);

// Throws Error(kBadInput) unless `volume` is the one that the journal began with; `input` names it in the message.
void checkStart(const Journal& journal, const Volume& volume, const std::string& input);

// Applies them to the volume that the journal began with. Throws as checkStart does. `before_each` is called before
// each edit with the share of them that is done, [0, 1); what it throws ends the replay.
void replay(const Journal& journal, Volume& volume, const std::function<void(double)>& before_each = {});

}  // namespace palpate
