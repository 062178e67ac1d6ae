// SPDX-License-Identifier: Apache-2.0
#include "apps/held/held_device.hpp"

#include "apps/devices/choose_hid.hpp"
#include "apps/held/chosen_device.hpp"
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

}  // namespace

bool isHeld(const Scene& scene) {
  return deviceKindNamed(scene.device) != nullptr;
}

void checkHeldDevice(const Scene& scene) {
  if (isHeld(scene)) static_cast<void>(chosen(scene).open());
}

std::shared_ptr<Device> openHeldDevice(const Scene& scene) {
  DeviceSetup setup{.rate_hz = scene.rate_hz,
                    .simulated_clock = scene.simulated_clock,
                    .calibrated = scene.device_calibrated,
                    .thread_begins = [] { static_cast<void>(becomeRealTime(kLinkPriority)); }};
  if (scene.current_limit_A) setup.values["current_limit_A"] = *scene.current_limit_A;
  return openChosenDevice(kindOf(scene), chosen(scene), std::move(setup));
}

HeldDevice placeHeldDevice(std::shared_ptr<Device> device, const Scene& scene, const VolumeBox& box) {
  const Placement placement = placementOf(scene, device->limits(), box);
  return {std::make_unique<PlacedDevice>(std::move(device), placement), placement};
}

}  // namespace palpate
