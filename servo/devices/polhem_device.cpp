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
#include "servo/devices/one_writer.hpp"
#include "servo/devices/typical_hands.hpp"

namespace palpate {
namespace {

constexpr double kForgets_s = 0.5;            // of silence; the firmware takes 1 s to start
constexpr double kTried_share = 0.5;          // of the workspace's radius, in which motors are tried
constexpr double kMostAlike = 0.9;            // cosine of the angle between the ways of two motors, there
constexpr double kLeastTrial_N = 0.05;        // with less no motor is tried: a hand that holds the handle hides it
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

LookAlikes lookAlikes(const PolhemParameters& p, const PolhemUse& use) {
  const auto armOf = [](const PolhemParameters& arm) {
    return LookAlikes::Arm{ArmKinematics(arm.joints, arm.origin_m), arm.home_counts, arm.lowest_rad, arm.highest_rad};
  };
  std::vector<LookAlikes::Arm> all = {armOf(p)};
  for (const PolhemParameters& other : use.look_alikes) all.push_back(armOf(checked(other)));
  return LookAlikes(std::move(all));
}

// How far a radian of each joint moves the handle at most.
Vec3 reachOf(const PolhemParameters& p) {
  const double b_m = p.joints[1].length_m, c_m = p.joints[2].length_m;
  return {b_m + c_m, b_m, c_m};
}

Vec3 homeAngles(const PolhemParameters& p) {
  return ArmKinematics(p.joints, p.origin_m).angles({p.home_counts[0], p.home_counts[1], p.home_counts[2]});
}

LinkSettings linkSettings(const PolhemParameters& p, const PolhemUse& use, std::atomic<std::uint64_t>& garbage,
                          std::atomic<std::uint64_t>& garbage_bytes) {
  const auto bytes = static_cast<std::size_t>(p.report_bytes);
  const auto fold = [bytes, &garbage, &garbage_bytes](Report& known, const Report& report) {
    if (!parsePolhem(report.content(), bytes)) {
      countUp(garbage);
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
      believed_(arm_, 1 / use.rate_hz),
      calibration_(reachOf(parameters), homeAngles(parameters), use.calibrated),
      heat_(parameters.continuous_current_A, parameters.heating_s) {
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
  const Vec3 middle = arm_.anglesAt(Vec3::Zero()).value_or(believed_.angles());
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
  return calibration_.isCalibrated() ? ForceOff::kNone : ForceOff::kUncalibrated;
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
          {"poses_impossible", value(calibration_.impossiblePoses())},
          {"writes_refused", value(f.refused)},
          {"commands_too_old", value(f.rests)},
          {"disconnects", value(f.disconnects)},
          {"reconnects", value(f.reconnects)},
          {"calibrations", value(calibration_.calibrations())},
          {wordsOf(kCalibrationRefusals[0]).figure, value(calibration_.refusals(0))},
          {wordsOf(kCalibrationRefusals[1]).figure, value(calibration_.refusals(1))},
          {wordsOf(kCalibrationRefusals[2]).figure, value(calibration_.refusals(2))},
          {"calibrated", calibration_.isCalibrated() ? 1.0 : 0.0},
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

// Since the last report that counted, by the simulated clock: there each tick should have its report.
double PolhemDevice::silence_s() const noexcept {
  return silent_ticks_ / use_.rate_hz;
}

// Since the last report that counted told where the handle was. A thread that reads late knows since when that may have
// been.
BelievedCounts::Interval PolhemDevice::intervalTo(const Received& received) const noexcept {
  const double tick_s = 1 / use_.rate_hz;
  if (use_.simulated_clock) return {std::max(tick_s, silence_s()), 0, std::max(0.0, silence_s() - tick_s)};
  const auto seconds = [](std::int64_t time_ns) { return static_cast<double>(time_ns) / kNanosecondsPerSecond; };
  return {std::max(tick_s, seconds(received.time_ns - received_ns_)), seconds(received_ns_ - asked_ns_),
          seconds(received.silent_ns - silent_ns_)};
}

// When the last report that counted came.
double PolhemDevice::reportTime_s() const noexcept {
  return use_.simulated_clock ? time_s() : static_cast<double>(received_ns_) / kNanosecondsPerSecond;
}

double PolhemDevice::time_s() const noexcept {
  if (use_.simulated_clock) return static_cast<double>(ticks_) / use_.rate_hz;
  return static_cast<double>(monotonicNow_ns()) / kNanosecondsPerSecond;
}

CalibrationRefusal PolhemDevice::refusedCalibration() const noexcept {
  return calibration_.refusal(reportTime_s());
}

CalibrationRefusal PolhemDevice::whyNotCalibrate() const noexcept {
  return calibration_.whyNot(time_s());
}

CalibrationRefusal PolhemDevice::calibrate() noexcept {
  const CalibrationRefusal why = calibration_.ask(time_s());
  if (why == CalibrationRefusal::kNone) tell(HomeCalibration::Order::kCountFromHome);
  return why;
}

// The firmware then counts from there, where the handle is at that moment.
void PolhemDevice::tell(HomeCalibration::Order order) noexcept {
  if (order == HomeCalibration::Order::kNone) return;
  const bool counts_on = order == HomeCalibration::Order::kCountOn;
  link_.askOnce(polhemReport({.count_from = counts_on ? believed_.raw() : homeOf(parameters_)},
                             static_cast<std::size_t>(parameters_.report_bytes)));
}

void PolhemDevice::take(const Received& received) noexcept {
  if (received.number == seen_) return;
  seen_ = received.number;
  const auto state = parsePolhem(received.report.content(), static_cast<std::size_t>(parameters_.report_bytes));
  if (!state) return;  // before the first one: the link passes on what is a report
  const std::uint64_t connection = connection_.load(std::memory_order_relaxed);
  const bool has_forgotten = use_.simulated_clock && connection > 0 && silence_s() >= kForgets_s;
  const bool is_new = connection != received.connection || has_forgotten;
  if (is_new) calibration_.beginAnew(received.connection > 1 || has_forgotten);
  // One that came of its own accord may be of any age: the next one begins anew.
  const bool begins = is_new || was_unasked_;
  was_unasked_ = received.unasked;
  const double since_s =
      use_.simulated_clock ? silence_s() : static_cast<double>(received.time_ns - received_ns_) / kNanosecondsPerSecond;
  const HomeCalibration::Answer answer =
      calibration_.answer(received.requests, state->asks_for_calibration, isHome(state->counts));
  if (answer == HomeCalibration::Answer::kTooEarly) return;
  bool is_elsewhere = begins || answer == HomeCalibration::Answer::kFromHome;
  if (is_elsewhere) {
    believed_.countFrom(state->counts);
  } else {
    const BelievedCounts::Verdict verdict = believed_.look(state->counts, intervalTo(received));
    if (verdict != BelievedCounts::Verdict::kMotion) countUp(implausible_);
    if (verdict == BelievedCounts::Verdict::kLeap) return;
    is_elsewhere = verdict == BelievedCounts::Verdict::kElsewhere;
    if (is_elsewhere) calibration_.forget();
  }
  connection_.store(received.connection, std::memory_order_relaxed);
  received_ns_ = received.time_ns;
  asked_ns_ = received.asked_ns;
  silent_ns_ = received.silent_ns;
  silent_ticks_ = 0;
  pressed_ = state->pressed;
  tell(calibration_.look({.time_s = reportTime_s(),
                          .angles = believed_.angles(),
                          .asks = state->asks_for_calibration,
                          .just_before = !begins && since_s <= HomeCalibration::kJustBefore_s,
                          .is_elsewhere = is_elsewhere,
                          .is_possible = look_alikes_.isPossible(believed_.counts())},
                         time_s()));
}

bool PolhemDevice::read(Vec3& position_D) noexcept {
  if (!use_.simulated_clock) take(link_.newest());
  if (!isThere()) return false;
  position_D = fromArm(believed_.position_A());
  return true;
}

std::int64_t PolhemDevice::reportAge_ns() const noexcept {
  if (!use_.simulated_clock) return monotonicNow_ns() - received_ns_;
  return static_cast<std::int64_t>(silent_ticks_ * kNanosecondsPerSecond / use_.rate_hz);
}

// What of currents that are a force at the handle may flow: within the current limit, what the motors bear, and a limit
// of the force. All currents are cut alike, so that the force keeps its direction.
double PolhemDevice::allowedShare(const Vec3& currents_A, double force_N, double limit_N) const noexcept {
  const double largest_A = currents_A.cwiseAbs().maxCoeff();
  double share = largest_A > parameters_.current_limit_A ? parameters_.current_limit_A / largest_A : 1;
  share = std::min(share, heat_.share(currents_A));
  if (force_N * share > limit_N) share = limit_N / force_N;
  return share;
}

Vec3 PolhemDevice::currentsFor(const Vec3& force_D, double& share) const noexcept {
  share = 0;
  if (forceOff() != ForceOff::kNone || !force_D.allFinite()) return Vec3::Zero();
  const Vec3 currents_A = arm_.currents(toArm(force_D), believed_.angles());
  share = allowedShare(currents_A, force_D.stableNorm(), forceLimit_N());
  if (use_.motors_checked) return share * currents_A;
  const double most_N = look_alikes_.most_N(share * currents_A, believed_.counts());
  if (most_N > kUncheckedForce_N) share *= kUncheckedForce_N / most_N;
  return share * currents_A;
}

double PolhemDevice::sinceWrite_s() noexcept {
  if (use_.simulated_clock) return std::exchange(ticks_since_write_, 0) / use_.rate_hz;
  const std::int64_t now_ns = monotonicNow_ns(), before_ns = std::exchange(written_ns_, now_ns);
  return before_ns == 0 ? 0 : static_cast<double>(now_ns - before_ns) / kNanosecondsPerSecond;
}

Vec3 PolhemDevice::counts_rad() const noexcept {
  return {arm_.radPerCount(0), arm_.radPerCount(1), arm_.radPerCount(2)};
}

// Where the ways of two motors are nearly the same, one cannot be told from the other. Where an arm that it may be is
// nearly stretched out, a push could not be strong enough for anybody to see it.
bool PolhemDevice::canBeTried() const noexcept {
  const Eigen::Matrix3d pushes = arm_.pushes(believed_.angles());
  if (!pushes.allFinite() || believed_.position_A().norm() > kTried_share * parameters_.workspace_radius_m)
    return false;
  const Eigen::Matrix3d ways = pushes.colwise().normalized();
  if (!((ways.transpose() * ways - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kMostAlike)) return false;
  return trialLimit_N(0) >= kLeastTrial_N && trialLimit_N(1) >= kLeastTrial_N && trialLimit_N(2) >= kLeastTrial_N;
}

Vec3 PolhemDevice::levers_m() const noexcept {
  return arm_.pushes(believed_.angles()).colwise().norm().transpose().cwiseInverse();
}

void PolhemDevice::passHeat() noexcept {
  heat_.pass(std::exchange(flowing_A_, Vec3(Vec3::Zero())), sinceWrite_s());
}

// The current of a motor alone for a force at the handle of this kind of arm [A/N].
double PolhemDevice::trialCurrent_A_per_N(int motor) const noexcept {
  return levers_m()[motor] / arm_.bodyTorques()[motor];
}

// The most that a motor may push, at the handle of this kind of arm. A check finds out what the arm is, so before it
// nobody knows: also where it was checked before. Arms whose joints cannot be there are left out. With them hardly
// anything would be left in the middle of the workspace, where others would be nearly stretched out.
double PolhemDevice::trialLimit_N(int motor) const noexcept {
  const double limit_N = std::min({kMostTrial_N, parameters_.force_limit_N, kUncheckedForce_N});
  const Vec3 currents_A = limit_N * trialCurrent_A_per_N(motor) * Vec3::Unit(motor);
  const double share = allowedShare(currents_A, limit_N, limit_N);
  const double most_N = look_alikes_.mostOfPossible_N(share * currents_A, believed_.counts());
  return limit_N * (most_N > kUncheckedForce_N ? share * kUncheckedForce_N / most_N : share);
}

// None where so little is left: an arm that it may be is nearly stretched out, where its force grows within a report.
double PolhemDevice::push(int motor, double force_N) noexcept {
  passHeat();
  double pushed_N = 0;
  if (forceOff() == ForceOff::kNone && link_.connected() && std::isfinite(force_N)) {
    const double limit_N = trialLimit_N(motor);
    if (limit_N >= kLeastTrial_N) pushed_N = std::clamp(force_N, -limit_N, limit_N);
  }
  const Vec3 currents_A =
      pushed_N == 0 ? Vec3::Zero() : Vec3(pushed_N * trialCurrent_A_per_N(motor) * Vec3::Unit(motor));
  post(currents_A, std::abs(pushed_N));
  return pushed_N;
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
  calibration_.push(force_N, time_s());
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

}  // namespace palpate
