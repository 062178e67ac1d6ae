// SPDX-License-Identifier: Apache-2.0
#include "apps/rig/touch_rig.hpp"

#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace {

LoopParameters withForceLimit(LoopParameters loop, double force_limit_N) {
  loop.safety.force_limit_N = force_limit_N;
  return loop;
}

}  // namespace

std::unique_ptr<Algorithm> makeAlgorithm(const RigSettings& settings, const RigVolume& volume) {
  const AlgorithmParameters& p = settings.parameters;
  return makeAlgorithm(settings.algorithm,
                       {.parameters = p,
                        .effects = makeContactEffects(settings.effects, p.stiffness_N_per_m, p.rate_hz),
                        .haptization = settings.haptization,
                        .scale = volume.scale,
                        .objects = volume.objects,
                        .isosurface = volume.isosurface});
}

TouchRig::TouchRig(Engine& engine, Device& device, const LoopParameters& loop, RigVolume volume, RigSettings settings)
    : engine_(engine),
      rate_hz_(loop.rate_hz),
      isovalue_(engine.isovalue()),
      volume_(std::move(volume)),
      settings_(std::move(settings)),
      algorithm_((check(settings_), makeAlgorithm(settings_, volume_))),
      loop_(withForceLimit(loop, settings_.force_limit_N), *algorithm_, device, engine.exchange(), tool_) {
  loop_.takeChangesFrom(changes_);
}

TouchRig::~TouchRig() {
  requestStop();
}

void TouchRig::check(const RigSettings& settings) const {
  if (settings.parameters.isovalue != isovalue_) {
    refuse(fmt::format("isovalue {:g}", settings.parameters.isovalue),
           fmt::format("the gradients on the device are those around {:g}", isovalue_),
           "start anew with the other isovalue");
  }
  if (settings.parameters.rate_hz != rate_hz_) {
    refuse(fmt::format("rate {:g} Hz", settings.parameters.rate_hz), fmt::format("the servo runs at {:g} Hz", rate_hz_),
           "start anew with the other rate");
  }
  if (algorithmEntry(settings.algorithm).needs.gradient_everywhere && !engine_.gradientEverywhere()) {
    refuse(settings.algorithm, "it reads gradients everywhere, and those on the device lie around the isosurface",
           "start anew with all gradients");
  }
}

LoopResult TouchRig::runSimulated(const Follow& follow, const ServoLoop::Hook& before_tick) {
  return loop_.runSimulated([&](std::int64_t tick, std::int64_t time_ns) {
    const ToolPose& pose = tool_.latest();
    engine_.publishFor(pose, time_ns);
    if (follow) follow(pose, time_ns);
    if (before_tick) before_tick(tick, time_ns);
  });
}

void TouchRig::start(Follow follow) {
  engine_.publishFor(tool_.latest(), monotonicNow_ns());
  publisher_.emplace(engine_, tool_, std::move(follow), [this] { requestStop(); });
  try {
    loop_.start();
  } catch (...) {
    publisher_.reset();
    throw;
  }
}

LoopResult TouchRig::wait() {
  LoopResult result = loop_.wait();
  if (publisher_) publisher_->stop();
  publisher_.reset();
  return result;
}

void TouchRig::change(const RigSettings& settings) {
  const std::lock_guard lock(changing_);
  check(settings);
  ServoChange change{.force_limit_N = settings.force_limit_N};
  RigSettings next = settings, same = settings_;
  same.force_limit_N = settings.force_limit_N;
  if (same != next) change.algorithm = makeAlgorithm(settings, volume_);
  changes_.give(std::move(change));
  settings_ = std::move(next);
}

RigSettings TouchRig::settings() const {
  const std::lock_guard lock(changing_);
  return settings_;
}

void TouchRig::keepTicks(std::size_t most) {
  ticks_.emplace(most);
  loop_.tellTicksTo(*ticks_);
}

}  // namespace palpate
