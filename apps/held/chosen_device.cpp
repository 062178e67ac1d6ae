// SPDX-License-Identifier: Apache-2.0
#include "apps/held/chosen_device.hpp"

#include <string_view>
#include <utility>

#include "apps/devices/calibration_stamp.hpp"
#include "apps/devices/motor_stamp.hpp"

namespace palpate {
namespace {

double figureOf(const Device& device, std::string_view key) {
  for (const DeviceFigure& figure : device.figures()) {
    if (figure.key == key) return figure.value;
  }
  return 0;
}

bool isKnownCalibrated(const Device& device, bool was_stamped) {
  const bool known = was_stamped || figureOf(device, "calibrations") > 0;
  return known && figureOf(device, "calibrated") > 0 && figureOf(device, "disconnects") == 0;
}

}  // namespace

std::shared_ptr<Device> openChosenDevice(const DeviceKind& kind, HidChoice choice, DeviceSetup setup) {
  const CalibratedAs as = choice.asCalibrated();
  // From now on it belongs to this program alone.
  const auto first = std::make_shared<std::unique_ptr<ReportPort>>(choice.open());
  CalibrationStamp stamp(as);
  const bool was_stamped = stamp.take();
  setup.motors_checked = MotorStamp(choice.asChecked()).isThere();
  setup.look_alikes = choice.look_alikes;
  for (const auto& [key, value] : choice.values) setup.values.try_emplace(key, value);
  setup.calibrated = setup.calibrated || was_stamped;
  setup.open = [first, again = std::move(choice.open)] { return *first ? std::move(*first) : again(); };
  std::unique_ptr<Device> made = makeDevice(kind.family, setup);
  return {made.release(), [stamp, was_stamped](Device* device) {
            if (isKnownCalibrated(*device, was_stamped)) static_cast<void>(stamp.put());
            delete device;
          }};
}

}  // namespace palpate
