// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scene_device.hpp"

#include <algorithm>

#include "apps/devices/calibration_stamp.hpp"
#include "apps/devices/choose_hid.hpp"
#include "apps/touch/recording_file.hpp"
#include "apps/touch/scene_settings.hpp"
#include "servo/devices/registry.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

constexpr int kLinkPriority = 79;  // just below the servo's, which waits for nobody
constexpr double kInFront_m = 0.01;
constexpr const char* kRecorded = "recorded";  // servo/devices/registry.hpp

Eigen::Matrix3d turned(const Vec3& about_rad) {
  return (Eigen::AngleAxisd(about_rad.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(about_rad.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(about_rad.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace

bool isHeld(const Scene& scene) {
  return deviceKindNamed(scene.device) != nullptr;
}

bool hasPath(const Scene& scene) {
  return !isHeld(scene) && scene.device != kRecorded;
}

VolumeBox boxOf(const Lattice& lattice, const Eigen::Vector3i& size) {
  Vec3 low = lattice.toWorld(Vec3::Zero()), high = low;
  for (int corner = 1; corner < 8; ++corner) {
    const Vec3 far = (size - Eigen::Vector3i::Ones()).cast<double>();
    const Vec3 at(corner & 1 ? far.x() : 0, corner & 2 ? far.y() : 0, corner & 4 ? far.z() : 0);
    low = low.cwiseMin(lattice.toWorld(at));
    high = high.cwiseMax(lattice.toWorld(at));
  }
  return {0.5 * (low + high), 0.5 * (high - low)};
}

Placement placementOf(const Scene& scene, const DeviceLimits& device, const VolumeBox& box) {
  Placement placement;
  placement.R_WD = scene.place_turn_rad ? turned(*scene.place_turn_rad) : facingThePatient();
  placement.scale = 1;
  if (device.workspace_radius_m > 0) placement.scale = std::max(1.0, box.half_W.norm() / device.workspace_radius_m);
  if (scene.place_scale) placement.scale = *scene.place_scale;
  placement.at_W = box.middle_W;
  if (!device.follows_force) {
    const Vec3 to_user_W = placement.R_WD * Vec3::UnitZ();
    placement.at_W += (box.half_W.cwiseProduct(to_user_W.cwiseAbs()).sum() + kInFront_m) * to_user_W;
  }
  if (scene.place_at_W) placement.at_W = *scene.place_at_W;
  placement.force_scale = scene.force_scale;
  placement.clutch = !scene.no_clutch;
  placement.edge_stiffness_N_per_m = scene.edge_stiffness_N_per_m;
  return placement;
}

SceneDevice makeSceneDevice(const Scene& scene, const Path& path, const VolumeBox& box) {
  const DeviceKind* kind = deviceKindNamed(scene.device);
  if (scene.device == kRecorded) {
    DeviceSetup setup{.rate_hz = scene.rate_hz};
    setup.recording = loadRecording(scene.recording);
    return {makeDevice(scene.device, setup), std::nullopt};
  }
  if (kind == nullptr) return {makeDevice(scene.device, deviceSetup(scene, path)), std::nullopt};
  HidChoice choice =
      chooseHid(*kind, scene.device_path, scene.device_by_libusb ? HidBackEnd::kLibusb : HidBackEnd::kHidraw);
  DeviceSetup setup{.rate_hz = scene.rate_hz,
                    .values = std::move(choice.values),
                    .open = std::move(choice.open),
                    .simulated_clock = scene.simulated_clock,
                    .calibrated = scene.device_calibrated || isStampedCalibrated(choice.device.path),
                    .thread_begins = [] { static_cast<void>(becomeRealTime(kLinkPriority)); }};
  if (scene.current_limit_A) setup.values["current_limit_A"] = *scene.current_limit_A;
  std::unique_ptr<Device> device = makeDevice(kind->family, setup);
  const Placement placement = placementOf(scene, device->limits(), box);
  return {std::make_unique<PlacedDevice>(std::move(device), placement), placement};
}

}  // namespace palpate
