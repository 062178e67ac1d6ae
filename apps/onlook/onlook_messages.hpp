// SPDX-License-Identifier: Apache-2.0
// apps/onlook/onlook_messages.hpp: what a service and a window that looks on tell each other, as messages and back
// (service/messages). Any thread; allocates.
//
// What comes back is checked: sizes, counts and enumerations are some, numbers are finite. Error(kBadInput) says what
// is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "apps/onlook/seen_volume.hpp"
#include "apps/rig/live_view.hpp"
#include "apps/rig/rig_edits.hpp"
#include "apps/servo_setup/rig_settings.hpp"
#include "engine/plan/plan.hpp"
#include "service/memory/view_memory.hpp"
#include "service/messages/message.hpp"
#include "servo/devices/force_off.hpp"
#include "shaders/picture.layout.h"

namespace palpate {

// Of the memory that they share: any picture that can be drawn, and ticks of some seconds.
inline constexpr ViewMemory::Room kOnlookRoom{.pixels = PICTURE_MOST_PIXELS, .ticks = 8192};

// What is served.
struct ServedFacts {
  SeenVolume volume;
  std::string device;
  bool device_is_held = false;  // by a person: no pointer leads it
  bool keeps_journal = false;
  std::vector<PlanLine> plan;
  RigSettings settings;
};
inline constexpr std::size_t kMostObjectPoints = 1000;  // of volume.object that are told
[[nodiscard]] std::unique_ptr<wire::FactsT> wireOf(const ServedFacts& facts);
[[nodiscard]] ServedFacts factsOf(const std::unique_ptr<wire::FactsT>& wire);

// How it goes.
struct Looked {
  bool has_servo = false;
  bool can_edit = false;
  ForceOff force_off = ForceOff::kNone;
  RigEdits::State edits;        // `steps`: the newest kMostSteps, if has_steps
  bool has_steps = false;       // they may have changed
  std::size_t older_steps = 0;  // before `edits.steps`
  RigSettings settings;
  std::string drawing_failure;  // why the picture is not the one that was asked for; empty: it is
  std::string journal_failure;
};
inline constexpr std::size_t kMostSteps = 4000;  // that are told
[[nodiscard]] std::unique_ptr<wire::LookedT> wireOf(const Looked& looked);
[[nodiscard]] Looked lookedOf(const std::unique_ptr<wire::LookedT>& wire);

[[nodiscard]] std::unique_ptr<wire::ViewT> wireOf(const ViewRequest& view);
[[nodiscard]] ViewRequest viewOf(const std::unique_ptr<wire::ViewT>& wire);

}  // namespace palpate
