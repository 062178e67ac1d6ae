// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/servo_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "servo/window/fetch.hpp"

namespace palpate {
namespace {

constexpr double kMaxRate_hz = 20000;

const LoopParameters& checked(const LoopParameters& p) {
  const auto refuse = [](const char* key, double value, const char* remedy) {
    throw Error(Error::Code::kBadInput, key, fmt::format("{:g} cannot be used", value), remedy);
  };
  if (!(p.rate_hz >= 1 && p.rate_hz <= kMaxRate_hz)) refuse("rate", p.rate_hz, "give 1 to 20000 Hz");
  if (p.ticks < 0) refuse("ticks", static_cast<double>(p.ticks), "give 0 (no end) or more");
  if (p.record_ticks < -1 || (p.record_ticks == -1 && p.ticks == 0)) {
    refuse("record ticks", static_cast<double>(p.record_ticks), "say how many ticks to keep of a run without end");
  }
  if (!std::isfinite(p.velocity_cutoff_hz)) refuse("velocity cutoff", p.velocity_cutoff_hz, "give Hz, or 0 for none");
  if (p.priority < 1 || p.priority > 99) refuse("priority", p.priority, "give 1 to 99");
  return p;
}

std::size_t recordCapacity(const LoopParameters& p) {
  const std::int64_t all = p.ticks == 0 ? std::numeric_limits<std::int64_t>::max() : p.ticks;
  return static_cast<std::size_t>(p.record_ticks < 0 ? all : std::min(all, p.record_ticks));
}

void copy(const Vec3& from, double (&to)[3]) noexcept {
  std::copy(from.begin(), from.end(), to);
}

float densityAt(const SampleWindow& window, const Vec3& p_W) noexcept {
  const Fetch f = fetch(window, p_W);
  return f.place == Place::kBeyondWindow ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(f.density);
}

}  // namespace

ServoLoop::ServoLoop(const LoopParameters& parameters, Algorithm& algorithm, Device& device, WindowExchange& windows,
                     ToolPoseMailbox& tool)
    : parameters_(checked(parameters)),
      algorithm_(algorithm),
      device_(device),
      windows_(windows),
      tool_(tool),
      gate_(parameters.safety, parameters.rate_hz),
      velocity_(parameters.velocity_cutoff_hz, parameters.rate_hz),
      recorder_(recordCapacity(parameters)) {
  if (!device_.read(hip_W_) || !hip_W_.allFinite()) {
    throw Error(Error::Code::kDevice, std::string(device_.name()), "gives no position", "check its cable and power");
  }
  algorithm_.reset(hip_W_);
  velocity_.reset(hip_W_);
  tool_.back() = ToolPose{hip_W_, Vec3::Zero(), -1, 0};
  tool_.publish();
}

ServoLoop::~ServoLoop() {
  requestStop();
}

// A multiple of the period would drift at rates whose period is no whole number of nanoseconds.
std::int64_t ServoLoop::offset_ns(std::int64_t tick) const noexcept {
  return static_cast<std::int64_t>(
      std::llround(static_cast<double>(tick) * (kNanosecondsPerSecond / parameters_.rate_hz)));
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
  }
  endForce();
  return result();
}

void ServoLoop::start() {
  running_.store(true, std::memory_order_release);
  thread_ = std::jthread([this] {
    if (parameters_.real_time) real_time_ = becomeRealTime(parameters_.priority);
    runReal();
    running_.store(false, std::memory_order_release);
  });
}

LoopResult ServoLoop::wait() {
  if (thread_.joinable()) thread_.join();
  return result();
}

void ServoLoop::runReal() {
  const std::int64_t start_ns = monotonicNow_ns() + offset_ns(1);
  TickRecord unkept;
  std::int64_t last_tick = 0;
  for (std::int64_t tick = 0; wanted(tick);) {
    const std::int64_t due_ns = start_ns + offset_ns(tick);
    sleepUntil(due_ns);
    const std::int64_t woken_ns = monotonicNow_ns();
    TickRecord* kept = recorder_.next();
    TickRecord& record = kept != nullptr ? *kept : unkept;
    const SampleWindow& window =
        runTick({tick, woken_ns - due_ns, static_cast<int>(tick - last_tick)}, woken_ns, record);
    const std::int64_t done_ns = monotonicNow_ns();
    record.tick_cost_ns =
        static_cast<std::int32_t>(std::min<std::int64_t>(done_ns - woken_ns, std::numeric_limits<std::int32_t>::max()));
    record.density = densityAt(window, hip_W_);

    last_tick = tick++;
    if (done_ns <= start_ns + offset_ns(tick)) continue;
    record.faults |= bit(ServoFault::kOverrun);
    while (wanted(tick) && start_ns + offset_ns(tick) < done_ns) {
      ++tick;
      ++ticks_skipped_;
    }
  }
  endForce();
}

// One tick, device to device; gives the window that it used, which is valid until the next.
const SampleWindow& ServoLoop::runTick(const Due& due, std::int64_t now_ns, TickRecord& record) noexcept {
  std::uint32_t faults = carried_faults_;
  if (due.elapsed_ticks > 0) device_.elapse(due.elapsed_ticks);
  ticks_since_read_ += due.elapsed_ticks;
  Vec3 read_W = hip_W_;
  const bool answered = device_.read(read_W) && read_W.allFinite();
  const std::int64_t confirmed_ns = windows_.confirmedAt_ns();  // before latest(): see window_exchange.hpp
  const SampleWindow& window = windows_.latest();
  TickInput in{hip_W_, Vec3::Zero(), &window};
  TickOutput out;
  out.vhip_W = hip_W_;
  if (answered) {
    hip_W_ = in.hip_W = read_W;
    in.hip_velocity_W = velocity_.update(read_W, std::max(1, ticks_since_read_));
    ticks_since_read_ = 0;
    algorithm_.tick(in, out);
  } else {
    faults |= bit(ServoFault::kDeviceError);
  }
  // No window is a fault of its own; it has no age.
  const std::int64_t age_ns = window.version == 0 ? 0 : now_ns - confirmed_ns;
  const GateOutput gated = gate_.pass({out.force_W, age_ns, faults | out.faults});
  const bool written = device_.write(gated.force_W);
  carried_faults_ = written ? 0 : bit(ServoFault::kDeviceError);
  tool_.back() = ToolPose{hip_W_, in.hip_velocity_W, due.tick, now_ns, out.in_contact, out.vhip_W};
  tool_.publish();
  ++ticks_run_;

  record.tick = due.tick;
  record.time_s = static_cast<double>(due.tick) / parameters_.rate_hz;
  copy(hip_W_, record.hip_W);
  copy(out.vhip_W, record.vhip_W);
  copy(out.normal_W, record.normal_W);
  copy(gated.force_W, record.force_W);
  record.plane_age_ticks = out.plane_age_ticks;
  record.window_version = window.version;
  record.faults = gated.faults | carried_faults_;
  record.lateness_ns = due.lateness_ns;
  record.window_age_ns = window.version == 0 ? 0 : now_ns - window.stamp_ns;
  record.in_contact = out.in_contact;
  return window;
}

void ServoLoop::endForce() noexcept {
  static_cast<void>(device_.write(Vec3::Zero()));
}

LoopResult ServoLoop::result() {
  return {recorder_.taken(), ticks_run_, ticks_skipped_, real_time_};
}

}  // namespace palpate
