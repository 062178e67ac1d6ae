// SPDX-License-Identifier: Apache-2.0
// A session over the sample volume of the journal's tests, with a window around a place in it.
#pragma once

#include "engine/session/edit_session.hpp"
#include "journal_samples.hpp"

namespace palpate {

inline constexpr std::size_t kMuch = std::size_t{1} << 30U;

struct Session {
  Volume volume = sampleVolume();
  JournalHeader header = sampleHeader(volume);
  Engine engine;
  EditSession session;

  explicit Session(std::size_t history_bytes = kMuch)
      : engine(volume, makePlan({}), 30, ""), session(engine, header.profile, {}, history_bytes) {
    engine.publishAround(volume.lattice().toWorld({13, 10, 9}), 0);
  }
  std::uint64_t hash() {
    engine.readBack(volume);
    return contentHash(volume);
  }
};

}  // namespace palpate
