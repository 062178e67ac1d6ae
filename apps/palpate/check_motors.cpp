// SPDX-License-Identifier: Apache-2.0
#include "check_motors.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/devices/hand_way.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/units.hpp"
#include "servo/devices/jointed_arm.hpp"
#include "servo/devices/motor_check.hpp"

namespace palpate {
namespace {

constexpr double kHandPatience_s = 60;

struct Trouble {
  std::string reason, remedy;
};

double now_s() {
  return static_cast<double>(monotonicNow_ns()) / kNanosecondsPerSecond;
}

char letterOf(int joint) {
  return static_cast<char>('a' + joint);
}

Trouble troubleOf(int motor, const MotorFinding& finding, const std::string& kind, const std::string& others) {
  using Verdict = MotorFinding::Verdict;
  const char m = letterOf(motor), j = letterOf(finding.joint);
  switch (finding.verdict) {
    case Verdict::kRight:
      break;
    case Verdict::kReversed:
      return {fmt::format("motor {} turns the wrong way", m), fmt::format("swap the two leads of motor {}", m)};
    case Verdict::kOther:
      return {
          fmt::format("encoder {} answers to motor {}", j, m),
          fmt::format("see that the plugs of motors {0} and {1} and of encoders {0} and {1} are not swapped, and that "
                      "encoder {0} is plugged in",
                      m, j)};
    case Verdict::kDead:
      return {
          fmt::format("no encoder answers to motor {}", m),
          fmt::format("see that motor and encoder {} are plugged in and the amplifiers have power, and hold the handle "
                      "more loosely",
                      m)};
    case Verdict::kWeak:
      return {fmt::format("motor {} moves the handle by {:.0f} % of what it should", m, 100 * std::abs(finding.share)),
              fmt::format("hold the handle more loosely, and see that it is a {}{}", kind, others)};
    case Verdict::kStrong:
      return {fmt::format("motor {} is {:.0f} times as strong as it should be", m, std::abs(finding.share)),
              fmt::format("see that it is a {}{}", kind, others)};
    case Verdict::kRestless:
      return {"the handle was not held still in the middle of its workspace",
              "hold it there, loosely, and start again"};
  }
  return {};
}

// A millisecond.
Vec3 next(Device& device) {
  throwIfInterrupted("palpate calibrate");
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  Vec3 position = Vec3::Zero();
  if (!device.read(position)) {
    throw Error(Error::Code::kDevice, "palpate calibrate --check", "the device went away meanwhile",
                "plug it in, and start again");
  }
  return position;
}

void tryMotors(Device& device, const std::string& named, const std::string& kind, const std::string& others) {
  printText(
      "Hold the handle loosely in the middle of its workspace, and keep it still: each motor pushes it a little.\n");
  MotorCheck check(*device.arm());
  Vec3 position = Vec3::Zero();
  do position = next(device);
  while (check.step(now_s()));
  std::vector<std::string> reasons, remedies;
  bool is_restless = false;
  for (int motor = 0; motor < 3; ++motor) {
    const MotorFinding& finding = check.findings()[static_cast<std::size_t>(motor)];
    if (finding.verdict == MotorFinding::Verdict::kRight) continue;
    if (finding.verdict == MotorFinding::Verdict::kRestless && std::exchange(is_restless, true)) continue;
    Trouble trouble = troubleOf(motor, finding, kind, others);
    reasons.push_back(std::move(trouble.reason));
    remedies.push_back(std::move(trouble.remedy));
  }
  if (reasons.empty()) return;
  if (is_restless)
    reasons.back() += fmt::format(" (by its encoders it is {:.0f} mm away from there)", 1e3 * position.norm());
  throw Error(Error::Code::kDevice, named, fmt::format("{}", fmt::join(reasons, ", ")),
              fmt::format("{}", fmt::join(remedies, "; ")));
}

void followHand(Device& device, const std::string& named, const std::string& kind, const std::string& others) {
  constexpr std::array<const char*, 3> kWays = {"to the right", "up", "towards you"};
  for (int axis = 0; axis < 3; ++axis) {
    const char* const asked = kWays[static_cast<std::size_t>(axis)];
    printText(
        fmt::format("Now move the handle {} by some {:.0f} cm, and hold it still there.\n", asked, 100 * kAsked_m));
    HandMove move;
    std::optional<Vec3> way_D;
    const double end_s = now_s() + kHandPatience_s;
    while (!way_D && now_s() < end_s) {
      const Vec3 position_D = next(device);
      static_cast<void>(device.write(Vec3::Zero()));
      way_D = move.look(position_D, now_s());
    }
    if (!way_D) {
      throw Error(Error::Code::kDevice, named, fmt::format("its handle did not move {}", asked),
                  "start again, and move it when you are asked to");
    }
    const HandWay way = handWay(*way_D);
    if (isAsked(way, axis)) continue;
    throw Error(Error::Code::kDevice, named,
                fmt::format("asked to move it {} by {:.0f} mm, a hand moved it {} by {:.0f} mm, it says", asked,
                            1e3 * kAsked_m, wordOf(way), 1e3 * way.length_m),
                fmt::format("see that it is a {}{}, and that it was calibrated in its home position", kind, others));
  }
}

}  // namespace

void checkMotors(Device& device, const std::string& kind, const std::vector<std::string>& look_alikes) {
  const std::string named = fmt::format("device {}", kind);
  const std::string others = look_alikes.empty() ? "" : fmt::format(" and not a {}", fmt::join(look_alikes, ", a "));
  tryMotors(device, named, kind, others);
  followHand(device, named, kind, others);
}

}  // namespace palpate
