// SPDX-License-Identifier: Apache-2.0
// apps/bench/tick_cost.hpp: what a tick of each algorithm costs, all in one process and interleaved.
//
// Every repetition goes round all entrants, beginning with another one each time, and replays the whole slide of the
// path for each, so that what the machine does meanwhile meets all alike. Two measures:
//   batch: the clock is read before and after a replay only, so its own cost stays out (25 ns in thousands of ticks).
//     The HIP of each tick is hip + 0 * (force of the last tick): in a loop a tick ends before the next one begins, and
//     without this the processor would overlap them. The chain costs some 3 ns a tick, the call through the interface
//     and the reading of the path some more; `harnessCost_ns` is all of that with an algorithm that does nothing, and
//     it is NOT taken off.
//   single ticks: the clock is read after each tick, its median cost is taken off. Of each tick the fastest of all
//     replays counts, which leaves what the algorithm does there and drops what the machine does; `raw` has every
//     replay of every tick.
// Windows are gathered beforehand, around the tool and around the exact surface under it, each algorithm gets those
// that it asks for (windowPlace), and they are handed over by pointer as the exchange does, so a change of window costs
// what it costs in the servo (the cache misses of its first samples) and no gathering is timed. One thread: the
// caller's.
#pragma once

#include <span>
#include <vector>

#include "apps/bench/columns.hpp"
#include "apps/bench/contact_path.hpp"
#include "apps/bench/entrants.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

// A path with the windows that a servo would have along it, all in memory.
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

  // Resets the algorithm, lets it go through the approach untimed, then times the slide: mean cost of a tick [ns].
  [[nodiscard]] double replay_ns(Algorithm& algorithm) const;
  // The same, with the cost of each tick of the slide with the clock's own taken off [ns]; adds to `raw` and lowers
  // `fastest` (both as long as the slide).
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

[[nodiscard]] const Columns<TickCost>& costColumns();  // as rows have them

struct CostRequest {
  int repetitions = 15;  // of the batch
  int tick_replays = 5;  // with single ticks timed
};

// One result for each entrant.
[[nodiscard]] std::vector<TickCost> tickCosts(const ReplayPath& path, std::span<Entrant> entrants,
                                              const CostRequest& request, const BenchProgress& progress);

[[nodiscard]] double clockCost_ns();                          // median cost of reading the clock [ns]
[[nodiscard]] double harnessCost_ns(const ReplayPath& path);  // of a tick that does nothing [ns]

// Middle, and the quartiles as its spread.
struct Spread {
  double median = 0, low = 0, high = 0;
};
[[nodiscard]] Spread spreadOf(std::vector<double> values);

}  // namespace palpate
