// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/servo_loop.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/thread_names.hpp"
#include "base/units.hpp"
#include "servo/algorithms/iso_field.hpp"
#include "servo/loop/velocity_filter.hpp"
#include "servo/window/window_sampler.hpp"

namespace palpate {
namespace {

constexpr double kMaxRate_hz = 20000;
constexpr double kPatience_s = 1;                 // how long a device may refuse every write at the end of a run [s]
constexpr std::int64_t kMostElapsed = 1'000'000;  // most grid periods of one elapse() [tick]

const LoopParameters& checked(const LoopParameters& p) {
  const auto refuse = [](const char* key, double value, const char* remedy) {
    throw Error(Error::Code::kBadInput, key, formatted("{} cannot be used", value), remedy);
  };
  if (!(p.rate_hz >= 1 && p.rate_hz <= kMaxRate_hz)) refuse("rate", p.rate_hz, "give 1 to 20000 Hz");
  if (p.ticks < 0) refuse("ticks", static_cast<double>(p.ticks), "give 0 (no end) or more");
  if (p.record_ticks < -1 || (p.record_ticks == -1 && p.ticks == 0)) {
    refuse("record ticks", static_cast<double>(p.record_ticks), "say how many ticks to keep of a run without end");
  }
  if (p.priority < 1 || p.priority > 99) refuse("priority", p.priority, "give 1 to 99");
  return p;
}

// The gate keeps within the device's own force and slew limits, whatever the scene allows.
SafetyParameters withinDevice(SafetyParameters safety, const Device& device) {
  const DeviceLimits limits = device.limits();
  if (limits.force_limit_N > 0) safety.force_limit_N = std::min(safety.force_limit_N, limits.force_limit_N);
  if (limits.slew_limit_N_per_s > 0)
    safety.slew_limit_N_per_s = std::min(safety.slew_limit_N_per_s, limits.slew_limit_N_per_s);
  if (limits.is_held) safety.start_s = std::max(safety.start_s, SafetyParameters::kHeldStart_s);
  return safety;
}

std::size_t recordCapacity(const LoopParameters& p) {
  const std::int64_t all = p.ticks == 0 ? std::numeric_limits<std::int64_t>::max() : p.ticks;
  return static_cast<std::size_t>(p.record_ticks < 0 ? all : std::min(all, p.record_ticks));
}

void copy(const Vec3& from, double (&to)[3]) noexcept {
  std::copy(from.begin(), from.end(), to);
}

// The largest force limit that a change may set.
double mostForce(const Device& device) {
  const double limit_N = device.limits().force_limit_N;
  return limit_N > 0 ? limit_N : std::numeric_limits<double>::max();
}

// An estimate without a given noise bound takes the device's resolution.
VelocityParameters velocityFor(const Device& device, VelocityParameters velocity) {
  if (!velocity.noise_m) velocity.noise_m = device.limits().position_resolution_m;
  return velocity;
}

// A controller without a given limit takes a quarter of what still brakes the device in the lightest hand, and no more
// than answers a step of the encoders quietly: a velocity that is rounded comes in steps, and so would its damper.
PassivityParameters passivityFor(const Device& device, const LoopParameters& p) {
  PassivityParameters passivity = p.passivity;
  if (passivity.damping_limit_Ns_per_m) return passivity;
  const double cutoff_hz = p.velocity.name == VelocityParameters{}.name ? p.velocity.cutoff_hz : 0;
  // It acts for some ticks alone, so a step may be answered by more than is quiet. With thrice as much the peaks of a
  // slide with 50 um rise from 0.26 N to 0.40 N (uncapped: 1.5 N), and most devices still render three times as much.
  constexpr double kJumps = 3;
  VelocityFilter filter(cutoff_hz, p.rate_hz);
  filter.reset(Vec3::Zero());
  const double step_m_per_s = filter.update({device.limits().position_resolution_m, 0, 0}, 1).x();
  for (const HandParameters& hand : device.hands()) {
    double damping = 0.25 * brakingDamping(hand, p.rate_hz, device.limits().force_delay_ticks, cutoff_hz);
    if (step_m_per_s > 0) damping = std::min(damping, kJumps * quietJump(hand) / step_m_per_s);
    passivity.damping_limit_Ns_per_m = std::min(passivity.damping_limit_Ns_per_m.value_or(damping), damping);
  }
  return passivity;
}

std::int64_t nanoseconds(double time_s) {
  return std::llround(time_s * kNanosecondsPerSecond);
}

struct RealClock {
  static std::int64_t now_ns() noexcept { return monotonicNow_ns(); }
  static void sleepUntil(std::int64_t due_ns) noexcept { palpate::sleepUntil(due_ns); }
};

float densityAt(const SampleWindow& window, const Vec3& p_W) noexcept {
  const Fetch f = fetch(window, p_W);
  return f.place == Place::kBeyondWindow ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(f.density);
}

}  // namespace

ServoLoop::ServoLoop(const LoopParameters& parameters, Algorithm& algorithm, Device& device, WindowExchange& windows,
                     ToolPoseMailbox& tool)
    : parameters_(checked(parameters)),
      algorithm_(&algorithm),
      device_(device),
      windows_(&windows),
      tool_(&tool),
      gate_(withinDevice(parameters.safety, device), parameters.rate_hz),
      window_clock_(nanoseconds(parameters.safety.stall_s)),
      passivity_(passivityFor(device, parameters), withinDevice(parameters.safety, device).force_limit_N,
                 parameters.rate_hz, device.limits().force_delay_ticks, device.limits().position_resolution_m),
      guard_(parameters.instability, device.limits(), parameters.rate_hz),
      velocity_(velocityFor(device, parameters.velocity), parameters.rate_hz),
      recorder_(recordCapacity(parameters)),
      motion_(device.limits().motion, device.limits().position_resolution_m),
      position_waits_s_(device.limits().sets_pace ? parameters.safety.report_timeout_s : 0),
      begins_(device.limits().is_held),
      most_force_N_(mostForce(device)),
      ticks_to_grow_(std::llround(EditEase(parameters.rate_hz).ticks())),
      ticks_to_fall_(std::max<std::int64_t>(1, std::llround(kChangeOver_s * parameters.rate_hz))),
      next_engine_(parameters.rate_hz) {
  if (!device_.read(hip_W_) || !hip_W_.allFinite()) {
    throw Error(Error::Code::kDevice, std::string(device_.name()), "gives no position", "check its cable and power");
  }
  algorithm_->reset(hip_W_);
  velocity_.reset(hip_W_);
  passivity_.reset(hip_W_);
  tool_->back() = ToolPose{hip_W_, Vec3::Zero(), -1, 0};
  tool_->publish();
}

ServoLoop::~ServoLoop() {
  requestStop();
  if (thread_.joinable()) thread_.join();
  if (change_ != nullptr) endChange();
}

// Computed from the rate. Multiples of a rounded period would drift if the period is no whole number of nanoseconds.
std::int64_t ServoLoop::offset_ns(std::int64_t tick) const noexcept {
  return static_cast<std::int64_t>(
      std::llround(static_cast<double>(tick) * (kNanosecondsPerSecond / parameters_.rate_hz)));
}

// The first grid point at or after a time; not before `tick` and not after the run's end.
std::int64_t ServoLoop::firstTickFrom(std::int64_t tick, std::int64_t time_ns) const noexcept {
  const double periods = static_cast<double>(time_ns) * (parameters_.rate_hz / kNanosecondsPerSecond);
  std::int64_t next = std::max(tick, static_cast<std::int64_t>(std::floor(periods)));
  while (offset_ns(next) < time_ns) ++next;  // once or twice: the quotient is rounded
  return parameters_.ticks == 0 ? next : std::min(next, parameters_.ticks);
}

bool ServoLoop::wanted(std::int64_t tick) const noexcept {
  return !stop_.load(std::memory_order_relaxed) && (parameters_.ticks == 0 || tick < parameters_.ticks);
}

LoopResult ServoLoop::runSimulated(const Hook& before_tick) {
  TickRecord unkept;
  for (std::int64_t tick = 0; wanted(tick); ++tick) {
    const std::int64_t now_ns = offset_ns(tick);
    if (before_tick) before_tick(tick, now_ns);
    TickRecord* kept = recorder_.next();
    TickRecord& record = kept != nullptr ? *kept : unkept;
    const SampleWindow& window = runTick({tick, 0, tick == 0 ? 0 : 1}, now_ns, record);
    record.density = densityAt(window, hip_W_);
    if (live_ != nullptr) live_->add(record);
  }
  const auto period_ns = offset_ns(1);
  endForce([&] { return period_ns; });
  return result();
}

LoopResult ServoLoop::runOn(ServoClock& clock) {
  runOnGrid(clock);
  return result();
}

void ServoLoop::start() {
  running_.store(true, std::memory_order_release);
  std::promise<bool> may_run;
  std::future<bool> allowed = may_run.get_future();
  thread_ = std::jthread([this, may_run = std::move(may_run)]() mutable {
    nameThisThread("servo");
    if (parameters_.real_time) real_time_ = becomeRealTime(parameters_.priority);
    const bool runs = !parameters_.require_real_time || real_time_.granted();
    may_run.set_value(runs);
    if (runs) {
      RealClock clock;
      runOnGrid(clock);
    }
    running_.store(false, std::memory_order_release);
  });
  if (allowed.get()) return;
  thread_.join();
  refuseWithoutRealTime(real_time_);
}

LoopResult ServoLoop::wait() {
  if (thread_.joinable()) thread_.join();
  return result();
}

template <typename Clock>
void ServoLoop::runOnGrid(Clock& clock) {
  const std::int64_t start_ns = clock.now_ns() + offset_ns(1);
  first_due_ns_ = start_ns;
  TickRecord unkept;
  std::int64_t last_tick = 0;
  for (std::int64_t tick = 0; wanted(tick);) {
    const std::int64_t due_ns = start_ns + offset_ns(tick);
    clock.sleepUntil(due_ns);
    const std::int64_t woken_ns = clock.now_ns();
    TickRecord* kept = recorder_.next();
    TickRecord& record = kept != nullptr ? *kept : unkept;
    const SampleWindow& window = runTick(
        {tick, woken_ns - due_ns, static_cast<int>(std::min(tick - last_tick, kMostElapsed))}, woken_ns, record);
    const std::int64_t done_ns = clock.now_ns();
    record.tick_cost_ns =
        static_cast<std::int32_t>(std::min<std::int64_t>(done_ns - woken_ns, std::numeric_limits<std::int32_t>::max()));
    record.density = densityAt(window, hip_W_);

    last_tick = tick++;
    const bool overrun = done_ns > start_ns + offset_ns(tick);
    overrun_ = overrun ? bit(ServoFault::kOverrun) : 0;
    record.faults |= overrun_;
    if (live_ != nullptr) live_->add(record);
    if (!overrun) continue;
    const std::int64_t next = firstTickFrom(tick, done_ns - start_ns);
    ticks_skipped_ += next - tick;
    tick = next;
  }
  endForce([&] {
    const std::int64_t before_ns = clock.now_ns();
    clock.sleepUntil(before_ns + offset_ns(1));
    return clock.now_ns() - before_ns;
  });
}

// One tick, from reading the device to writing it. Gives the window that it used, valid until the next tick.
const SampleWindow& ServoLoop::runTick(const Due& due, std::int64_t now_ns, TickRecord& record) noexcept {
  std::uint32_t faults = carried_faults_ | guard_.faults();
  if (due.elapsed_ticks > 0) device_.elapse(due.elapsed_ticks);
  const std::int64_t gap_ns = due.elapsed_ticks > 0 ? now_ns - last_now_ns_ : 0;
  last_now_ns_ = now_ns;
  ServoLink* const link = lookForLink();
  const std::int64_t confirmed_ns = windows_->confirmedAt_ns();  // before latest(): see window_exchange.hpp
  const SampleWindow& window = windows_->latest();
  const WindowClock::Reading age = window_clock_.read(now_ns, confirmed_ns, window.version, window.stamp_ns);
  faults |= age.faults;

  TickOutput out;
  std::int64_t report_age_ns = 0;
  if (readDevice(due.elapsed_ticks, gap_ns, report_age_ns)) {
    if (changes_ != nullptr && change_ == nullptr && link == nullptr) beginChange(window);
    tickAlgorithm({hip_W_, velocity_.value(), &window}, out);
    remember(out);
  } else {
    faults |= bit(ServoFault::kDeviceError);
    out.vhip_W = hip_W_;
    out.stored_J = std::numeric_limits<double>::quiet_NaN();
  }
  faults |= askDevice(gap_ns);
  Vec3 pushed_W = out.force_W;
  double stored_J = out.stored_J;
  if (const DeviceBoundary edge = device_.boundary(); edge.stored_J > 0) {
    pushed_W += edge.force_W;
    stored_J += edge.stored_J;
  }
  const Vec3 damping_W = passivity_.damping(velocity_.value(), {stored_J, pushed_W.stableNorm()}, gate_.forceLimit());
  const GateOutput gated = gate_.pass({pushed_W + damping_W, age.age_ns, faults | out.faults, gap_ns, report_age_ns});
  carried_faults_ = offer(gated.force_W) ? 0 : bit(ServoFault::kDeviceError);
  const Vec3& held_W = gate_.heldForce();
  passivity_.hold(held_W);
  tool_->back() = {hip_W_,
                   velocity_.value(),
                   due.tick,
                   now_ns,
                   last_.at_surface,
                   last_.surface_W,
                   out.normal_W,
                   held_W,
                   window.version,
                   gated.faults | carried_faults_ | std::exchange(overrun_, 0U),
                   leaps_};
  if (link != nullptr) link->tool->back() = tool_->back();
  tool_->publish();
  if (link != nullptr) {
    link->tool->publish();
    links_->heard();
  }
  ++ticks_run_;

  record.tick = due.tick;
  record.time_s = static_cast<double>(due.tick) / parameters_.rate_hz;
  copy(hip_W_, record.hip_W);
  copy(out.vhip_W, record.vhip_W);
  copy(out.normal_W, record.normal_W);
  copy(held_W, record.force_W);
  record.depth_m = out.depth_m;
  record.plane_age_ticks = out.plane_age_ticks;
  record.window_version = window.version;
  record.edit_version = window.edit_version;
  record.faults = gated.faults | carried_faults_;
  newest_faults_.store(record.faults, std::memory_order_relaxed);
  record.lateness_ns = due.lateness_ns;
  record.window_age_ns = window.version == 0 ? 0 : now_ns - window.stamp_ns;
  record.energy_J = passivity_.energy_J();
  record.in_contact = out.in_contact;
  record.effects = out.effects;
  record.damped = !damping_W.isZero(0) && (gated.faults & kFadingFaults) == 0;
  guard_.add(record);
  return window;
}

// What an algorithm that takes over must know.
void ServoLoop::remember(const TickOutput& out) noexcept {
  last_ = out;
  if ((out.faults & (bit(ServoFault::kInsideObject) | bit(ServoFault::kSurfaceLost))) != 0) {
    way_known_ = false;
  } else if ((out.faults & (bit(ServoFault::kBeyondWindow) | bit(ServoFault::kNoWindow))) == 0) {
    way_known_ = true;
  }
}

// What the device says besides where it is: whether its force is off, and whether it refused a calibration. After a
// force that was off, and after a stall, everything begins anew.
std::uint32_t ServoLoop::askDevice(std::int64_t gap_ns) noexcept {
  std::uint32_t faults = 0;
  if (const ForceOff off = device_.forceOff(); off != ForceOff::kNone && off != ForceOff::kInputOnly) {
    faults |= bit(ServoFault::kForceOff);
    if (off != ForceOff::kClutched) gate_.beginAnew();
  }
  if (gate_.isStall(gap_ns)) device_.beginAnew();
  if (device_.refusedCalibration() != CalibrationRefusal::kNone) faults |= bit(ServoFault::kCalibrationRefused);
  return faults;
}

// A new algorithm goes on where the last one was: from in front of the surface of a contact, else from where the tool
// is. A tool that has no force until it has been outside keeps to that.
void ServoLoop::takeOver(Algorithm& next, const SampleWindow& window) const noexcept {
  if (!way_known_) return next.reset(hip_W_);
  const bool in_contact = last_.in_contact && window.usable();
  next.resume(in_contact ? IsoField::inFrontOf(WindowSampler(window), last_.surface_W, last_.normal_W) : hip_W_,
              hip_W_);
}

// The link to another engine that has no window yet, if one is offered. Goes over to one that has. Changes that come
// meanwhile are that engine's, and wait.
ServoLink* ServoLoop::lookForLink() noexcept {
  ServoLink* const link = links_ != nullptr ? links_->offered() : nullptr;
  if (link == nullptr || change_ != nullptr || !link->windows->latest().usable()) return link;
  goOver(*link);
  return nullptr;
}

void ServoLoop::NextEngine::begin(double shown_N, std::int64_t wait_ticks) noexcept {
  ease_.end();
  shown_N_ = shown_N;
  wait_ticks_ = wait_ticks;
}

void ServoLoop::NextEngine::ease(TickOutput& out) noexcept {
  const double whole_N = out.force_W.stableNorm();
  if (const double shown_N = std::exchange(shown_N_, -1); shown_N >= 0) ease_.take(shown_N, whole_N);
  if (!ease_.active()) return;
  if (wait_ticks_ > 0 && whole_N > 0) {
    --wait_ticks_;
  } else {
    ease_.elapse(whole_N);
  }
  if (!(whole_N > 0)) return;
  const double share = std::max(0.0, 1 - ease_.amount() / whole_N);
  out.force_W *= share;
  out.stored_J *= share;
}

// Nothing of the old windows is used any more. Their age means nothing for the new ones.
void ServoLoop::goOver(ServoLink& link) noexcept {
  const SampleWindow last_window = windows_->latest();
  const bool faded = (newest_faults_.load(std::memory_order_relaxed) & kFadingFaults) != 0;
  next_engine_.begin(faded ? 0 : last_.force_W.stableNorm(), faded ? gate_.fadeTicks() : 0);
  windows_ = link.windows;
  tool_ = link.tool;
  live_ = link.ticks;
  window_clock_ = WindowClock(nanoseconds(parameters_.safety.stall_s));
  guard_.takeNew(link.doubtful);
  gate_.setForceLimit(std::min(link.force_limit_N, most_force_N_));
  algorithm_ = link.algorithm.get();
  std::swap(given_algorithm_, link.algorithm);
  takeOver(*algorithm_, last_window);
  links_->done();
}

// Takes a change, if there is one. A new algorithm takes over a contact from a point in front of its surface.
void ServoLoop::beginChange(const SampleWindow& window) noexcept {
  if ((last_.at_surface && !last_.in_contact) || !window.usable()) return;
  change_ = changes_->take();
  if (change_ == nullptr) return;
  change_tick_ = 0;
  limit_from_N_ = gate_.forceLimit();
  gone_over_ = 0;
  if (!change_->algorithm) return;
  leaving_share_ = guard_.share();
  guard_.takeNew(change_->doubtful);
  leaving_ = algorithm_;
  algorithm_ = change_->algorithm.get();
  std::swap(given_algorithm_, change_->algorithm);
  takeOver(*algorithm_, window);
}

// The algorithm's force, times the share that the guard leaves of it.
void ServoLoop::tickAlgorithm(const TickInput& in, TickOutput& out) noexcept {
  algorithm_->tick(in, out);
  out.force_W *= guard_.share();
  out.stored_J *= guard_.share();
  if (change_ != nullptr) goOn(in, out);
  next_engine_.ease(out);
}

// A change that is under way: the force goes over from the algorithm that leaves, with its share, to the new one.
void ServoLoop::goOn(const TickInput& in, TickOutput& out) noexcept {
  ++change_tick_;
  if (leaving_ != nullptr) {
    TickOutput left;
    leaving_->tick(in, left);
    left.force_W *= leaving_share_;
    left.stored_J *= leaving_share_;
    const std::int64_t whole = ticks_to_grow_ * ticks_to_fall_;
    gone_over_ = std::min(whole, gone_over_ + (onlyShrinks(left, out) ? ticks_to_grow_ : ticks_to_fall_));
    const double over = static_cast<double>(gone_over_) / static_cast<double>(whole);
    out.force_W = (1 - over) * left.force_W + over * out.force_W;
    out.stored_J = (1 - over) * left.stored_J + over * out.stored_J;
  }
  std::int64_t limit_ticks = 0;
  if (change_->force_limit_N) {
    const double limit_N = std::min(*change_->force_limit_N, most_force_N_);
    limit_ticks = limit_N > limit_from_N_ ? ticks_to_grow_ : ticks_to_fall_;
    const double over = std::min(1.0, static_cast<double>(change_tick_) / static_cast<double>(limit_ticks));
    gate_.setForceLimit(limit_from_N_ + over * (limit_N - limit_from_N_));
  }
  const bool is_over = leaving_ == nullptr || gone_over_ == ticks_to_grow_ * ticks_to_fall_;
  if (is_over && change_tick_ >= limit_ticks) endChange();
}

// Whether the new force is the leaving one or less of it, along the same line. One that the new algorithm cannot see
// yet may still come.
bool ServoLoop::onlyShrinks(const TickOutput& left, const TickOutput& out) const noexcept {
  constexpr double kSameLine = 0.97;  // cosine of 14 degrees
  const double left_N = left.force_W.stableNorm(), new_N = out.force_W.stableNorm();
  if (leaving_share_ < 1 || !(left_N > 0) || new_N > left_N) return false;
  if (new_N == 0) return (out.faults & kFadingFaults) == 0;
  return out.force_W.dot(left.force_W) >= kSameLine * new_N * left_N;
}

void ServoLoop::endChange() noexcept {
  leaving_ = nullptr;
  changes_->done(std::exchange(change_, nullptr));
}

double ServoLoop::sinceReport_s() const noexcept {
  return std::max(1, ticks_since_report_) / parameters_.rate_hz;
}

// Whether the tool can be there. The loop knows when it read a position, not when the device was there: one that sends
// reports of its own pace may have been there as long ago as an old position is no fault. A place that no motion
// explains is believed when the next reading lies near it: then the device counts from elsewhere, and everything begins
// anew there. Otherwise it was a wrong reading.
bool ServoLoop::believes(const Vec3& read_W) noexcept {
  if (device_.leapt()) {
    leapt_ = false;
    beginAt(read_W);
    return true;
  }
  const double way_m = (read_W - hip_W_).stableNorm();
  if (way_m <= motion_.longestWay_m(sinceReport_s(), position_waits_s_)) {
    leapt_ = false;
    return true;
  }
  const bool again = leapt_ && (read_W - leap_W_).stableNorm() < way_m;
  leapt_ = !again;
  leap_W_ = read_W;
  if (!again) return false;
  beginAt(read_W);
  gate_.beginAnew();
  return true;
}

// As at the start of a run: the tool is there, and nothing is known of how it came there. One that is inside an object
// is not pushed out.
void ServoLoop::beginAt(const Vec3& read_W) noexcept {
  algorithm_->reset(read_W);
  if (leaving_ != nullptr) leaving_->reset(read_W);
  last_ = {};
  way_known_ = false;
  velocity_.reset(read_W);
  passivity_.reset(read_W);
  motion_.begin();
  hip_W_ = read_W;
  device_.beginAnew();
  ++leaps_;
}

// Reads where the tool is. Only a report that was not read before updates velocity and energy. False: no answer that
// can be used.
bool ServoLoop::readDevice(int elapsed_ticks, std::int64_t gap_ns, std::int64_t& report_age_ns) noexcept {
  ticks_since_report_ += elapsed_ticks;
  Vec3 read_W = hip_W_;
  if (!device_.read(read_W) || !read_W.allFinite()) return false;
  // Since the loop was made a hand may have gone anywhere.
  if (std::exchange(begins_, false))
    beginAt(read_W);
  else if (!believes(read_W))
    return false;
  const double way_m = (read_W - hip_W_).stableNorm();
  hip_W_ = read_W;
  report_age_ns = device_.reportAge_ns();
  if (report_age_ns >= std::max<std::int64_t>(gap_ns, 1)) return true;
  motion_.believe(way_m, sinceReport_s(), position_waits_s_);
  passivity_.moved(hip_W_);
  velocity_.update(hip_W_, std::max(1, ticks_since_report_));
  ticks_since_report_ = 0;
  return true;
}

// Offers a force to the device and tells the gate if the device took it. False: refused.
bool ServoLoop::offer(const Vec3& force_W) noexcept {
  if (!device_.write(force_W)) return false;
  gate_.taken(device_.held(force_W));
  return true;
}

// The force fades as in a fault, until the device has taken zero. It keeps its direction, while the device is read on,
// since its currents depend on its pose. `pause` waits for the next period and gives the time since the last [ns]. It
// gives up on a device that refuses every write for kPatience_s, and on one that takes writes but never reaches zero.
template <typename Pause>
void ServoLoop::endForce(Pause pause) noexcept {
  device_.endRun();
  const auto patience = static_cast<std::int64_t>(std::ceil(kPatience_s * parameters_.rate_hz));
  // What was built up within the run comes down within as many ticks, also where the fade ends early. In double: with
  // a tiny slew the quotient is larger than any integer.
  const double longest =
      static_cast<double>(gate_.releaseTicks()) +
      std::min(static_cast<double>(ticks_run_), std::ceil(gate_.heldForce().norm() / gate_.slewPerTick()));
  std::int64_t refused = 0, writes = 0, gap_ns = 0;
  while (refused < patience && static_cast<double>(writes) <= longest) {
    const bool taken = offer(gate_.release(gap_ns));
    released_ = taken && gate_.heldForce().isZero(0);
    if (released_) return;
    refused = taken ? 0 : refused + 1;
    writes += taken ? 1 : 0;
    gap_ns = pause();
    device_.elapse(1);
    Vec3 unused_W = hip_W_;
    static_cast<void>(device_.read(unused_W));
  }
}

LoopResult ServoLoop::result() {
  return {recorder_.taken(), ticks_run_, ticks_skipped_, released_, real_time_, device_.limits(), first_due_ns_};
}

}  // namespace palpate
