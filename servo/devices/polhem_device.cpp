// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/polhem_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/monotonic_clock.hpp"
#include "base/quantile.hpp"
#include "base/units.hpp"
#include "servo/devices/typical_hands.hpp"

namespace palpate {
namespace {

constexpr double kFastest_m_per_s = 10;  // a hand's fastest punch
constexpr int kMostLeaps = 3;            // in a row: the device does count from elsewhere
constexpr double kLongestLeap_m = 0.1;   // however long it said nothing: half a second is enough for a new start
constexpr double kForgets_s = 0.5;       // of silence; the firmware takes 1 s to start
constexpr int kSureReports = 3;          // in a row that say that the button is pressed
constexpr double kJustBefore_s = 0.1;    // so long before it was seen not pressed
constexpr int kAskAgain = 100;           // reports after which a calibration that was not heard is told again
constexpr int kFirstReport_ms = 1000;
constexpr int kListen_ms = 20;
constexpr std::size_t kPacedReports = 16;  // by which the pace of its reports is known
constexpr std::size_t kFewestPaced = 4;    // fewer say nothing of it
constexpr int kPace_ms = 200;              // or what came in this time
constexpr int kSlowest_ticks = 64;         // of a force: with more of them no contact is any good
constexpr double kMilliamperesPerAmpere = 1e3;

std::uint64_t valueOf(const std::atomic<std::uint64_t>& counter) {
  return counter.load(std::memory_order_relaxed);
}

void countOne(std::atomic<std::uint64_t>& counter) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

const PolhemParameters& checked(const PolhemParameters& p) {
  checkSetting(p.report_bytes == 14 || p.report_bytes == 64, "report size", p.report_bytes, "give 14 or 64 bytes");
  for (const ArmJoint& joint : p.joints) {
    checkSetting(joint.capstan_m > 0, "diameter of a capstan", joint.capstan_m, "give metres above 0");
    checkSetting(joint.body_m > 0, "diameter of a body", joint.body_m, "give metres above 0");
    checkSetting(joint.length_m > 0, "length of a body", joint.length_m, "give metres above 0");
    checkSetting(joint.torque_Nm_per_A > 0, "torque constant", joint.torque_Nm_per_A, "give Nm/A above 0");
    checkSetting(joint.counts_per_turn > 0, "counts of an encoder", joint.counts_per_turn, "give counts above 0");
  }
  checkSetting(p.current_limit_A >= 0, "current limit", p.current_limit_A, "give amperes above 0, or 0: not known");
  checkSetting(p.force_limit_N >= 0, "force limit", p.force_limit_N, "give 0 N or more");
  checkSetting(p.slew_limit_N_per_s >= 0, "slew limit", p.slew_limit_N_per_s, "give 0 N/s (none) or more");
  for (const int home : p.home_counts) {
    checkSetting(std::abs(home) <= std::numeric_limits<std::int16_t>::max(), "home position", home,
                 "give counts of 16 bits");
  }
  return p;
}

PolhemCounts homeOf(const PolhemParameters& p) {
  PolhemCounts home{};
  std::transform(p.home_counts.begin(), p.home_counts.end(), home.begin(),
                 [](int count) { return static_cast<std::int16_t>(count); });
  return home;
}

LinkSettings linkSettings(const PolhemParameters& p, const PolhemUse& use, std::atomic<std::uint64_t>& garbage) {
  const auto bytes = static_cast<std::size_t>(p.report_bytes);
  const auto fold = [bytes, &garbage](Report& known, const Report& report) {
    if (!parsePolhem(report.content(), bytes)) {
      countOne(garbage);
      return false;
    }
    known = report;
    return true;
  };
  return {.rest = polhemReport({}, bytes),
          .on_request = polhemReport({.count_from = homeOf(p)}, bytes),
          .answer_ms = use.answer_ms,
          .forgets_s = kForgets_s,
          .fold = fold,
          .thread_begins = use.thread_begins};
}

// The arm's x points to the user, its y to the right, its z up.
Vec3 fromArm(const Vec3& v_A) noexcept {
  return {v_A.y(), v_A.z(), v_A.x()};
}
Vec3 toArm(const Vec3& v_D) noexcept {
  return {v_D.z(), v_D.x(), v_D.y()};
}

}  // namespace

void checkPolhem(const PolhemParameters& parameters) {
  const ArmKinematics arm(checked(parameters).joints, parameters.origin_m);
  if (!arm.anglesAt(Vec3::Zero()))
    refuse("origin of the workspace", "the arm does not reach it",
           "give origin_x_m, _y_m and _z_m within its links' lengths");
}

PolhemDevice::PolhemDevice(const PolhemParameters& parameters, const PolhemUse& use, PortOpener open)
    : parameters_(checked(parameters)),
      use_(use),
      arm_(parameters.joints, parameters.origin_m),
      link_(std::move(open), linkSettings(parameters, use, garbage_)),
      calibrated_(use.calibrated) {
  link_.listen(kListen_ms);
  if (!use_.simulated_clock) link_.start();
  const std::int64_t end_ns = monotonicNow_ns() + std::llround(kFirstReport_ms * kNanosecondsPerMillisecond);
  while (received_ns_ == 0 && monotonicNow_ns() < end_ns) {
    take(link_.newest());
    if (received_ns_ != 0) break;
    if (use_.simulated_clock)
      link_.exchange();
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (received_ns_ == 0) {
    const bool answered = valueOf(garbage_) > 0;
    throw Error(Error::Code::kDevice, "device Polhem",
                answered ? formatted("its reports are not those of a Polhem with {} bytes", parameters_.report_bytes)
                         : "it answers no report",
                answered ? "choose the variant that its firmware is (palpate devices)"
                         : "switch it on, and unplug other programs that use it");
  }
  if (use_.simulated_clock) return;
  measurePace();
  if (!(report_period_s_ * use_.rate_hz <= kSlowest_ticks)) {
    throw Error(Error::Code::kDevice, "device Polhem",
                formatted("a report takes it {} ms, which is {} ticks of the servo",
                          std::lround(1e3 * report_period_s_), std::lround(report_period_s_ * use_.rate_hz)),
                "lower --rate, and see with 'palpate doctor' what slows it");
  }
}

// The device sets the pace of an exchange, and the bus adds to it: each may be slower than the servo. The middle of
// many: an answer that is lost, or a thread that begins late, is not the pace.
void PolhemDevice::measurePace() {
  const std::int64_t begin_ns = monotonicNow_ns();
  const std::int64_t end_ns = begin_ns + std::llround(kPace_ms * kNanosecondsPerMillisecond);
  const std::uint64_t before = seen_;
  std::vector<double> periods_s;
  while (periods_s.size() < kPacedReports && monotonicNow_ns() < end_ns) {
    const std::uint64_t seen = seen_;
    const std::int64_t last_ns = received_ns_;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    take(link_.newest());
    if (received_ns_ == last_ns) continue;  // nothing, or nothing that counts
    const double time_s = static_cast<double>(received_ns_ - last_ns) / kNanosecondsPerSecond;
    periods_s.push_back(time_s / static_cast<double>(seen_ - seen));
  }
  const double time_s = static_cast<double>(monotonicNow_ns() - begin_ns) / kNanosecondsPerSecond;
  // A machine so busy that this thread hardly wakes says nothing of the device's pace: then the reports are counted.
  report_period_s_ =
      periods_s.size() < kFewestPaced ? time_s / static_cast<double>(seen_ - before + 1) : median(std::move(periods_s));
}

// A force waits for the next report at most, so for one report's time. A quarter of a tick is what threads wake late.
int PolhemDevice::delayTicks() const noexcept {
  if (use_.simulated_clock) return 0;
  return std::max(1, static_cast<int>(std::ceil(report_period_s_ * use_.rate_hz - 0.25)));
}

DeviceLimits PolhemDevice::limits() const noexcept {
  const Vec3 middle = arm_.anglesAt(Vec3::Zero()).value_or(angles_);
  return {.force_limit_N = parameters_.force_limit_N,
          .position_resolution_m = arm_.resolution_m(middle),
          .force_delay_ticks = delayTicks(),
          .slew_limit_N_per_s = parameters_.slew_limit_N_per_s,
          .sets_pace = !use_.simulated_clock,
          .follows_force = true,
          .stiffness_limit_N_per_m = parameters_.stiffness_limit_N_per_m,
          .workspace_radius_m = parameters_.workspace_radius_m};
}

std::vector<HandParameters> PolhemDevice::hands() const {
  HandParameters device;
  device.device_mass_kg = parameters_.mass_kg;
  device.device_damping_Ns_per_m = parameters_.damping_Ns_per_m;
  std::vector<HandParameters> hands;
  for (const TypicalHand& hand : kTypicalHands) hands.push_back(hand.holding(device));
  return hands;
}

// One that has just come back is there once it has told where it is: until then nothing of what is known of it holds.
bool PolhemDevice::isThere() const noexcept {
  return link_.connected() && link_.connection() == connection_.load(std::memory_order_relaxed);
}

ForceOff PolhemDevice::forceOff() const noexcept {
  if (!isThere()) return ForceOff::kDisconnected;
  if (!(parameters_.force_limit_N > 0)) return ForceOff::kLimitZero;
  if (!(parameters_.current_limit_A > 0)) return ForceOff::kNoCurrentLimit;
  return calibrated_.load(std::memory_order_relaxed) ? ForceOff::kNone : ForceOff::kUncalibrated;
}

std::vector<DeviceFigure> PolhemDevice::figures() const {
  const LinkFigures f = link_.figures();
  const auto value = [](std::uint64_t count) { return static_cast<double>(count); };
  return {{"reports_written", value(f.written)},
          {"reports_received", value(f.received)},
          {"reports_lost", value(f.lost)},
          {"reports_superseded", value(f.superseded)},
          {"reports_garbled", value(valueOf(garbage_))},
          {"reports_implausible", value(valueOf(implausible_))},
          {"writes_refused", value(f.refused)},
          {"commands_too_old", value(f.rests)},
          {"disconnects", value(f.disconnects)},
          {"reconnects", value(f.reconnects)},
          {"calibrations", value(valueOf(calibrations_))},
          {"calibrated", calibrated_.load(std::memory_order_relaxed) ? 1.0 : 0.0},
          {"report_period_us", report_period_s_ * 1e6},
          {"write_p50_us", f.write_p50_us},
          {"write_p99_us", f.write_p99_us},
          {"write_max_us", f.write_max_us}};
}

void PolhemDevice::elapse(int ticks) noexcept {
  if (!use_.simulated_clock) return;
  for (int i = 0; i < ticks; ++i) {
    link_.exchange();
    ++silent_ticks_;
    take(link_.newest());
  }
}

bool PolhemDevice::isHome(const PolhemCounts& raw) const noexcept {
  const PolhemCounts home = homeOf(parameters_);
  constexpr int kSlack = 200;  // what the handle may move before the answer comes [count]
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(static_cast<std::int16_t>(raw[k] - home[k])) > kSlack) return false;
  }
  return true;
}

void PolhemDevice::countFrom(const PolhemCounts& raw) noexcept {
  for (std::size_t k = 0; k < 3; ++k) counts_[k] = raw[k];
  raw_ = raw;
  leaps_ = 0;
}

// Counts have 16 bits: an encoder that turns on beyond them begins anew at the other end.
void PolhemDevice::countOn(const PolhemCounts& raw) noexcept {
  for (std::size_t k = 0; k < 3; ++k)
    counts_[k] += static_cast<std::int16_t>(static_cast<std::uint16_t>(raw[k]) - static_cast<std::uint16_t>(raw_[k]));
  raw_ = raw;
  leaps_ = 0;
}

// Since the last report that counted, by the simulated clock: there each tick should have its report.
double PolhemDevice::silence_s() const noexcept {
  return silent_ticks_ / use_.rate_hz;
}

// How far a hand can have moved the handle since the last report that counted told where it was. A thread that reads
// late knows since when that may have been. While the device was silent it may have been anywhere, and so may its
// counts, so that time counts for little.
double PolhemDevice::longestWay_m(const Received& received) const noexcept {
  double silent_s = silence_s(), late_s = 0;
  if (!use_.simulated_clock) {
    silent_s = static_cast<double>(received.silent_ns - silent_ns_) / kNanosecondsPerSecond;
    late_s = std::max(0.0, static_cast<double>(received.time_ns - asked_ns_) / kNanosecondsPerSecond - silent_s);
  }
  return std::max(kFastest_m_per_s * late_s + std::min(kFastest_m_per_s * silent_s, kLongestLeap_m),
                  kFastest_m_per_s / use_.rate_hz);
}

// The firmware holds what the button asked until it is told to count from home, which it then does from where the
// handle is at that moment.
void PolhemDevice::heedButton(bool asks, bool just_before) noexcept {
  if (!asks) {
    asked_reports_ = 0;
    return;
  }
  if (asked_reports_++ == 0) is_pressed_now_ = just_before;
  if (asked_reports_ % kAskAgain == kSureReports) tell(is_pressed_now_ ? Pending::kCalibrating : Pending::kClearing);
}

void PolhemDevice::take(const Received& received) noexcept {
  if (received.number == seen_) return;
  seen_ = received.number;
  const auto state = parsePolhem(received.report.content(), static_cast<std::size_t>(parameters_.report_bytes));
  if (!state) return;  // before the first one: the link passes on what is a report
  requests_ = received.requests;
  const std::uint64_t connection = connection_.load(std::memory_order_relaxed);
  const bool has_forgotten = use_.simulated_clock && connection > 0 && silence_s() >= kForgets_s;
  const bool is_new = connection != received.connection || has_forgotten;
  if (is_new) {
    if (received.connection > 1 || has_forgotten) calibrated_.store(false, std::memory_order_relaxed);  // it was away
    pending_ = Pending::kNothing;
    asked_reports_ = 0;
  }
  // One that came of its own accord may be of any age: the next one begins anew.
  const bool begins = is_new || was_unasked_;
  was_unasked_ = received.unasked;
  const double since_s =
      use_.simulated_clock ? silence_s() : static_cast<double>(received.time_ns - received_ns_) / kNanosecondsPerSecond;
  if (pending_ != Pending::kNothing && !state->asks_for_calibration && isHome(state->counts)) {
    if (received.requests < request_) return;  // it may have been said before
    if (std::exchange(pending_, Pending::kNothing) == Pending::kCalibrating) {
      calibrated_.store(true, std::memory_order_relaxed);
      countOne(calibrations_);
    }
    countFrom(state->counts);
  } else if (begins) {
    countFrom(state->counts);
  } else if (!follows(state->counts, longestWay_m(received))) {
    return;
  }
  heedButton(state->asks_for_calibration, !begins && since_s <= kJustBefore_s);
  connection_.store(received.connection, std::memory_order_relaxed);
  received_ns_ = received.time_ns;
  asked_ns_ = received.asked_ns;
  silent_ns_ = received.silent_ns;
  silent_ticks_ = 0;
  pressed_ = state->pressed;
  angles_ = arm_.angles(counts_);
  position_A_ = arm_.position(angles_);
}

// Counts on to `raw`, or from there if several in a row leapt. False: it leapt, and nothing is changed. After a leap,
// what lies nearer to it than to where the handle was leaps, too, however much time has passed meanwhile.
bool PolhemDevice::follows(const PolhemCounts& raw, double longest_m) noexcept {
  const ArmCounts before = counts_;
  const PolhemCounts raw_before = raw_;
  const int leaps = leaps_;
  countOn(raw);
  const Vec3 at_A = arm_.position(arm_.angles(counts_));
  const double way_m = (at_A - position_A_).norm();
  if (way_m <= longest_m && (leaps == 0 || way_m < (at_A - leapt_to_A_).norm())) return true;
  countOne(implausible_);
  if (leaps + 1 < kMostLeaps) {
    counts_ = before;
    raw_ = raw_before;
    leaps_ = leaps + 1;
    leapt_to_A_ = at_A;
    return false;
  }
  calibrated_.store(false, std::memory_order_relaxed);
  countFrom(raw);
  return true;
}

bool PolhemDevice::read(Vec3& position_D) noexcept {
  if (!use_.simulated_clock) take(link_.newest());
  if (!isThere()) return false;
  position_D = fromArm(position_A_);
  return true;
}

std::int64_t PolhemDevice::reportAge_ns() const noexcept {
  if (!use_.simulated_clock) return monotonicNow_ns() - received_ns_;
  return static_cast<std::int64_t>(silent_ticks_ * kNanosecondsPerSecond / use_.rate_hz);
}

// `share`: what of the force is left within the current limit. All currents are cut alike, so that the force keeps its
// direction.
Vec3 PolhemDevice::currentsFor(const Vec3& force_D, double& share) const noexcept {
  share = 0;
  if (forceOff() != ForceOff::kNone || !force_D.allFinite()) return Vec3::Zero();
  const Vec3 currents_A = arm_.currents(toArm(force_D), angles_);
  const double largest_A = currents_A.cwiseAbs().maxCoeff();
  share = largest_A > parameters_.current_limit_A ? parameters_.current_limit_A / largest_A : 1;
  const double size_N = force_D.stableNorm();
  if (size_N * share > parameters_.force_limit_N) share = parameters_.force_limit_N / size_N;
  return share * currents_A;
}

// A device that is not there exerts no force, so it takes any as none, and a contact begins from none when it is back.
bool PolhemDevice::write(const Vec3& force_D) noexcept {
  if (!force_D.allFinite()) return false;
  if (!link_.connected()) return true;
  double share = 0;
  const Vec3 currents_A = currentsFor(force_D, share);
  PolhemCommand command;
  constexpr double kMost = std::numeric_limits<std::int16_t>::max();
  for (int k = 0; k < 3; ++k) {
    command.currents_mA[static_cast<std::size_t>(k)] =
        static_cast<std::int16_t>(std::lround(std::clamp(kMilliamperesPerAmpere * currents_A[k], -kMost, kMost)));
  }
  link_.post(polhemReport(command, static_cast<std::size_t>(parameters_.report_bytes)), monotonicNow_ns());
  return true;
}

Vec3 PolhemDevice::held(const Vec3& force_D) const noexcept {
  double share = 0;
  static_cast<void>(currentsFor(force_D, share));
  return share * force_D;
}

void PolhemDevice::calibrate() noexcept {
  tell(Pending::kCalibrating);
}

void PolhemDevice::tell(Pending what) noexcept {
  pending_ = what;
  request_ = requests_ + 1;
  calibrated_.store(false, std::memory_order_relaxed);
  link_.askOnce();
}

}  // namespace palpate
