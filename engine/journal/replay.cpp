// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/replay.hpp"

#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/reference/edit.hpp"

namespace palpate {

std::vector<LastingEdit> lastingEdits(const Journal& journal) {
  std::vector<const JournalRecord*> edits;  // done, then undone
  std::size_t done = 0;
  for (const JournalRecord& record : journal.records) {
    if (record.kind == RecordKind::kUndo) --done;
    if (record.kind == RecordKind::kRedo) ++done;
    if (record.kind != RecordKind::kEdit && record.kind != RecordKind::kEditOn) continue;
    edits.resize(done);
    edits.push_back(&record);
    ++done;
  }
  std::vector<LastingEdit> lasting;
  for (std::size_t i = 0; i < done; ++i)
    lasting.push_back({edits[i]->commands, i > 0 && edits[i]->kind == RecordKind::kEditOn});
  return lasting;
}

EditTrail trailAfter(const EditMark& start, std::span<const LastingEdit> edits) {
  EditTrail trail(start);
  for (const LastingEdit& edit : edits) {
    trail.edit(edit.commands, false);
    trail.forgetAllBut(0);
  }
  return trail;
}

void checkStart(const Journal& journal, const Volume& volume, const std::string& input) {
  const std::string difference = differenceFrom(journal.header.volume, volume);
  if (difference.empty()) return;
  throw Error(Error::Code::kBadInput, input, "it is not the volume that the journal began with: " + difference,
              "give that volume with --volume (the journal names " + journal.header.volume.source + ")");
}

void makeEdits(std::span<const LastingEdit> edits, const BrushProfile& profile, Volume& volume,
               const std::function<void(double)>& before_each) {
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (before_each) before_each(static_cast<double>(i) / static_cast<double>(edits.size()));
    reference::applyEdits(volume, lowerEdits(edits[i].commands, volume.size(), volume.lattice(), profile));
  }
}

void replay(const Journal& journal, Volume& volume, const std::function<void(double)>& before_each) {
  checkStart(journal, volume, volume.facts().source);
  if (journal.base && fit(journal.base->bricks, volume)) putBricks(journal.base->bricks, volume);
  makeEdits(lastingEdits(journal), journal.header.profile, volume, before_each);
}

}  // namespace palpate
