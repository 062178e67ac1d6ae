// SPDX-License-Identifier: Apache-2.0
// apps/bench/tick_cost.hpp: the cost of a tick of each algorithm, measured in one process and interleaved.
//
// Each repetition replays the whole slide of the path for every entrant, and begins with a different entrant. So other
// load on the machine meets all alike. There are two measures:
//   batch: the clock is read only before and after a replay, so its own cost (25 ns in thousands of ticks) stays out.
//     The HIP of each tick is hip + 0 * (force of the last tick). Without this dependency the processor would overlap
//     ticks, which it cannot do in a loop. harnessCost_ns() is the cost of this dependency (some 3 ns), of the virtual
//     call and of reading the path. It is NOT subtracted.
//   single ticks: the clock is read after each tick, and its median cost is subtracted. The fastest replay of each tick
//     counts: this keeps the cost of the algorithm and drops that of other load. `raw` has every replay of every tick.
//
// Windows are gathered beforehand, around the tool and around the exact surface under it; windowPlace() decides which
// of them a tick gets. They are passed by pointer, as the exchange does. So a change of window costs the same as in the
// servo (cache misses), and no gathering is timed. One thread: the caller's.
#pragma once

#include <span>
#include <vector>

#include "apps/bench/columns.hpp"
#include "apps/bench/contact_path.hpp"
#include "apps/bench/entrants.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

// A path in memory, with the windows that a servo would have along it.
class ReplayPath {
 public:
  ReplayPath(const BenchVolume& volume, ContactPath path);
  ReplayPath(const ReplayPath&) = delete;
  ReplayPath& operator=(const ReplayPath&) = delete;
  ReplayPath(ReplayPath&&) = default;
  ReplayPath& operator=(ReplayPath&&) = default;

  [[nodiscard]] const ContactPath& path() const noexcept { return path_; }
  [[nodiscard]] std::size_t windows() const noexcept { return windows_.size(); }  // around the tool and the surface
  [[nodiscard]] std::size_t slideTicks() const noexcept { return ticks_.size() - path_.slide_begin; }

  // Resets the algorithm, replays the approach untimed, and times the slide. Returns the mean cost of a tick [ns].
  [[nodiscard]] double replay_ns(Algorithm& algorithm) const;
  // The same for single ticks of the slide: appends their costs without the clock's own to `raw` [ns], and lowers the
  // tick's entry in `fastest`, which is as long as the slide.
  void replayTicks(Algorithm& algorithm, double clock_ns, std::vector<double>& fastest, std::vector<double>& raw) const;

 private:
  struct Tick {
    Vec3 hip_W, velocity_W;
    const SampleWindow* at_tool;
    const SampleWindow* at_surface;
  };
  [[nodiscard]] TickOutput approach(Algorithm& algorithm) const;
  [[nodiscard]] std::vector<std::size_t> gather(const BenchVolume& volume, bool at_surface);
  ContactPath path_;
  std::vector<std::vector<Sample>> samples_;
  std::vector<SampleWindow> windows_;
  std::vector<Tick> ticks_;
};

struct TickCost {
  std::vector<double> batch_ns;  // mean cost of a tick in each repetition [ns]
  Percentiles fastest_ns;        // over ticks, the fastest replay of each [ns]
  Percentiles raw_ns;            // over all replays of all ticks [ns]
};

[[nodiscard]] const Columns<TickCost>& costColumns();

struct CostRequest {
  int repetitions = 15;  // replays for the batch measure
  int tick_replays = 5;  // replays with single ticks timed
};

// One result for each entrant.
[[nodiscard]] std::vector<TickCost> tickCosts(const ReplayPath& path, std::span<Entrant> entrants,
                                              const CostRequest& request, const BenchProgress& progress);

[[nodiscard]] double clockCost_ns();                          // median cost of reading the clock [ns]
[[nodiscard]] double harnessCost_ns(const ReplayPath& path);  // cost of a tick that does nothing [ns]

// Median and quartiles.
struct Spread {
  double median = 0, low = 0, high = 0;
};
[[nodiscard]] Spread spreadOf(std::vector<double> values);

}  // namespace palpate
