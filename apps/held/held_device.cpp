// SPDX-License-Identifier: Apache-2.0
#include "apps/held/held_device.hpp"

#include "apps/devices/calibration_stamp.hpp"
#include "apps/devices/choose_hid.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

constexpr int kLinkPriority = 79;  // just below the servo's, which waits for nobody

HidChoice chosen(const Scene& scene) {
  return chooseHid(*deviceKindNamed(scene.device), scene.device_path,
                   scene.device_by_libusb ? HidBackEnd::kLibusb : HidBackEnd::kHidraw);
}

}  // namespace

bool isHeld(const Scene& scene) {
  return deviceKindNamed(scene.device) != nullptr;
}

void checkHeldDevice(const Scene& scene) {
  if (isHeld(scene)) static_cast<void>(chosen(scene).open());
}

HeldDevice makeHeldDevice(const Scene& scene, const VolumeBox& box) {
  HidChoice choice = chosen(scene);
  DeviceSetup setup{.rate_hz = scene.rate_hz,
                    .values = std::move(choice.values),
                    .open = std::move(choice.open),
                    .simulated_clock = scene.simulated_clock,
                    .calibrated = scene.device_calibrated || isStampedCalibrated(choice.device.path),
                    .thread_begins = [] { static_cast<void>(becomeRealTime(kLinkPriority)); }};
  if (scene.current_limit_A) setup.values["current_limit_A"] = *scene.current_limit_A;
  std::unique_ptr<Device> device = makeDevice(deviceKindNamed(scene.device)->family, setup);
  const Placement placement = placementOf(scene, device->limits(), box);
  return {std::make_unique<PlacedDevice>(std::move(device), placement), placement};
}

}  // namespace palpate
