// SPDX-License-Identifier: Apache-2.0
// A contact that was unstable comes back softer. A change of the settings, or another engine, gives it the whole force
// again, and no faster than an edit that adds as much.
#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "changing_press.hpp"
#include "servo/contact/edit_ease.hpp"
#include "servo/safety/faults.hpp"
#include "support/seeded.hpp"
#include "wall_trials.hpp"

namespace palpate {
namespace changes_after_shaking_test {

constexpr double kRate_hz = 1000;
constexpr double kHold_s = 4, kAway_s = 1.5;  // how long the hand presses, and how long it is away

struct Given {
  std::int64_t tick;
  double stiffness_N_per_m;
};

// A hand with a spring that presses on a plane, goes away and comes back, and what happens meanwhile.
struct Shaking {
  double first_N_per_m = 20000;
  std::vector<Given> changes;     // of the stiffness
  std::optional<Given> takeover;  // another engine, with this stiffness
  double hand_depth_m = 2e-3;
  std::int64_t presses = 2;
  SimulatedDeviceParameters device;

  Shaking() { device.hand = Hand::kSpring; }
  [[nodiscard]] Vec3 handAt(double t_s) const {
    const double phase_s = std::fmod(t_s, kHold_s + kAway_s);
    const double in = std::clamp(phase_s / 0.3, 0.0, 1.0), out = std::clamp((phase_s - kHold_s) / 0.3, 0.0, 1.0);
    return {0, 0, 1e-3 - (1e-3 + hand_depth_m) * in + (4e-3 + hand_depth_m) * out};
  }
  [[nodiscard]] static bool pressed(double t_s) {
    const double phase_s = std::fmod(t_s, kHold_s + kAway_s);
    return phase_s > 0.5 && phase_s < kHold_s;
  }

  [[nodiscard]] std::vector<TickRecord> run() const {
    TouchScene scene;
    const auto wall = [](double stiffness) { return std::make_unique<GroundAlgorithm>(Ground{}, stiffness, 0); };
    const std::unique_ptr<Algorithm> first = wall(first_N_per_m);
    const WantedPath path([this](double t_s) { return handAt(t_s); });
    SimulatedDevice simulated(device, path, kRate_hz);
    LoopParameters p;
    p.ticks = std::llround(static_cast<double>(presses) * (kHold_s + kAway_s) * kRate_hz);
    p.safety.slew_limit_N_per_s = 1e7;
    p.safety.force_limit_N = 1e3;
    ServoLoop loop(p, *first, simulated, scene.windows, scene.tool);
    ServoChanges given;
    loop.takeChangesFrom(given);
    NextEngine next(scene, 100);
    ServoLinks links;
    loop.takeLinksFrom(links);
    ServoLink link{.windows = &next.servos_windows,
                   .tool = &next.servos_tool,
                   .algorithm = wall(takeover ? takeover->stiffness_N_per_m : 1),
                   .force_limit_N = 1e3};
    return loop
        .runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
          if (tick == 0) scene.publish(Vec3::Zero(), now_ns);
          scene.windows.confirm(now_ns);
          for (const Given& change : changes)
            if (tick == change.tick) given.give({.algorithm = wall(change.stiffness_N_per_m)});
          if (!takeover || tick < takeover->tick) return;
          if (tick == takeover->tick) links.give(link);
          if (tick == takeover->tick + 1) static_cast<void>(next.publish(now_ns));
          next.windows.confirm(now_ns);
        })
        .records;
  }
};

// K of the force that is felt, whatever the tool does: the walls have no damping.
double feltStiffness(const TickRecord& r) {
  return r.in_contact && r.depth_m > 1e-6 ? force(r).norm() / r.depth_m : 0;
}

struct Felt {
  double most_growth_N_per_m = 0, most_loss_N_per_m = 0;  // in a tick
  bool lost = false;                                      // a contact, while the hand pressed
};

// From `from` on. In a contact whose force fades nothing is judged but its growth.
Felt felt(const std::vector<TickRecord>& records, std::int64_t from) {
  Felt out;
  for (auto i = static_cast<std::size_t>(from) + 1; i < records.size(); ++i) {
    const TickRecord &now = records[i], &before = records[i - 1];
    const bool fades = ((now.faults | before.faults) & kFadingFaults) != 0;
    if (!fades && before.in_contact && !now.in_contact && Shaking::pressed(now.time_s)) out.lost = true;
    if (!(feltStiffness(now) > 0) || !(before.in_contact && before.depth_m > 1e-6)) continue;
    const double grown = feltStiffness(now) - feltStiffness(before);
    out.most_growth_N_per_m = std::max(out.most_growth_N_per_m, grown);
    if (!fades) out.most_loss_N_per_m = std::max(out.most_loss_N_per_m, -grown);
  }
  return out;
}

// Unstable at K, quiet at K / 4 and at the stiffness that the changes give.
Shaking anyShaking(Seeded& random) {
  Shaking run;
  const double bound = stiffnessBound({.hand = run.device.dynamics}, 0);
  run.first_N_per_m = random.between(1.5, 2.2) * bound;
  run.hand_depth_m = random.between(0.5e-3, 3e-3);
  return run;
}

double quietStiffness(const Shaking& run, Seeded& random) {
  return random.between(0.1, 0.6) * stiffnessBound({.hand = run.device.dynamics}, 0);
}

// An edit that adds the depth D takes it in over EditEase::kTime_s: K D / ticks each tick.
double editsStep(double added_N_per_m) {
  return added_N_per_m / EditEase(kRate_hz).ticks();
}

// Any number of changes at any time: while it shakes, while the force fades or is away, in the softer contact, one
// after the other. The largest change of stiffness is that between any two of those in use.
TEST(ServoLoopChanges, AfterAnUnstableContactComeAsAnEditThatAddsAsMuch) {
  Seeded random(81);
  int softer = 0;
  for (int i = 0; i < 40; ++i) {
    Shaking run = anyShaking(random);
    const int count = 1 + random.pick(3);
    std::int64_t tick = i % 2 == 0 ? 300 + random.pick(5700) : 6000 + random.pick(1000);
    double least = run.first_N_per_m / 4, most = least;
    for (int k = 0; k < count; ++k) {
      run.changes.push_back({tick, quietStiffness(run, random)});
      tick += 1 + random.pick(800);
      least = std::min(least, run.changes.back().stiffness_N_per_m);
      most = std::max(most, run.changes.back().stiffness_N_per_m);
    }
    const std::vector<TickRecord> records = run.run();
    const auto given = static_cast<std::size_t>(run.changes.front().tick);
    const bool was_ended = std::any_of(records.begin(), records.begin() + run.changes.front().tick,
                                       [](const auto& r) { return has(r.faults, ServoFault::kUnstable); });
    if (!was_ended) continue;  // the change came before the guard had seen the swings
    const bool is_softer = records[given].in_contact && (records[given].faults & kFadingFaults) == 0;
    softer += is_softer ? 1 : 0;
    const Felt after = felt(records, run.changes.front().tick);
    SCOPED_TRACE(fmt::format("{}: {} changes from tick {}, {:.0f} to {:.0f} N/m", i, count, given, least, most));
    EXPECT_LE(after.most_growth_N_per_m, 1.5 * editsStep(most - least) + 1e-6 * most);
    EXPECT_LE(after.most_loss_N_per_m, (most - least) / (ServoLoop::kChangeOver_s * kRate_hz) + 1e-6 * most);
    EXPECT_FALSE(after.lost);
    EXPECT_NEAR(feltStiffness(*std::find_if(records.rbegin(), records.rend(),
                                            [](const TickRecord& r) { return r.in_contact && r.depth_m > 1e-5; })),
                run.changes.back().stiffness_N_per_m, 1e-6 * most);
  }
  EXPECT_GT(softer, 10);
}

// The same with another engine, whose windows come while the first one's still count.
TEST(ServoLoopChanges, AnotherEngineAfterAnUnstableContactComesAsAnEditThatAddsAsMuch) {
  Seeded random(82);
  int softer = 0;
  for (int i = 0; i < 20; ++i) {
    Shaking run = anyShaking(random);
    run.takeover = {6200 + random.pick(2300), quietStiffness(run, random)};
    const std::vector<TickRecord> records = run.run();
    const auto at = static_cast<std::size_t>(run.takeover->tick);
    const double before = feltStiffness(records[at]);
    ASSERT_NEAR(before, run.first_N_per_m / 4, 1e-6 * before) << i;
    ++softer;
    const Felt after = felt(records, run.takeover->tick);
    const double added = std::max(0.0, run.takeover->stiffness_N_per_m - before);
    // The force is taken up as it was a tick before; so much of it is the tool's own motion.
    const double moved = std::abs(records[at + 2].depth_m - records[at].depth_m) / records[at].depth_m;
    EXPECT_LE(after.most_growth_N_per_m, 1.5 * editsStep(added) + before * (moved + 1e-6)) << i;
    EXPECT_FALSE(after.lost) << i;
    EXPECT_NEAR(feltStiffness(records[at + 700]), run.takeover->stiffness_N_per_m, 1e-6 * before) << i;
  }
  EXPECT_GT(softer, 10);
}

}  // namespace changes_after_shaking_test
}  // namespace palpate
