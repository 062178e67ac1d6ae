// SPDX-License-Identifier: Apache-2.0
// The volume changes under the tool.
#include <fmt/format.h>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace edit_cases {
namespace {

// The ground with its plane higher or lower.
SampledVolumePtr groundAt(double height_voxel) {
  return sampledFrom(Ground{}, 0, [=](double height, const Vec3&) { return height_voxel - height; });
}

constexpr std::int64_t kWhen = 350;  // the hand rests in contact

// At rest in contact the plane moves to another height; K times the new depth must be felt in the end.
ExtremeOutcome planeMoves(double height_voxel) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.edits = {{kWhen, groundAt(height_voxel)}};
  run.seconds = 2;
  ExactPlane moved = ground.plane;
  moved.p_W.z() = height_voxel * ground.voxel_m();
  return Judge(run, play(run)).feels(moved, placeError_m(ground)).raisesNoFadingFault().outcome();
}

ExtremeOutcome becomes(const std::function<double(double)>& density, bool is_free) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.edits = {{kWhen, sampledFrom(ground, 0, [&](double height, const Vec3&) { return density(height); })}};
  run.seconds = 2;
  Judge judge(run, play(run));
  if (is_free) judge.endsWithoutForce();
  return judge.outcome();
}

// In every tick the plane is at another height, up to a voxel up and down.
ExtremeOutcome planeTrembles() {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  const std::vector<SampledVolumePtr> grounds = {groundAt(0), groundAt(1), groundAt(-1), groundAt(0.3)};
  run.seconds = 1;
  for (std::int64_t tick = 100; tick < 1000; ++tick)
    run.edits.push_back({tick, grounds[static_cast<std::size_t>(tick) % 4]});
  return Judge(run, play(run)).outcome();
}

}  // namespace
}  // namespace edit_cases

void addEditCases(ExtremeCases& to) {
  using namespace edit_cases;
  const auto add = [&](const std::string& name, const char* expectation, std::function<ExtremeOutcome()> run) {
    to.push_back({"edits", name, expectation, std::move(run)});
  };
  for (const double height : {0.5, 2.0, 4.0}) {
    add(fmt::format("material of {:g} voxels is added under the tool", height),
        "the new plane is felt, and no force jumps", [=] { return planeMoves(height); });
  }
  add("1 voxel is taken away under the tool", "the new plane is felt, and no force jumps",
      [] { return planeMoves(-1); });
  add("all material is taken away under the tool", "the force ends",
      [] { return becomes([](double) { return -1.0; }, true); });
  add("all space is filled around the tool", "no force beyond the limits",
      [] { return becomes([](double) { return 1.0; }, false); });
  add("inside becomes outside", "no force beyond the limits",
      [] { return becomes([](double height) { return height; }, false); });
  add("the plane moves by a voxel in every tick", "no force beyond the limits", [] { return planeTrembles(); });
}

}  // namespace palpate
