// SPDX-License-Identifier: Apache-2.0
#include "apps/held/held_device.hpp"

#include "apps/devices/calibration_stamp.hpp"
#include "apps/devices/choose_hid.hpp"
#include "base/error.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

constexpr int kLinkPriority = 79;  // just below the servo's, which waits for nobody

const DeviceKind& kindOf(const Scene& scene) {
  if (const DeviceKind* kind = deviceKindNamed(scene.device)) return *kind;
  refuse("--device " + scene.device, "nobody holds it", "choose a real one; 'palpate devices' lists them");
}

// A table of the user's that cannot be read may be the one with this device's limits.
void refuseBrokenTables(const std::string& device) {
  const std::vector<std::string>& complaints = deviceKindComplaints();
  if (complaints.empty()) return;
  refuse("--device " + device, "a table of devices cannot be read, which may be about it: " + complaints.front(),
         "mend it, or move it out of " + userDeviceFolder().string());
}

HidChoice chosen(const Scene& scene) {
  refuseBrokenTables(scene.device);
  return chooseHid(kindOf(scene), scene.device_path,
                   scene.device_by_libusb ? HidBackEnd::kLibusb : HidBackEnd::kHidraw);
}

double figureOf(const Device& device, std::string_view key) {
  for (const DeviceFigure& figure : device.figures()) {
    if (figure.key == key) return figure.value;
  }
  return 0;
}

// The stamp is away while the device is used, so that none is left of a program that is killed. It comes back, or is
// made, where the device still counts from its home position, and it was a stamp or the device's button that said so.
void noteCalibration(const Device& device, const CalibratedAs& calibrated_as, bool was_stamped) {
  const bool known = was_stamped || figureOf(device, "calibrations") > 0;
  if (known && figureOf(device, "calibrated") > 0 && figureOf(device, "disconnects") == 0)
    static_cast<void>(stampCalibrated(calibrated_as));
}

}  // namespace

bool isHeld(const Scene& scene) {
  return deviceKindNamed(scene.device) != nullptr;
}

void checkHeldDevice(const Scene& scene) {
  if (isHeld(scene)) static_cast<void>(chosen(scene).open());
}

std::shared_ptr<Device> openHeldDevice(const Scene& scene) {
  HidChoice choice = chosen(scene);
  const CalibratedAs calibrated_as = choice.asCalibrated();
  const bool was_stamped = isStampedCalibrated(calibrated_as);
  DeviceSetup setup{.rate_hz = scene.rate_hz,
                    .values = std::move(choice.values),
                    .open = std::move(choice.open),
                    .simulated_clock = scene.simulated_clock,
                    .calibrated = scene.device_calibrated || was_stamped,
                    .thread_begins = [] { static_cast<void>(becomeRealTime(kLinkPriority)); }};
  if (scene.current_limit_A) setup.values["current_limit_A"] = *scene.current_limit_A;
  std::unique_ptr<Device> made = makeDevice(kindOf(scene).family, setup);
  forgetCalibration(calibrated_as.path);
  return {made.release(), [calibrated_as, was_stamped](Device* device) {
            noteCalibration(*device, calibrated_as, was_stamped);
            delete device;
          }};
}

HeldDevice placeHeldDevice(std::shared_ptr<Device> device, const Scene& scene, const VolumeBox& box) {
  const Placement placement = placementOf(scene, device->limits(), box);
  return {std::make_unique<PlacedDevice>(std::move(device), placement), placement};
}

}  // namespace palpate
