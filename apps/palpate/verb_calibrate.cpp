// SPDX-License-Identifier: Apache-2.0
// palpate calibrate: tells a device that its handle is in its home position, from which it counts then.
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include <unistd.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/devices/calibration_stamp.hpp"
#include "apps/devices/choose_hid.hpp"
#include "apps/held/chosen_device.hpp"
#include "base/error.hpp"
#include "check_motors.hpp"
#include "device_arguments.hpp"
#include "servo/devices/calibration_refusal.hpp"
#include "servo/devices/force_off.hpp"
#include "servo/devices/jointed_arm.hpp"
#include "servo/devices/registry.hpp"
#include "servo/hid/hid.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

struct CalibrateArguments {
  std::string device, path;
  bool by_libusb = false, yes = false, check = false, calibrated = false;
};

constexpr int kSettles_ms = 500, kPatience_ms = 2000;

void awaitEnter() {
  printText("Put the handle into its home position and hold it there, then press Enter. ");
  std::string line;
  if (!std::getline(std::cin, line)) {
    printText("\n");
    refuse("palpate calibrate", "nobody answers on the terminal", "give --yes when the handle is in its home position");
  }
  if (line.find_first_not_of(" \t\r") != std::string::npos)
    refuse("palpate calibrate", fmt::format("'{}' is no Enter alone", line),
           "start again, and press Enter when the handle is there");
  throwIfInterrupted("palpate calibrate");
}

// A millisecond of the device without force.
void follow(Device& device) {
  Vec3 position;
  static_cast<void>(device.read(position));
  static_cast<void>(device.write(Vec3::Zero()));
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

// Whoever has just let go of the key may still move the handle: so it may come to rest first.
void calibrateAtRest(Device& device, const std::string& named) {
  CalibrationRefusal why = CalibrationRefusal::kMoving;
  for (int waited_ms = 0; why == CalibrationRefusal::kMoving && waited_ms < kSettles_ms; ++waited_ms) {
    follow(device);
    why = device.calibrate();
  }
  if (why != CalibrationRefusal::kNone && device.forceOff() != ForceOff::kDisconnected) {
    const CalibrationRefusalWords words = wordsOf(why);
    throw Error(Error::Code::kDevice, named, fmt::format("not calibrated: {}", words.reason),
                std::string(words.remedy));
  }
  for (int waited_ms = 0; device.forceOff() == ForceOff::kUncalibrated && waited_ms < kPatience_ms; ++waited_ms)
    follow(device);
}

// Another device may be at its place now.
bool wasAway(const Device& device) {
  for (const DeviceFigure& figure : device.figures()) {
    if (figure.key == "disconnects" && figure.value > 0) return true;
  }
  return false;
}

void calibrateHere(Device& device, const CalibrateArguments& arguments) {
  if (!arguments.yes) awaitEnter();
  const std::string named = fmt::format("device {}", arguments.device);
  calibrateAtRest(device, named);
  if (wasAway(device)) {
    throw Error(Error::Code::kDevice, named, "it was unplugged meanwhile",
                "plug it in, leave it so, and start again with its handle in the home position");
  }
  if (device.forceOff() != ForceOff::kNone) {
    throw Error(Error::Code::kDevice, named, "it did not count from its home position",
                "hold the handle still, and see with 'palpate doctor' that it answers");
  }
}

// The limits with which a device is opened. In a check its motors push, within what its kind states. Of the amplifiers
// it mostly states nothing: all that are known bear more than kTrial_A, and no push needs as much. Without a check
// nothing is exerted. The limits are then as high as can be: a device without one would say only that.
DeviceValues limitsFor(const DeviceKind& kind, const DeviceValues& stated, bool is_checked) {
  constexpr double kTrial_A = 1;
  DeviceValues limits;
  for (const DeviceParameter& p : deviceEntry(kind.family).parameters()) {
    const std::string key(p.key);
    const bool is_force = key == "force_limit_N";
    if (!is_force && key != "current_limit_A") continue;
    const auto given = stated.find(key);
    const double value = given != stated.end() ? given->second : p.usual;
    if (!is_checked) {
      limits[key] = p.highest;
    } else if (is_force && !(value > 0)) {
      const ForceOffWords words = wordsOf(ForceOff::kLimitZero);
      refuse("--check", fmt::format("the motors of {} may not push: {}", kind.name, words.reason),
             std::string(words.remedy));
    } else if (!is_force && !(value > 0)) {
      limits[key] = kTrial_A;
    }
  }
  return limits;
}

void calibrate(const CalibrateArguments& arguments) {
  if (arguments.device.empty())
    throw Error(Error::Code::kBadInput, "--device", "no device is named", "'palpate devices' lists what is here");
  const DeviceKind* kind = deviceKindNamed(arguments.device);
  if (kind == nullptr) {
    printResult("{} needs no calibration.\n", arguments.device);
    return;
  }
  HidChoice choice = chooseHid(*kind, arguments.path, arguments.by_libusb ? HidBackEnd::kLibusb : HidBackEnd::kHidraw);
  const CalibratedAs as = choice.asCalibrated();
  const MotorStamp motors(choice.asChecked());
  std::vector<std::string> look_alikes;
  for (const DeviceKind& other : lookAlikes(*kind, choice.device)) look_alikes.push_back(other.name);
  DeviceSetup setup{.values = limitsFor(*kind, choice.values, arguments.check), .calibrated = arguments.calibrated};
  std::shared_ptr<Device> device = openChosenDevice(*kind, std::move(choice), std::move(setup));
  if (device->forceOff() == ForceOff::kInputOnly) {
    printResult("{} needs no calibration.\n", arguments.device);
    return;
  }
  if (arguments.check && device->arm() == nullptr)
    refuse("--check", fmt::format("{} has no motors that could be checked", arguments.device), "leave it out");
  const bool is_known = arguments.check && device->forceOff() == ForceOff::kNone;
  if (!is_known) calibrateHere(*device, arguments);
  if (arguments.check) {
    motors.remove();  // what was found out before does not hold if this ends early
    checkMotors(*device, arguments.device, look_alikes);
    device.reset();
    printResult("The motors of {} pull the right way{}.\n", arguments.device,
                motors.put() ? fmt::format(", which is kept in {}", motors.file().string())
                             : "; this cannot be kept, since there is no folder for it (XDG_STATE_HOME)");
    return;
  }
  device.reset();  // which leaves its stamp
  const bool kept = CalibrationStamp(as).isThere();
  printResult("{} counts from its home position{}.\n", arguments.device,
              kept ? " until it is unplugged, the machine sleeps, or a program that uses it is killed"
                   : "; this cannot be kept (by hidraw, with XDG_RUNTIME_DIR set, it could), so give --calibrated to "
                     "later commands");
}

}  // namespace

void addCalibrateVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("calibrate", "tell a device that its handle is in its home position");
  verb->footer("Example: palpate calibrate --device polhem-v1");
  auto arguments = std::make_shared<CalibrateArguments>();
  addDeviceFlags(*verb, {.device = arguments->device, .path = arguments->path, .by_libusb = arguments->by_libusb});
  verb->add_flag("--yes", arguments->yes, "it is there now; do not ask");
  verb->add_flag("--check", arguments->check,
                 "see that its motors pull the right way: without that no force is more than 1 N");
  verb->add_flag("--calibrated", arguments->calibrated,
                 "it was calibrated since it was switched on, by another program: only check it")
      ->needs("--check");
  verb->callback([arguments] { calibrate(*arguments); });
}

}  // namespace palpate
