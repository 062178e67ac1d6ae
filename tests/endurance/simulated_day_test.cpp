// SPDX-License-Identifier: Apache-2.0
// A day by the simulated clock, with edits by two clients and a servo behind a channel: memory must be flat.
//
// PALPATE_DAY_HOURS: how long (0.005; `./dev soak` takes 24). PALPATE_DAY_RATE_HZ: of the servo (1000).
#include <cmath>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "apps/live/live_volume.hpp"
#include "apps/rig/remote_windows.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "apps/servo_side/servo_host.hpp"
#include "child_process.hpp"
#include "endurance_figures.hpp"
#include "engine/edit/edit_text.hpp"
#include "memory_trend.hpp"
#include "process_facts.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace simulated_day_test {

constexpr double kLongEnough_h = 1;
constexpr std::int64_t kEdit_ticks = 1000, kUndo_ticks = 500;  // one client's; another one undoes half-way between

SampledPath way(double seconds) {
  std::vector<double> times_s;
  std::vector<Vec3> points_W;
  for (int i = 0; i < seconds + 2; ++i) {
    times_s.push_back(i);
    const double angle = i % 2 == 0 ? 0.5 : -0.5;
    points_W.push_back(0.0102 * Vec3(std::sin(angle), 0, std::cos(angle)));
  }
  return {times_s, points_W, SampledPath::Interpolation::kLinear};
}

TEST(SimulatedDay, MemoryIsFlat) {
  const double hours = numberOf("PALPATE_DAY_HOURS", 0.005), rate_hz = numberOf("PALPATE_DAY_RATE_HZ", 1000);
  const TemporaryFolder folder;
  Scene scene;
  scene.volume = "phantom:sphere?size=32";
  scene.simulated_clock = true;
  scene.rate_hz = rate_hz;
  scene.stiffness_N_per_m = 400;
  Progress silent(nullptr);
  std::string told;
  LiveVolume live({.volume = scene.volume,
                   .plan = makePlan({.edits = true}),
                   .journal = folder.path() / "journal",
                   .outlives_its_engine = true,
                   .work = "the test"},
                  silent, [&](const std::string& words) { told += words + "\n"; });
  const SampledPath path = way(3600 * hours);
  auto [ours, theirs] = channelPair();
  std::thread host([theirs = std::move(theirs)]() mutable { ServoHost(false, "").serve(std::move(theirs)); });
  std::vector<double> looks;
  std::size_t descriptors = 0, descriptors_at_end = 0;
  std::uint64_t made = 0, refused = 0;
  double force_N = 0;
  LoopResult result;
  {
    RemoteServo servo(std::move(ours),
                      {.scene = scene, .box = {}, .way = &path, .window_samples = live.engine().windowCapacity()});
    publishTo(servo, live.engine());
    LoopParameters loop = loopParameters(scene);
    loop.record_ticks = 1;
    loop.ticks = std::llround(3600 * hours * rate_hz);  // a scene may not take that long
    TouchRig rig(live.engine(), servo, loop, RigVolume{.scale = densityScaleOf(live.volume(), live.firstIsovalue())},
                 rigSettings(scene, live.firstIsovalue()), &live.edits());
    const auto count = [&](const std::optional<Error>& refusal) { ++(refusal ? refused : made); };
    const std::int64_t ticks = loop.ticks, every = std::max<std::int64_t>(1, ticks / 500);
    result = rig.runSimulated(
        [&](const ToolPose& pose, std::int64_t) { force_N = std::max(force_N, pose.force_W.norm()); },
        [&](std::int64_t tick, std::int64_t) {
          if (tick % kEdit_ticks == 0) {
            const std::string text = fmt::format("{}:radius=1.5mm:at={},0,9mm", tick % 2000 == 0 ? "remove" : "add",
                                                 tick / kEdit_ticks % 7 - 3);
            static_cast<void>(live.edits().edit({editText(text, EditUse::kPlaced, text).command}, count));
          }
          if (tick % kEdit_ticks == kUndo_ticks) static_cast<void>(live.edits().undo(count));
          if (tick % every == 0) looks.push_back(ownMemory(getpid()));
          if (tick == every) descriptors = openDescriptorsOf(getpid());
          if (tick == ticks - 1) descriptors_at_end = openDescriptorsOf(getpid());
        });
  }
  host.join();
  EXPECT_EQ(told, "");
  EXPECT_EQ(refused, 0U);
  EXPECT_EQ(descriptors_at_end, descriptors);
  EXPECT_EQ(result.ticks_run, static_cast<std::int64_t>(std::llround(3600 * hours * rate_hz)));
  EXPECT_GE(static_cast<double>(made), 2 * (static_cast<double>(result.ticks_run) / kEdit_ticks) - 2);
  EXPECT_GT(force_N, 0.1);
  const double grown = growthOf(looks);
  if (hours >= kLongEnough_h) {
    EXPECT_LE(grown, 0.01);
  }
  live.close();

  BenchResult bench =
      beginEndurance("service-day", runPalpate({.arguments = {"--version"}, .folder = folder.path()}).out,
                     fmt::format("./dev soak 30 {:g}", hours));
  for (std::size_t i = 0; i < looks.size(); i += std::max<std::size_t>(1, looks.size() / 50))
    bench.rows.push_back(
        {{"at_h", hours * static_cast<double>(i) / static_cast<double>(looks.size())}, {"memory_bytes", looks[i]}});
  bench.targets = {
      {"growth of own memory", grown, 0.01},
      {"descriptors left open", static_cast<double>(descriptors_at_end) - static_cast<double>(descriptors), 0}};
  writeEndurance(bench, "A day of simulated time",
                 "A servo behind a channel slides a hand over a sphere by the simulated clock, while one client edits "
                 "and another one undoes.",
                 fmt::format("{} ticks at {:g} Hz, {} edits and undos; own memory grew by {:.2f} %.\n",
                             result.ticks_run, rate_hz, made, 100 * grown));
}

}  // namespace simulated_day_test
}  // namespace palpate
