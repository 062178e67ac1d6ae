// SPDX-License-Identifier: Apache-2.0
// apps/tune/workbench.hpp: feels a scene with one candidate after another, as `palpate touch` would, by the simulated
// clock.
//
// The volume is loaded once, and engines are kept for further trials while there is memory (shelf.hpp). Whatever device
// the scene names, trials are felt with the simulated one: nobody's hand can repeat its way. As in `palpate touch`, a
// path is built from the surface that is felt, so another filter has another path. For these, what the scene leaves to
// the program is fixed to what it chose for the scene itself: place, direction and lengths. So all candidates are felt
// at the same place. A tool that edits is felt without its brush. One thread. A trial blocks for as long as the
// simulated run takes, some milliseconds a second; making an engine takes longer.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/servo_setup/scene_objects.hpp"
#include "apps/touch/scripted_path.hpp"
#include "apps/tune/candidate.hpp"
#include "apps/tune/shelf.hpp"
#include "apps/tune/truth.hpp"
#include "engine/field/volume.hpp"
#include "engine/service/engine.hpp"

namespace palpate {

// Engines that are kept: so many, and at most this share of the main memory that is free.
struct ShelfRoom {
  std::size_t engines = 8;
  double share = 0.25;
};

class Workbench {
 public:
  // Loads the volume. Throws Error as `palpate touch` does.
  Workbench(const Scene& scene, Progress& progress, const ShelfRoom& room = {});
  ~Workbench();

  // Why the exact surface is not known; empty: it is.
  [[nodiscard]] const std::string& whyNotExact() const noexcept { return why_not_exact_; }
  [[nodiscard]] int longestEdge() const { return volume_.size().maxCoeff(); }            // [voxel]
  [[nodiscard]] const std::string& deviceName() const noexcept { return device_name_; }  // of Vulkan, after a trial
  // Where the exact surface is not known: how the truest settings store samples, "half" if there is no room for floats.
  [[nodiscard]] const std::string& truthSamples() const noexcept { return truth_samples_; }

  // The scene with a candidate's settings and, if its filter is another one, with the path fixed as above.
  [[nodiscard]] Scene sceneOf(const Candidate& candidate);

  // Throws Error. A candidate that cannot be felt only because it differs from the scene gives Trial::impossible.
  [[nodiscard]] Trial feel(const Candidate& candidate);
  // The same from scratch: with a new engine, field and path, as a new process would.
  [[nodiscard]] Trial feelAnew(const Candidate& candidate);
  // Gives back what is kept for further trials.
  void emptyShelf() noexcept { shelf_.clear(); }

 private:
  struct Ground;
  struct Made;
  [[nodiscard]] std::shared_ptr<Made> make(const Candidate& candidate);
  [[nodiscard]] std::shared_ptr<Ground> groundOf(Engine& engine, const Scene& scene);
  [[nodiscard]] std::shared_ptr<Ground> keptGround(const Candidate& candidate);
  [[nodiscard]] Scene trialScene(const Candidate& candidate);
  [[nodiscard]] std::shared_ptr<Made> shelved(const Candidate& candidate);
  [[nodiscard]] std::shared_ptr<Made> truestMade(Scene& scene);
  [[nodiscard]] Trial trialOf(const Candidate& candidate, std::shared_ptr<Made> made, Ground& ground);
  [[nodiscard]] std::vector<TickRecord> feelTruest(const std::vector<TickRecord>& along);
  [[nodiscard]] std::unique_ptr<Truth> newTruth();
  template <typename Work>
  [[nodiscard]] Trial orImpossible(const Candidate& candidate, const Work& work) const;
  [[nodiscard]] bool isAsGiven(const Candidate& candidate) const;

  Scene given_;
  Scene scene_;  // the same with the simulated clock and device, and without a brush
  SceneObjects objects_;
  Volume volume_;
  double isovalue_ = 0;
  std::string why_not_exact_, device_name_, truth_samples_;
  std::map<std::string, std::shared_ptr<Ground>> grounds_;  // by filter
  std::unique_ptr<Engine> tiny_;                            // keeps the Vulkan driver loaded
  std::set<std::string> kinds_made_;                        // of engines, by filter, operator and storage
  Shelf<Made> shelf_;
};

}  // namespace palpate
