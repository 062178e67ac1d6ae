// SPDX-License-Identifier: Apache-2.0
#include "apps/rig/touch_rig.hpp"

#include <exception>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "apps/servo_setup/contact_bounds.hpp"
#include "apps/servo_side/local_servo.hpp"
#include "base/error.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace {

LoopParameters loopFor(LoopParameters loop, const RigSettings& settings, const Device& device) {
  loop.safety.force_limit_N = settings.force_limit_N;
  loop.instability.doubtful = mayShake(settings, loop, device);
  return loop;
}

RigSettings withFloatIsovalue(RigSettings settings) {
  settings.parameters.isovalue = static_cast<float>(settings.parameters.isovalue);
  return settings;
}

bool differInForceLimitAlone(RigSettings a, const RigSettings& b) {
  a.force_limit_N = b.force_limit_N;
  return a == b;
}

}  // namespace

DensityScale densityScaleOf(const Volume& volume, double isovalue) {
  return {.contrast = volume.maximum() - isovalue, .voxel_m = volume.lattice().smallestSpacing()};
}

TouchRig::TouchRig(Engine& engine, Device& device, const LoopParameters& loop, RigVolume volume, RigSettings settings,
                   RigEdits* edits)
    : TouchRig(engine, std::make_unique<LocalServo>(device, engine.exchange()), loop, std::move(volume),
               std::move(settings), edits) {}

TouchRig::TouchRig(Engine& engine, std::unique_ptr<ServoSide> own, const LoopParameters& loop, RigVolume volume,
                   RigSettings settings, RigEdits* edits)
    : TouchRig(engine, *own, loop, std::move(volume), std::move(settings), edits) {
  own_servo_ = std::move(own);
}

TouchRig::TouchRig(Engine& engine, ServoSide& servo, const LoopParameters& loop, RigVolume volume, RigSettings settings,
                   RigEdits* edits)
    : engine_(engine),
      servo_(servo),
      loop_settings_(loop),
      rate_hz_(loop.rate_hz),
      first_isovalue_(static_cast<float>(engine.isovalue())),
      volume_(std::move(volume)),
      edits_(edits),
      settings_(withFloatIsovalue(std::move(settings))),
      given_(settings_),
      isovalue_transition_(engine) {
  std::unique_ptr<Algorithm> algorithm = algorithmFor(settings_);
  if (settings_.parameters.isovalue != first_isovalue_) {
    refuse(fmt::format("isovalue {:g}", settings_.parameters.isovalue),
           fmt::format("the gradients on the device are those around {:g}", first_isovalue_),
           "begin with that, and change it then");
  }
  servo_.makeLoop(loopFor(loop, settings_, servo_.device()), settings_, volume_, std::move(algorithm));
}

bool TouchRig::mayShake(const RigSettings& settings) const {
  return palpate::mayShake(settings, loop_settings_, servo_.device());
}

std::vector<std::string> TouchRig::warnings(const RigSettings& settings) const {
  return boundWarnings(settings, loop_settings_, servo_.device());
}

TouchRig::~TouchRig() {
  requestStop();
}

void checkHasGradients(const std::string& algorithm, bool gradient_everywhere) {
  if (algorithmEntry(algorithm).needs.gradient_everywhere && !gradient_everywhere) {
    refuse(algorithm, "it reads gradients everywhere, and those on the device lie around the isosurface",
           "start anew with all gradients (--gradient all)");
  }
}

std::unique_ptr<Algorithm> TouchRig::algorithmFor(const RigSettings& settings) const {
  if (settings.parameters.rate_hz != rate_hz_) {
    refuse(fmt::format("rate {:g} Hz", settings.parameters.rate_hz), fmt::format("the servo runs at {:g} Hz", rate_hz_),
           "start anew with the other rate");
  }
  checkHasGradients(settings.algorithm, engine_.gradientEverywhere());
  const AlgorithmNeeds& needs = algorithmEntry(settings.algorithm).needs;
  if (needs.isosurface_mesh && settings.parameters.isovalue != first_isovalue_) {
    refuse(fmt::format("{} at isovalue {:g}", settings.algorithm, settings.parameters.isovalue),
           fmt::format("its mesh is that of {:g}", first_isovalue_), "start anew with the other isovalue");
  }
  return makeAlgorithm(settings, volume_);
}

LoopResult TouchRig::runSimulated(const Follow& follow, const ServoLoop::Hook& before_tick) {
  LoopResult result = servo_.runSimulated([&](std::int64_t tick, std::int64_t time_ns) {
    const ToolPose& pose = servo_.tool().latest();
    engine_.publishFor(pose, time_ns);
    if (follow) follow(pose, time_ns);
    look(pose, time_ns, true);
    if (before_tick) before_tick(tick, time_ns);
  });
  freeUnusedSamples();
  return result;
}

void TouchRig::start(Follow follow, std::function<void(std::int64_t now_ns)> before) {
  engine_.publishFor(servo_.tool().latest(), monotonicNow_ns());
  const auto work = [this, follow = std::move(follow), before = std::move(before)](const ToolPose& pose,
                                                                                   std::int64_t now_ns) {
    if (pose.tick >= 0 && follow) follow(pose, now_ns);
    if (pose.tick < 0 && before) before(now_ns);
    look(pose, now_ns, false);
    return view_ != nullptr && view_->look(engine_, now_ns);
  };
  publisher_.emplace(engine_, servo_.tool(), work, [this] { requestStop(); });
  try {
    servo_.start();
  } catch (...) {
    publisher_.reset();
    throw;
  }
}

LoopResult TouchRig::wait() {
  LoopResult result;
  std::exception_ptr servos_end;  // of a servo in another process
  try {
    result = servo_.wait();
  } catch (...) {
    servos_end = std::current_exception();
  }
  if (publisher_) {
    engine_failed_ = publisher_->failed();
    struct Stopped {
      std::optional<EngineThread>& publisher;
      ~Stopped() { publisher.reset(); }
    } const stopped{publisher_};
    publisher_->stop();  // throws the engine's own failure, whatever the servo's is
    freeUnusedSamples();
  }
  if (servos_end) std::rethrow_exception(servos_end);
  return result;
}

void TouchRig::freeUnusedSamples() {
  std::unique_lock lock(mutex_);
  const double in_use = given_.parameters.isovalue;
  lock.unlock();
  isovalue_transition_.end(in_use);
}

void TouchRig::change(const RigSettings& settings) {
  const std::lock_guard order(callers_);
  const RigSettings next = withFloatIsovalue(settings);
  std::unique_ptr<Algorithm> algorithm;
  if (!differInForceLimitAlone(this->settings(), next)) algorithm = algorithmFor(next);
  std::unique_lock lock(mutex_);
  if (algorithm == nullptr && !differInForceLimitAlone(settings_, next)) {  // an isovalue was refused meanwhile
    lock.unlock();
    algorithm = algorithmFor(next);
    lock.lock();
  }
  ServoChange change;
  if (next.force_limit_N != given_.force_limit_N) change.force_limit_N = next.force_limit_N;
  const bool waits = next.parameters.isovalue != given_.parameters.isovalue;
  if (!waits) change.algorithm = std::move(algorithm);
  change.doubtful = mayShake(next);
  if (change.algorithm != nullptr || change.force_limit_N) servo_.give(std::move(change), next);
  if (algorithm != nullptr) waiting_ = std::move(algorithm);
  if (!waits) {
    waiting_.reset();
    given_ = next;
  }
  given_.force_limit_N = next.force_limit_N;
  settings_ = next;
}

RigSettings TouchRig::settings() const {
  const std::lock_guard lock(mutex_);
  return settings_;
}

bool TouchRig::isSettled() const {
  const std::lock_guard lock(mutex_);
  return settings_ == given_;
}

std::optional<Error> TouchRig::takeRefusal() {
  const std::lock_guard lock(mutex_);
  return std::exchange(refusal_, std::nullopt);
}

void TouchRig::look(const ToolPose& pose, std::int64_t now_ns, bool all_at_once) {
  if (edits_ != nullptr) edits_->look(pose, now_ns);
  lookForIsovalue(pose, now_ns, all_at_once);
}

void TouchRig::lookForIsovalue(const ToolPose& pose, std::int64_t now_ns, bool all_at_once) {
  IsovalueTransition::Look look{.window_seen = pose.window_version, .all_at_once = all_at_once};
  {
    const std::lock_guard lock(mutex_);
    look.wanted = settings_.parameters.isovalue;
    look.in_use = given_.parameters.isovalue;
    const bool is_gone = servo_.isGone();
    if (is_gone) look.window_seen = std::numeric_limits<std::uint64_t>::max();  // nobody reads the old ones
    look.taken = is_gone || servo_.ended(taking_);
    if (isovalue_transition_.mayGive(look)) {
      if (!is_gone)
        taking_ = servo_.give({.algorithm = std::move(waiting_), .doubtful = mayShake(settings_)}, settings_);
      given_ = settings_;
      return;
    }
  }
  try {
    isovalue_transition_.work(look, now_ns);
  } catch (const Error& error) {
    if (error.code() != Error::Code::kBadInput && error.code() != Error::Code::kOutOfMemory) throw;
    const std::lock_guard lock(mutex_);
    refusal_ = error;
    if (settings_.parameters.isovalue != look.wanted) return;  // another isovalue was requested meanwhile
    settings_ = given_;
    waiting_.reset();
  }
}

void TouchRig::keepTicks(std::size_t most) {
  ticks_.emplace(most);
  servo_.tellTicksTo(*ticks_);
}

}  // namespace palpate
