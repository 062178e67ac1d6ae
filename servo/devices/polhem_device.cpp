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

constexpr int kMostLeaps = 3;           // in a row: the device does count from elsewhere
constexpr double kLongestLeap_m = 0.1;  // however long it said nothing: half a second is enough for a new start
constexpr double kForgets_s = 0.5;      // of silence; the firmware takes 1 s to start
constexpr double kJustBefore_s = 0.1;   // so long before it was pressed the button was seen free
constexpr int kAskAgain = 100;          // reports after which a calibration that was not heard is told again
// The handle rests while it stays within 1 mm for 0.1 s: a hand's tremor does, one that goes at 10 mm/s does not.
constexpr double kRest_m = 1e-3, kRest_s = 0.1;
constexpr double kPush_N = 0.05;              // a force that counts as pushing, then and for kRest_s after
constexpr double kAtHome_m = 0.03;            // a hand puts the handle back to its home position better than that
constexpr double kTried_share = 0.5;          // of the workspace's radius, in which motors are tried
constexpr double kMostAlike = 0.9;            // cosine of the angle between the ways of two motors, there
constexpr double kTold_s = 2;                 // for so long a refusal is told
constexpr std::uint64_t kStreamingBytes = 8;  // a report of the public streaming firmware of WoodenHaptics
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
  checkSetting(p.continuous_current_A >= 0, "continuous current", p.continuous_current_A,
               "give amperes above 0, or 0: as much as the limit");
  checkSetting((p.continuous_current_A > 0) == (p.heating_s > 0), "time constant of heating", p.heating_s,
               "give continuous_current_A and heating_s both, or neither");
  checkSetting(p.force_limit_N >= 0, "force limit", p.force_limit_N, "give 0 N or more");
  checkSetting(p.slew_limit_N_per_s >= 0, "slew limit", p.slew_limit_N_per_s, "give 0 N/s (none) or more");
  for (std::size_t k = 0; k < 3; ++k) {
    checkSetting(p.lowest_rad[k] < p.highest_rad[k], "range of a joint", p.highest_rad[k],
                 "give a highest angle above the lowest");
  }
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

// Of an arm whose motors are checked nobody needs to know.
std::vector<PolhemDevice::LookAlike> lookAlikes(const PolhemParameters& p, const PolhemUse& use) {
  if (use.motors_checked) return {};
  std::vector<PolhemDevice::LookAlike> all = {{ArmKinematics(p.joints, p.origin_m), p.home_counts}};
  for (const PolhemParameters& other : use.look_alikes)
    all.push_back({ArmKinematics(checked(other).joints, other.origin_m), other.home_counts});
  return all;
}

LinkSettings linkSettings(const PolhemParameters& p, const PolhemUse& use, std::atomic<std::uint64_t>& garbage,
                          std::atomic<std::uint64_t>& garbage_bytes) {
  const auto bytes = static_cast<std::size_t>(p.report_bytes);
  const auto fold = [bytes, &garbage, &garbage_bytes](Report& known, const Report& report) {
    if (!parsePolhem(report.content(), bytes)) {
      countOne(garbage);
      garbage_bytes.store(report.size, std::memory_order_relaxed);
      return false;
    }
    known = report;
    return true;
  };
  return {.rest = polhemReport({}, bytes),
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
      look_alikes_(lookAlikes(parameters, use)),
      link_(std::move(open), linkSettings(parameters, use, garbage_, garbage_bytes_)),
      motion_(kHandMotion, arm_.resolution_m(arm_.anglesAt(Vec3::Zero()).value_or(Vec3::Zero()))),
      heat_(parameters.continuous_current_A, parameters.heating_s),
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
    const std::uint64_t bytes = valueOf(garbage_bytes_);
    const bool answered = bytes > 0;
    const auto known = static_cast<std::uint64_t>(parameters_.report_bytes);
    std::string why = "it answers no report";
    if (answered && bytes == known) why = formatted("its reports of {} bytes are not those of a Polhem", known);
    if (answered && bytes != known) {
      why = formatted("its reports have {} bytes{}, and not {}: its firmware is another one than those driven here",
                      bytes, bytes == kStreamingBytes ? ", as the public streaming firmware's" : "", known);
    }
    throw Error(Error::Code::kDevice, "device Polhem", why,
                answered ? "load a firmware that is driven here into it (docs/devices.md)"
                         : "switch it on, and end other programs that use it");
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

double PolhemDevice::forceLimit_N() const noexcept {
  return use_.motors_checked ? parameters_.force_limit_N : std::min(parameters_.force_limit_N, kUncheckedForce_N);
}

DeviceLimits PolhemDevice::limits() const noexcept {
  const Vec3 middle = arm_.anglesAt(Vec3::Zero()).value_or(angles_);
  return {.force_limit_N = forceLimit_N(),
          .motors_unchecked = !use_.motors_checked,
          .position_resolution_m = arm_.resolution_m(middle),
          .force_delay_ticks = delayTicks(),
          .slew_limit_N_per_s = parameters_.slew_limit_N_per_s,
          .sets_pace = !use_.simulated_clock,
          .follows_force = true,
          .stiffness_limit_N_per_m = parameters_.stiffness_limit_N_per_m,
          .workspace_radius_m = parameters_.workspace_radius_m,
          .is_held = true,
          .motion = kHandMotion};
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
          {"poses_impossible", value(valueOf(impossible_))},
          {"writes_refused", value(f.refused)},
          {"commands_too_old", value(f.rests)},
          {"disconnects", value(f.disconnects)},
          {"reconnects", value(f.reconnects)},
          {"calibrations", value(valueOf(calibrations_))},
          {wordsOf(kCalibrationRefusals[0]).figure, value(valueOf(refusals_[0]))},
          {wordsOf(kCalibrationRefusals[1]).figure, value(valueOf(refusals_[1]))},
          {wordsOf(kCalibrationRefusals[2]).figure, value(valueOf(refusals_[2]))},
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
    ++ticks_since_write_;
    ++ticks_;
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
  motion_.begin();
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

// Since the last report that counted told where the handle was. A thread that reads late knows since when that may have
// been.
PolhemDevice::Interval PolhemDevice::intervalTo(const Received& received) const noexcept {
  const double tick_s = 1 / use_.rate_hz;
  if (use_.simulated_clock) return {std::max(tick_s, silence_s()), 0, std::max(0.0, silence_s() - tick_s)};
  const auto seconds = [](std::int64_t time_ns) { return static_cast<double>(time_ns) / kNanosecondsPerSecond; };
  return {std::max(tick_s, seconds(received.time_ns - received_ns_)), seconds(received_ns_ - asked_ns_),
          seconds(received.silent_ns - silent_ns_)};
}

// While the device was silent it may have been anywhere, and so may its counts: that time counts for little.
double PolhemDevice::longestWay_m(const Interval& since) const noexcept {
  const double spoken_s = std::max(1 / use_.rate_hz, since.time_s - since.silent_s);
  return std::min(motion_.longestWay_m(since.time_s, since.waited_s),
                  motion_.longestWay_m(spoken_s, since.waited_s) + (since.silent_s > 0 ? kLongestLeap_m : 0));
}

// When the last report that counted came.
double PolhemDevice::reportTime_s() const noexcept {
  return use_.simulated_clock ? time_s() : static_cast<double>(received_ns_) / kNanosecondsPerSecond;
}

// A pose that no such arm has, several times in a row: it is another arm, or was calibrated elsewhere.
void PolhemDevice::noteImpossible() noexcept {
  if (isPossible() || !calibrated_.load(std::memory_order_relaxed)) {
    impossible_poses_ = 0;
    return;
  }
  countOne(impossible_);
  if (++impossible_poses_ >= kMostLeaps) calibrated_.store(false, std::memory_order_relaxed);
}

bool PolhemDevice::rests() const noexcept {
  return reportTime_s() - rests_since_s_ >= kRest_s;
}

double PolhemDevice::time_s() const noexcept {
  if (use_.simulated_clock) return static_cast<double>(ticks_) / use_.rate_hz;
  return static_cast<double>(monotonicNow_ns()) / kNanosecondsPerSecond;
}

// How far the handle is between two poses at most: each joint moves it by its angle times the longest arm that it can
// have. Lengths of arms that are not calibrated are known too, their angles are not.
double PolhemDevice::way_m(const Vec3& from, const Vec3& to) const noexcept {
  const double b_m = parameters_.joints[1].length_m, c_m = parameters_.joints[2].length_m;
  return (to - from).cwiseAbs().dot(Vec3(b_m + c_m, b_m, c_m));
}

void PolhemDevice::noteRest() noexcept {
  if (way_m(rest_, angles_) <= kRest_m) return;
  rest_ = angles_;
  rests_since_s_ = reportTime_s();
}

bool PolhemDevice::isFree() const noexcept {
  return !(time_s() - pushed_s_ < kRest_s);
}

CalibrationRefusal PolhemDevice::whyNotCalibrate() const noexcept {
  if (!isFree()) return CalibrationRefusal::kContact;
  if (!rests()) return CalibrationRefusal::kMoving;
  const Vec3 home = arm_.angles({parameters_.home_counts[0], parameters_.home_counts[1], parameters_.home_counts[2]});
  const bool is_away = calibrated_.load(std::memory_order_relaxed) && way_m(home, angles_) > kAtHome_m;
  return is_away ? CalibrationRefusal::kAway : CalibrationRefusal::kNone;
}

CalibrationRefusal PolhemDevice::refusedCalibration() const noexcept {
  return reportTime_s() - refused_s_ < kTold_s ? refused_ : CalibrationRefusal::kNone;
}

// One that was pressed while nobody looked takes the calibration away: somebody thought that it was wrong.
void PolhemDevice::press() noexcept {
  if (!is_pressed_now_) return tell(Pending::kForgetting);
  refused_ = calibrate();
  is_refused_ = refused_ != CalibrationRefusal::kNone;
  if (is_refused_) refused_s_ = reportTime_s();
}

// The firmware holds what the button asked until it is told to count from somewhere, which it then does from where the
// handle is at that moment.
void PolhemDevice::heedButton(const PolhemState& state, bool just_before) noexcept {
  const bool is_pressed =
      button_.read(state.asks_for_calibration, std::llround(reportTime_s() * kNanosecondsPerSecond));
  if (!state.asks_for_calibration) {
    is_refused_ = false;
    unheard_reports_ = 0;
    return;
  }
  if (button_.hasJustChanged()) is_pressed_now_ = just_before;
  if (is_pressed) return press();
  const bool waits = pending_ != Pending::kNothing && ++unheard_reports_ < kAskAgain;
  if (waits) return;
  if (is_refused_ && isFree() && rests()) return tell(Pending::kCountingOn);
  if (pending_ == Pending::kForgetting) return tell(pending_);
  if (pending_ == Pending::kCalibrating && whyNotCalibrate() == CalibrationRefusal::kNone) tell(pending_);
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
    button_ = {};
    is_refused_ = false;
  }
  // One that came of its own accord may be of any age: the next one begins anew.
  const bool begins = is_new || was_unasked_;
  was_unasked_ = received.unasked;
  const double since_s =
      use_.simulated_clock ? silence_s() : static_cast<double>(received.time_ns - received_ns_) / kNanosecondsPerSecond;
  const bool is_heard = received.requests >= request_ && !state->asks_for_calibration;
  if (pending_ == Pending::kCountingOn && is_heard) pending_ = Pending::kNothing;
  const bool counts_home = pending_ == Pending::kForgetting || pending_ == Pending::kCalibrating;
  bool is_elsewhere = begins;  // it counts from elsewhere than before: nobody knows whether the handle rests
  if (counts_home && !state->asks_for_calibration && isHome(state->counts)) {
    if (!is_heard) return;  // it may have been said before
    is_elsewhere = true;
    if (std::exchange(pending_, Pending::kNothing) == Pending::kCalibrating) {
      calibrated_.store(true, std::memory_order_relaxed);
      countOne(calibrations_);
    }
    countFrom(state->counts);
  } else if (begins) {
    countFrom(state->counts);
  } else if (!follows(state->counts, intervalTo(received))) {
    return;
  }
  connection_.store(received.connection, std::memory_order_relaxed);
  received_ns_ = received.time_ns;
  asked_ns_ = received.asked_ns;
  silent_ns_ = received.silent_ns;
  silent_ticks_ = 0;
  pressed_ = state->pressed;
  angles_ = arm_.angles(counts_);
  position_A_ = arm_.position(angles_);
  noteImpossible();
  if (is_elsewhere) rest_.setConstant(std::numeric_limits<double>::infinity());
  noteRest();
  heedButton(*state, !begins && since_s <= kJustBefore_s);
}

// Counts on to `raw`, or from there if several in a row leapt. False: it leapt, and nothing is changed. After a leap,
// what lies nearer to it than to where the handle was leaps, too, however much time has passed meanwhile.
bool PolhemDevice::follows(const PolhemCounts& raw, const Interval& since) noexcept {
  const ArmCounts before = counts_;
  const PolhemCounts raw_before = raw_;
  const int leaps = leaps_;
  countOn(raw);
  const Vec3 at_A = arm_.position(arm_.angles(counts_));
  const double way_m = (at_A - position_A_).norm();
  if (way_m <= longestWay_m(since) && (leaps == 0 || way_m < (at_A - leapt_to_A_).norm())) {
    motion_.believe(way_m, since.time_s, since.waited_s);
    return true;
  }
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
  rest_.setConstant(std::numeric_limits<double>::infinity());
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
  share = std::min(share, heat_.share(currents_A));
  const double size_N = force_D.stableNorm();
  const double limit_N = forceLimit_N();
  if (size_N * share > limit_N) share = limit_N / size_N;
  if (use_.motors_checked) return share * currents_A;
  const double doubtful_N = this->doubtful_N(share * currents_A);
  if (doubtful_N > kUncheckedForce_N) share *= kUncheckedForce_N / doubtful_N;
  return share * currents_A;
}

double PolhemDevice::sinceWrite_s() noexcept {
  if (use_.simulated_clock) return std::exchange(ticks_since_write_, 0) / use_.rate_hz;
  const std::int64_t now_ns = monotonicNow_ns(), before_ns = std::exchange(written_ns_, now_ns);
  return before_ns == 0 ? 0 : static_cast<double>(now_ns - before_ns) / kNanosecondsPerSecond;
}

// The most that these currents are at the handle, in whatever order and direction they flow through the motors of
// whichever arm it may be: each arm knows its pose from the same counts, and has been calibrated in its own home.
// Without bound where one of them is stretched out.
double PolhemDevice::doubtful_N(const Vec3& currents_A) const noexcept {
  const auto sorted = [](const Vec3& v) {
    Vec3 sizes = v.cwiseAbs();
    std::sort(sizes.begin(), sizes.end());
    return sizes;
  };
  const Vec3 sizes_A = sorted(currents_A);
  double most_N = 0;
  for (const LookAlike& other : look_alikes_) {
    ArmCounts counts = counts_;
    for (std::size_t k = 0; k < 3; ++k) counts[k] += other.home_counts[k] - parameters_.home_counts[k];
    const Eigen::Matrix3d pushes = other.arm.pushes(other.arm.angles(counts));
    if (!pushes.allFinite()) return sizes_A.isZero(0) ? 0 : std::numeric_limits<double>::infinity();
    const Vec3 each_N_per_A = pushes.colwise().norm().transpose().cwiseProduct(other.arm.bodyTorques());
    most_N = std::max(most_N, sizes_A.dot(sorted(each_N_per_A)));
  }
  return most_N;
}

Vec3 PolhemDevice::counts_rad() const noexcept {
  return {arm_.radPerCount(0), arm_.radPerCount(1), arm_.radPerCount(2)};
}

// Where the ways of two motors are nearly the same, one cannot be told from the other.
bool PolhemDevice::canBeTried() const noexcept {
  const Eigen::Matrix3d pushes = arm_.pushes(angles_);
  if (!pushes.allFinite() || position_A_.norm() > kTried_share * parameters_.workspace_radius_m) return false;
  const Eigen::Matrix3d ways = pushes.colwise().normalized();
  return (ways.transpose() * ways - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kMostAlike;
}

Vec3 PolhemDevice::levers_m() const noexcept {
  return arm_.pushes(angles_).colwise().norm().transpose().cwiseInverse();
}

void PolhemDevice::passHeat() noexcept {
  heat_.pass(std::exchange(flowing_A_, Vec3(Vec3::Zero())), sinceWrite_s());
}

void PolhemDevice::push(int motor, double force_N) noexcept {
  passHeat();
  if (forceOff() != ForceOff::kNone || !link_.connected() || !std::isfinite(force_N)) return post(Vec3::Zero(), 0);
  const double within_N = std::clamp(force_N, -kMostTrial_N, kMostTrial_N);
  Vec3 currents_A = Vec3::Zero();
  currents_A[motor] = std::clamp(within_N * levers_m()[motor] / arm_.bodyTorques()[motor], -parameters_.current_limit_A,
                                 parameters_.current_limit_A);
  post(currents_A, std::abs(within_N));
}

bool PolhemDevice::isPossible() const noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = angles_[static_cast<int>(k)];
    if (!(angle >= parameters_.lowest_rad[k] && angle <= parameters_.highest_rad[k])) return false;
  }
  return true;
}

// A device that is not there exerts no force, so it takes any as none, and a contact begins from none when it is back.
bool PolhemDevice::write(const Vec3& force_D) noexcept {
  if (!force_D.allFinite()) return false;
  passHeat();
  if (!link_.connected()) return true;
  double share = 0;
  const Vec3 currents_A = currentsFor(force_D, share);
  post(currents_A, share * force_D.stableNorm());
  return true;
}

void PolhemDevice::post(const Vec3& currents_A, double force_N) noexcept {
  flowing_A_ = currents_A;
  if (force_N > kPush_N) pushed_s_ = time_s();
  PolhemCommand command;
  constexpr double kMost = std::numeric_limits<std::int16_t>::max();
  for (int k = 0; k < 3; ++k) {
    command.currents_mA[static_cast<std::size_t>(k)] =
        static_cast<std::int16_t>(std::lround(std::clamp(kMilliamperesPerAmpere * currents_A[k], -kMost, kMost)));
  }
  link_.post(polhemReport(command, static_cast<std::size_t>(parameters_.report_bytes)), monotonicNow_ns());
}

Vec3 PolhemDevice::held(const Vec3& force_D) const noexcept {
  double share = 0;
  static_cast<void>(currentsFor(force_D, share));
  return share * force_D;
}

CalibrationRefusal PolhemDevice::calibrate() noexcept {
  const CalibrationRefusal why = whyNotCalibrate();
  for (std::size_t i = 0; i < kCalibrationRefusals.size(); ++i) {
    if (why == kCalibrationRefusals[i]) countOne(refusals_[i]);
  }
  if (why == CalibrationRefusal::kNone) tell(Pending::kCalibrating);
  return why;
}

void PolhemDevice::tell(Pending what) noexcept {
  pending_ = what;
  request_ = requests_ + 1;
  unheard_reports_ = 0;
  const bool counts_on = what == Pending::kCountingOn;
  if (!counts_on) calibrated_.store(false, std::memory_order_relaxed);
  link_.askOnce(polhemReport({.count_from = counts_on ? raw_ : homeOf(parameters_)},
                             static_cast<std::size_t>(parameters_.report_bytes)));
}

}  // namespace palpate
