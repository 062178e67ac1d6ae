// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/held_device.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/devices/choose_hid.hpp"
#include "apps/report/words.hpp"
#include "apps/rig/contact_bounds.hpp"
#include "apps/touch/recording_file.hpp"
#include "apps/touch/scene_settings.hpp"
#include "base/atomic_file.hpp"
#include "servo/devices/force_off.hpp"

namespace palpate {
namespace {

double roundedDown(double stiffness_N_per_m) {
  const double step = std::pow(10.0, std::floor(std::log10(stiffness_N_per_m)) - 1);
  return std::floor(stiffness_N_per_m / step) * step;
}

}  // namespace

void checkDevice(const Scene& scene) {
  const DeviceKind* kind = deviceKindNamed(scene.device);
  if (!scene.record.empty()) checkWritable(scene.record);
  if (!hasPath(scene) && kind == nullptr) static_cast<void>(loadRecording(scene.recording));
  if (kind == nullptr) return;
  const HidChoice choice =
      chooseHid(*kind, scene.device_path, scene.device_by_libusb ? HidBackEnd::kLibusb : HidBackEnd::kHidraw);
  static_cast<void>(choice.open());
}

void settleStiffness(Scene& scene, const Device& device) {
  const DeviceLimits limits = device.limits();
  if (scene.stiffness_N_per_m != Scene{}.stiffness_N_per_m || !limits.follows_force) return;
  // Never stiffer than usual: who asks for the usual stiffness cannot be told from who asks for none.
  double most = renderableStiffness(rigSettings(scene, 0), loopParameters(scene), device);
  if (limits.stiffness_limit_N_per_m > 0) most = std::min(most, limits.stiffness_limit_N_per_m);
  if (most > 0 && most < scene.stiffness_N_per_m) scene.stiffness_N_per_m = roundedDown(most);
}

std::vector<std::string> heldDeviceWords(const Scene& scene, const Device& device, const Placement& placement) {
  std::vector<std::string> words;
  const DeviceLimits limits = device.limits();
  const std::string wall =
      fmt::format("a wall of {} N/m is one of {} N/m at its handle", shortNumber(scene.stiffness_N_per_m),
                  shortNumber(scene.stiffness_N_per_m * placement.scale * placement.force_scale));
  words.push_back(fmt::format("{}: 1 mm of the device moves the tool by {} mm, 1 N of the scene is {} N; {}",
                              scene.device, shortNumber(placement.scale), shortNumber(placement.force_scale), wall));
  if (const ForceOff why = device.forceOff(); why != ForceOff::kNone) {
    const ForceOffWords off = wordsOf(why);
    words.push_back(fmt::format("forces are off because {}; {}", off.reason, off.remedy));
  }
  if (limits.stiffness_limit_N_per_m > 0 && scene.stiffness_N_per_m > limits.stiffness_limit_N_per_m) {
    words.push_back(fmt::format("a stiffness of {} N/m is more than the device's maker states: give at most {} N/m",
                                shortNumber(scene.stiffness_N_per_m),
                                shortNumber(roundedDown(limits.stiffness_limit_N_per_m))));
  }
  return words;
}

RunDevice heldDevice(const std::string& kind, const Device& device) {
  RunDevice run{.kind = kind, .force_off = std::string(wordsOf(device.forceOff()).name)};
  for (const DeviceFigure& figure : device.figures()) run.figures.emplace_back(figure.key, figure.value);
  return run;
}

}  // namespace palpate
