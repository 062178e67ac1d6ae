// SPDX-License-Identifier: Apache-2.0
// apps/serve/served_engine.hpp: what a service makes of its scene: the volume on the engine, with its editing session
// and journal.
//
// The engine can be made anew below it: after the device was lost, or with other filters. Threads: as LiveVolume; of
// the rest, makeAnew() changes what depends on the filters, and nothing else changes.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/live/live_volume.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/scene/scene.hpp"
#include "apps/serve/kept_journal.hpp"
#include "apps/servo_setup/rig_volume.hpp"
#include "engine/plan/plan.hpp"

namespace palpate {

// Throws Error(kBadInput) for a scene that cannot be served, as with a simulated clock, a recording, a brush of its own
// or an algorithm that touches a mesh, which would not follow the edits; and for options that mean nothing to a
// service.
void checkServable(const Scene& scene);
// The same for the algorithm alone.
void checkFollowsEdits(const std::string& algorithm, const std::string& input);

// The plan of a service of this scene. Throws Error(kBadInput) as makePlan() does.
[[nodiscard]] Plan servedPlan(Scene scene);

class ServedEngine {
 public:
  using Tell = std::function<void(const std::string&)>;
  // `journal`: its folder; empty: none. Throws Error: as LiveVolume and KeptJournal do; of a journal that does not fit
  // the volume it says what to do with it. `look`: LiveVolumeRequest.
  ServedEngine(const Scene& scene, const std::filesystem::path& journal, Progress& progress, const Tell& tell,
               const LiveVolumeRequest::Look& look = {});

  // Another engine, from the CPU's copy of the volume with every edit, for this scene's filters. Throws as
  // LiveVolume::makeEngineAnew().
  void makeAnew(const Scene& scene);

  // Call it often, in the engine's thread: a journal that failed may have begun anew, and then counts.
  void lookAfterJournal(std::int64_t now_ns);

  [[nodiscard]] LiveVolume& live() noexcept { return *live_; }
  [[nodiscard]] const LiveVolume& live() const noexcept { return *live_; }
  [[nodiscard]] const Vec3i& size() const noexcept { return size_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] const SeenExtent& seen() const noexcept { return seen_; }  // of the object, as it was at first
  [[nodiscard]] const DensityScale& scale() const noexcept { return scale_; }
  // What the engine computes, and what it leaves out.
  [[nodiscard]] const std::vector<PlanLine>& plan() const noexcept { return plan_; }
  [[nodiscard]] bool canChangeIsovalue() const noexcept { return can_change_isovalue_; }
  [[nodiscard]] bool gradientEverywhere() const noexcept { return gradient_everywhere_; }

 private:
  void noteFelt(const Plan& plan);
  void takeOver();

  const Tell tell_;
  std::optional<KeptJournal> journal_;  // held as long as the session writes to it
  std::optional<LiveVolume> live_;
  bool journal_counts_ = false;       // and holds what the earlier one had
  std::uint64_t journal_mended_ = 0;  // JournalWriter::timesMended(), as of the last look
  std::int64_t next_take_over_ns_ = 0;
  std::string told_;  // why it does not
  std::string filter_;
  Vec3i size_;
  Lattice lattice_;
  SeenExtent seen_;
  DensityScale scale_, unfiltered_scale_;
  std::vector<PlanLine> plan_;
  bool can_change_isovalue_ = true, gradient_everywhere_ = false;
};

}  // namespace palpate
