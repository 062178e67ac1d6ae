// SPDX-License-Identifier: Apache-2.0
// apps/touch/live_edits.hpp: the edits of a run: the servo's tool drives a brush through an editing session.
//
// Thread: made and finished by the job's thread, in between the engine's. An edit that the engine refuses (no memory
// left, say) ends the editing and not the run; a journal that fails ends the journal and not the editing. Both are told
// at once, on stderr, and in the run's notes.
#pragma once

#include <string>
#include <vector>

#include "apps/report/touch_run.hpp"
#include "engine/plan/scene.hpp"
#include "engine/session/edit_session.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {

// Throws Error(kBadInput) on an --edit or --journal that cannot be meant, before any volume is loaded.
void checkEditOptions(const Scene& scene);

class LiveEdits {
 public:
  // `scene.isovalue` is the one in use. Throws Error: a brush that does not fit the volume, a journal that cannot be
  // kept there.
  LiveEdits(const Scene& scene, const Volume& volume, Engine& engine);

  // With every look at the tool; edits when one is due.
  void follow(const ToolPose& pose, std::int64_t now_ns);

  // After the run: waits for the journal. Adds what went wrong to `notes`.
  [[nodiscard]] RunEdits finish(std::vector<std::string>& notes);

 private:
  void tell(const std::string& trouble);

  ToolBrush brush_;
  EditSession session_;
  std::vector<std::string> troubles_;
  bool editing_ = true;
  bool journal_failed_ = false;
};

}  // namespace palpate
