// SPDX-License-Identifier: Apache-2.0
// Every algorithm where it hurts, and every change from one to another in contact.
#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/extreme/ground.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/edit_ease.hpp"

namespace palpate {
namespace algorithm_cases {
namespace {

// The trouble that an algorithm is put into.
struct Trouble {
  const char* name;
  RoughRun (*run)();
};

RoughRun onGround(double depth_voxel) {
  const Ground ground{.size = Vec3i::Constant(48)};
  return pressOn(ground.sampled(), ground, depth_voxel);
}

RoughRun inNoise() {
  const Ground ground;
  const Lattice lattice = ground.lattice();
  return pressOn(sampledFrom(ground, 0,
                             [=](double height, const Vec3& p_W) {
                               const Vec3i at = lattice.toIndex(p_W).array().round().cast<int>();
                               Random random(static_cast<std::uint64_t>(at.x() + 64 * (at.y() + 64 * at.z())));
                               return -height + random.uniform(-3, 3);
                             }),
                 ground);
}

RoughRun onStep() {
  const Ground ground;
  return pressOn(sampledFrom(ground, 0.5, [](double height, const Vec3&) { return height < 0 ? 1.0 : 0.0; }), ground,
                 4);
}

constexpr double kTiny = 1e-38, kHuge = 1e30;  // [density/voxel]

Ground farGround() {
  Ground ground;
  ground.plane.p_W = Vec3(1e6, -1e6, 1e6);
  return ground;
}

RoughRun jumpingTool() {
  RoughRun run = onGround(1.5);
  const auto press_W = run.path_W;
  run.path_W = [=](double time_s) -> Vec3 {
    const auto tick = static_cast<std::int64_t>(time_s * 1000 + 0.5);
    return tick % 50 == 0 ? Vec3(0.3, -0.2, 1e3) : press_W(time_s);
  };
  return run;
}

constexpr Trouble kTroubles[] = {{"pressed 15 voxels", [] { return onGround(15); }},
                                 {"noise three times a voxel's change", inNoise},
                                 {"a step, pressed where no gradient is", onStep},
                                 {"a tool that jumps away and back 20 times a second", jumpingTool}};

struct OddGround {
  const char* name;
  Ground ground;
};

std::vector<OddGround> oddGrounds() {
  return {{"densities that grow by 1e-38 a voxel", {.per_voxel = kTiny}},
          {"densities that grow by 1e30 a voxel", {.per_voxel = kHuge}},
          {"1e6 m from the origin", farGround()}};
}

// What has a surface is felt as anywhere else; what has none pushes the tool out.
ExtremeOutcome feelsWith(const std::string& name, const Ground& ground) {
  RoughRun run = pressOn(ground.sampled(), ground);
  run.algorithm = name;
  Judge judge(run, play(run));
  if (algorithmEntry(name).traits.shows_surface) {
    judge.feels(ground.plane, placeError_m(ground));
  } else {
    judge.isPushed(ground.plane.normal_W, 0.05);
  }
  return judge.raisesNoFadingFault().outcome();
}

// From one algorithm to another while the hand rests in contact. The new one takes the contact over: afterwards, at
// most EditEase::kTime_s later, the force is its own, which for one with a surface is K times the exact depth.
ExtremeOutcome takesOver(const std::string& from, const std::string& to) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.algorithm = from;
  run.changes = {{350, to}};
  run.seconds = 1.1 * (0.35 + EditEase::kTime_s) + 0.1;  // the last tenth is judged
  Judge judge(run, play(run));
  if (algorithmEntry(to).traits.shows_surface) judge.feels(ground.plane, placeError_m(ground));
  return judge.raisesNoFadingFault().outcome();
}

}  // namespace
}  // namespace algorithm_cases

void addAlgorithmCases(ExtremeCases& to) {
  using namespace algorithm_cases;
  for (const AlgorithmEntry& entry : algorithms()) {
    const std::string name(entry.name);
    for (const Trouble& trouble : kTroubles) {
      to.push_back({"algorithms", fmt::format("{}: {}", name, trouble.name),
                    "no force beyond the limits, no VHIP that is not finite", [=] {
                      RoughRun run = trouble.run();
                      run.algorithm = name;
                      return Judge(run, play(run)).outcome();
                    }});
    }
    for (const OddGround& odd : oddGrounds()) {
      to.push_back({"algorithms", fmt::format("{}: {}", name, odd.name),
                    "the plane is felt; without a surface, the tool is pushed out",
                    [=] { return feelsWith(name, odd.ground); }});
    }
    if (name == algorithms().front().name) continue;
    const std::string usual(algorithms().front().name);
    const char* expectation = "the new one holds the contact, and no force jumps";
    to.push_back({"algorithms", fmt::format("{} takes over from {}", usual, name), expectation,
                  [=] { return takesOver(name, usual); }});
    to.push_back({"algorithms", fmt::format("{} takes over from {}", name, usual), expectation,
                  [=] { return takesOver(usual, name); }});
  }
}

}  // namespace palpate
