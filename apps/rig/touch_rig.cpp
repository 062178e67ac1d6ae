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

TouchRig::TouchRig(Engine& engine, Device& device, const LoopParameters& loop, RigVolume volume, RigSettings settings,
                   RigEdits* edits)
    : engine_(engine),
      rate_hz_(loop.rate_hz),
      first_isovalue_(engine.isovalue()),
      volume_(std::move(volume)),
      edits_(edits),
      settings_(std::move(settings)),
      given_(settings_),
      isovalue_way_(engine),
      algorithm_(makeAlgorithm(checked(settings_), volume_)),
      loop_(withForceLimit(loop, settings_.force_limit_N), *algorithm_, device, engine.exchange(), tool_) {
  if (settings_.parameters.isovalue != first_isovalue_) {
    refuse(fmt::format("isovalue {:g}", settings_.parameters.isovalue),
           fmt::format("the gradients on the device are those around {:g}", first_isovalue_),
           "begin with that, and change it then");
  }
  loop_.takeChangesFrom(changes_);
}

TouchRig::~TouchRig() {
  requestStop();
}

const RigSettings& TouchRig::checked(const RigSettings& settings) const {
  if (settings.parameters.rate_hz != rate_hz_) {
    refuse(fmt::format("rate {:g} Hz", settings.parameters.rate_hz), fmt::format("the servo runs at {:g} Hz", rate_hz_),
           "start anew with the other rate");
  }
  const AlgorithmNeeds& needs = algorithmEntry(settings.algorithm).needs;
  if (needs.gradient_everywhere && !engine_.gradientEverywhere()) {
    refuse(settings.algorithm, "it reads gradients everywhere, and those on the device lie around the isosurface",
           "start anew with all gradients");
  }
  if (needs.isosurface_mesh && settings.parameters.isovalue != first_isovalue_) {
    refuse(fmt::format("{} at isovalue {:g}", settings.algorithm, settings.parameters.isovalue),
           fmt::format("its mesh is that of {:g}", first_isovalue_), "start anew with the other isovalue");
  }
  return settings;
}

LoopResult TouchRig::runSimulated(const Follow& follow, const ServoLoop::Hook& before_tick) {
  LoopResult result = loop_.runSimulated([&](std::int64_t tick, std::int64_t time_ns) {
    const ToolPose& pose = tool_.latest();
    engine_.publishFor(pose, time_ns);
    if (follow) follow(pose, time_ns);
    look(pose, time_ns, true);
    if (before_tick) before_tick(tick, time_ns);
  });
  isovalue_way_.end();
  return result;
}

void TouchRig::start(Follow follow) {
  engine_.publishFor(tool_.latest(), monotonicNow_ns());
  const auto work = [this, follow = std::move(follow)](const ToolPose& pose, std::int64_t now_ns) {
    if (follow) follow(pose, now_ns);
    look(pose, now_ns, false);
  };
  publisher_.emplace(engine_, tool_, work, [this] { requestStop(); });
  try {
    loop_.start();
  } catch (...) {
    publisher_.reset();
    throw;
  }
}

LoopResult TouchRig::wait() {
  LoopResult result = loop_.wait();
  if (!publisher_) return result;
  publisher_->stop();
  publisher_.reset();
  isovalue_way_.end();
  return result;
}

void TouchRig::change(const RigSettings& settings) {
  const std::lock_guard lock(changing_);
  RigSettings next = settings;
  next.parameters.isovalue = static_cast<float>(next.parameters.isovalue);
  if (next.parameters.isovalue == given_.parameters.isovalue) {
    give(next);
  } else {
    static_cast<void>(makeAlgorithm(checked(next), volume_));  // refuses what it would refuse later
    RigSettings now = given_;
    now.force_limit_N = next.force_limit_N;
    give(now);
  }
  settings_ = std::move(next);
}

// To the servo. Where it throws, nothing has changed.
void TouchRig::give(const RigSettings& settings) {
  ServoChange change{.force_limit_N = settings.force_limit_N};
  RigSettings next = settings, same = given_;
  same.force_limit_N = settings.force_limit_N;
  if (same != next) change.algorithm = makeAlgorithm(checked(next), volume_);
  changes_.give(std::move(change));
  given_ = std::move(next);
}

RigSettings TouchRig::settings() const {
  const std::lock_guard lock(changing_);
  return settings_;
}

std::optional<Error> TouchRig::takeRefusal() {
  const std::lock_guard lock(changing_);
  return std::exchange(refusal_, std::nullopt);
}

void TouchRig::look(const ToolPose& pose, std::int64_t now_ns, bool all_at_once) {
  if (edits_ != nullptr) edits_->look(pose, now_ns);
  lookForIsovalue(pose, now_ns, all_at_once);
}

void TouchRig::lookForIsovalue(const ToolPose& pose, std::int64_t now_ns, bool all_at_once) {
  IsovalueWay::Look look{.window_seen = pose.window_version, .taken = changes_.ended(), .all_at_once = all_at_once};
  {
    const std::lock_guard lock(changing_);
    look.wanted = settings_.parameters.isovalue;
    look.in_use = given_.parameters.isovalue;
    if (isovalue_way_.mayGive(look)) return give(settings_);
  }
  try {
    isovalue_way_.work(look, now_ns);
  } catch (const Error& error) {
    const std::lock_guard lock(changing_);
    refusal_ = error;
    if (settings_.parameters.isovalue != look.wanted) return;  // somebody wants yet another one by now
    settings_.parameters.isovalue = given_.parameters.isovalue;
    give(settings_);
  }
}

void TouchRig::keepTicks(std::size_t most) {
  ticks_.emplace(most);
  loop_.tellTicksTo(*ticks_);
}

}  // namespace palpate
