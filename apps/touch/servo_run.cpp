// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/servo_run.hpp"

#include <chrono>
#include <thread>

#include "apps/console/interrupt.hpp"
#include "apps/touch/servo_setup.hpp"
#include "engine/service/engine_thread.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace {

// The engine publishes in step with the servo, so that the same scene gives the same trace, bit for bit.
LoopResult runSimulated(ServoLoop& loop, ToolPoseMailbox& tool, Engine& engine, LiveEdits* edits, double ticks,
                        Progress& progress) {
  return loop.runSimulated([&](std::int64_t tick, std::int64_t time_ns) {
    const ToolPose& pose = tool.latest();
    engine.publishFor(pose, time_ns);
    if (edits != nullptr) edits->follow(pose, time_ns);
    if (interrupted()) loop.requestStop();  // at every tick: one with an edit may take long
    if (tick % 256 == 0) progress.fraction(static_cast<double>(tick) / ticks);
  });
}

LoopResult runReal(ServoLoop& loop, ToolPoseMailbox& tool, Engine& engine, LiveEdits* edits, double duration_s,
                   Progress& progress) {
  using Clock = std::chrono::steady_clock;
  engine.publishFor(tool.latest(), monotonicNow_ns());
  EngineThread::Follow follow;
  if (edits != nullptr) follow = [edits](const ToolPose& pose, std::int64_t now_ns) { edits->follow(pose, now_ns); };
  EngineThread publisher(engine, tool, std::move(follow));
  const auto start = Clock::now();
  loop.start();
  while (loop.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    progress.fraction(std::min(1.0, std::chrono::duration<double>(Clock::now() - start).count() / duration_s));
    if (interrupted() || publisher.failed()) loop.requestStop();
  }
  LoopResult result = loop.wait();
  publisher.stop();
  return result;
}

}  // namespace

LoopResult runServo(const Scene& scene, AlgorithmSetup setup, const Path& path, Engine& engine, LiveEdits* edits,
                    Progress& progress, const std::function<void()>& before_first_tick) {
  const LoopParameters parameters = loopParameters(scene);
  const std::unique_ptr<Algorithm> algorithm = makeAlgorithm(scene.algorithm, std::move(setup));
  SimulatedDevice device(deviceParameters(scene), path, scene.rate_hz);
  ToolPoseMailbox tool;
  ServoLoop loop(parameters, *algorithm, device, engine.exchange(), tool);
  before_first_tick();
  if (scene.simulated_clock)
    return runSimulated(loop, tool, engine, edits, static_cast<double>(parameters.ticks), progress);
  return runReal(loop, tool, engine, edits, scene.duration_s, progress);
}

}  // namespace palpate
