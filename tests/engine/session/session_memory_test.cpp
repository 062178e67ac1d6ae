// SPDX-License-Identifier: Apache-2.0
// Memory that fails while an edit comes to its end: who called must know whether it was applied, and the journal must
// have it then or end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/journal/replay.hpp"
#include "engine/session/edit_session.hpp"
#include "failing_memory.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace session_memory_test {

constexpr std::size_t kHistoryBytes = std::size_t{1} << 24U;

struct Journalled {
  TemporaryFolder folder;
  Volume volume = sampleVolume();
  JournalHeader header = sampleHeader(volume);
  Engine engine;
  EditSession session;

  Journalled() : engine(volume, makePlan({}), 30, ""), session(engine, header.profile, {}, kHistoryBytes) {
    engine.publishAround(volume.lattice().toWorld({13, 10, 9}), 0);
    session.keepJournal(folder.path(), header.volume);
  }
  void edit(double radius_m) {
    EditCommand command;
    command.from_W = command.to_W = volume.lattice().toWorld({13, 10, 9});
    command.radius_m = radius_m;
    session.edit({&command, 1}, 0);
  }
  std::uint64_t hash() {
    engine.readBack(volume);
    return contentHash(volume);
  }
};

// From the last allocation of an edit back to those that the engine makes when its kernels have run; before them it is
// broken and gives nothing away any more (tests/engine/service/editor_failure_test.cpp).
TEST(SessionMemory, AnEditIsJournalledOrEndsTheJournal) {
  std::size_t last = 0;
  {
    Journalled probe;
    probe.edit(2e-3);
    const std::size_t before = failing_memory::allocations;
    probe.edit(3e-3);
    last = failing_memory::allocations - before;
  }
  int ended = 0;
  for (std::size_t n = last; n > 0; --n) {
    Journalled s;
    s.edit(2e-3);
    const std::uint64_t first = s.hash();
    bool threw = false;
    failing_memory::failAfter(n);
    try {
      s.edit(3e-3);
    } catch (const std::bad_alloc&) {
      threw = true;
    }
    failing_memory::failNoMore();
    if (s.engine.broken()) break;
    const bool failed = s.session.journal()->failed();
    if (threw) {
      EXPECT_TRUE(failed) << n;
    } else {
      EXPECT_NE(s.hash(), first) << n;
      ended += failed ? 1 : 0;
    }
    EXPECT_EQ(s.session.history().steps(), 2U) << n;
    const std::uint64_t second = s.hash();
    s.session.undo(0);
    EXPECT_EQ(s.hash(), first) << n;
    s.session.redo(0);
    EXPECT_EQ(s.hash(), second) << n;
    s.session.close();
    Volume replayed = sampleVolume();
    replay(readJournal(s.folder.path()), replayed);
    EXPECT_EQ(contentHash(replayed), failed ? first : second) << n;
  }
  EXPECT_GE(ended, 1);
}

}  // namespace session_memory_test
}  // namespace palpate
