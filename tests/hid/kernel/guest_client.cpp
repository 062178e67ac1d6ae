// SPDX-License-Identifier: Apache-2.0
// guest_client hidraw|libusb CASE: the program's own devices code in the guest, on devices of the real kernel. Exit
// status 0: the case went as it must. It says what it saw.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "apps/devices/choose_hid.hpp"
#include "apps/servo_rights/give_up_rights.hpp"
#include "base/error.hpp"
#include "servo/devices/force_off.hpp"
#include "servo/devices/registry.hpp"
#include "servo/devices/simulated_device.hpp"
#include "tests/hid/kernel/guest_way.hpp"

namespace palpate {
namespace {

constexpr int kTicks = 900;
constexpr double kStiffness = 400;

// Each is said, also behind one that failed.
struct Check {
  bool holds;
  std::string what;
};
bool check(const std::vector<Check>& all) {
  bool all_hold = true;
  for (const Check& one : all) {
    std::printf("  %s: %s\n", one.holds ? "ok" : "FAILED", one.what.c_str());
    all_hold = all_hold && one.holds;
  }
  return all_hold;
}

Vec3 wall(const Vec3& p) {
  return p.y() < 0 ? Vec3(0, -kStiffness * p.y(), 0) : Vec3(Vec3::Zero());
}

double figure(const Device& device, std::string_view key) {
  for (const DeviceFigure& f : device.figures())
    if (f.key == key) return f.value;
  return -1;
}

std::unique_ptr<Device> opened(HidBackEnd back_end, const std::string& path = "") {
  const DeviceKind& kind = *deviceKindNamed("polhem-v1");
  HidChoice choice = chooseHid(kind, path, back_end);
  DeviceSetup setup{.rate_hz = 1 / kGuestTick_s,
                    .values = choice.values,
                    .open = choice.open,
                    .simulated_clock = true,
                    .calibrated = true,
                    .motors_checked = true};
  setup.values["current_limit_A"] = 3;
  return makeDevice(kind.family, setup);
}

// The words of a refusal; empty: there was none.
std::string refusal(HidBackEnd back_end, const std::string& path = "") {
  try {
    static_cast<void>(opened(back_end, path));
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

bool has(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

// Positions within a count of the encoders from those of the simulated device on the same way.
bool loops(HidBackEnd back_end) {
  const std::unique_ptr<Device> device = opened(back_end);
  const SampledPath path = guestWay();
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  SimulatedDevice exact(p, path, 1 / kGuestTick_s);
  // The kernel drops what a USB device sends in the first 50 ms after it is opened (usbhid_open), its first report too.
  // A device that has been asked for another one is a tick ahead.
  exact.elapse(static_cast<int>(figure(*device, "reports_written")));
  double worst_m = 0, deepest_m = 0;
  bool all_read = true;
  for (int tick = 0; tick < kTicks; ++tick) {
    Vec3 exact_at, at;
    static_cast<void>(exact.read(exact_at));
    all_read = device->read(at) && all_read;
    worst_m = std::max(worst_m, (at - exact_at).norm());
    deepest_m = std::min(deepest_m, at.y());
    static_cast<void>(exact.write(wall(exact_at)));
    static_cast<void>(device->write(wall(at)));
    exact.elapse(1);
    device->elapse(1);
  }
  const double resolution_m = device->limits().position_resolution_m;
  std::printf("  %d ticks, off by %.1f um at most, one count is %.1f um, %.1f mm deep\n", kTicks, 1e6 * worst_m,
              1e6 * resolution_m, -1e3 * deepest_m);
  return check({{all_read, "every tick had a position"},
                {worst_m <= 2 * resolution_m, "as the simulated device"},
                {deepest_m < -1e-3, "in contact"},
                {figure(*device, "reports_lost") == 0, "no report lost"},
                {figure(*device, "reports_received") >= kTicks, "a report for each tick"}});
}

bool survivesFaults(HidBackEnd back_end) {
  const std::unique_ptr<Device> device = opened(back_end);
  for (int tick = 0; tick < kTicks; ++tick) {
    Vec3 at = Vec3::Zero();
    static_cast<void>(device->read(at));
    static_cast<void>(device->write(wall(at)));
    device->elapse(1);
  }
  return check({{figure(*device, "reports_lost") > 0, "lost reports are counted"},
                {figure(*device, "reports_garbled") > 0, "garbled and short ones are counted"},
                {figure(*device, "reports_superseded") > 0, "double ones are counted"},
                {figure(*device, "disconnects") == 0, "it stays connected"}});
}

// It answers 200 reports, and none of the next 60: its last position grows old, and it is there all the same.
bool fallsSilent(HidBackEnd back_end) {
  constexpr int kSilent = 60;
  const std::unique_ptr<Device> device = opened(back_end);
  Vec3 at = Vec3::Zero();
  while (figure(*device, "reports_lost") == 0 && figure(*device, "reports_written") < 400) device->elapse(1);
  static_cast<void>(device->read(at));
  const Vec3 last = at;
  device->elapse(kSilent);
  const bool read = device->read(at);
  const double age_ms = 1e-6 * static_cast<double>(device->reportAge_ns());
  return check({{figure(*device, "reports_received") >= 190, "it answered before"},
                {figure(*device, "reports_lost") >= kSilent, "each report that got no answer is counted"},
                {read && at == last, "the last position stays"},
                {age_ms >= kSilent, "and is as old as it is"},
                {figure(*device, "disconnects") == 0, "it stays connected"}});
}

bool isGone(HidBackEnd back_end) {
  const std::unique_ptr<Device> device = opened(back_end);
  Vec3 at = Vec3::Zero();
  int tick = 0;
  while (tick < kTicks && device->read(at)) {
    static_cast<void>(device->write(Vec3(0, 1, 0)));
    device->elapse(1);
    ++tick;
  }
  return check({{tick >= 190 && tick < 220, "it was there as long as it was"},
                {figure(*device, "disconnects") == 1, "gone once"},
                {device->forceOff() == ForceOff::kDisconnected, "and that is why there is no force"},
                {device->held(Vec3(0, 1, 0)) == Vec3::Zero(), "it holds none"}});
}

bool comesBack(HidBackEnd back_end) {
  const std::unique_ptr<Device> device = opened(back_end);
  bool was_away = false;
  for (int tick = 0; tick < 40 * kTicks; ++tick) {
    Vec3 at = Vec3::Zero();
    was_away = !device->read(at) || was_away;
    static_cast<void>(device->write(Vec3(0, 1, 0)));
    device->elapse(1);
    if (figure(*device, "reconnects") > 0) break;
  }
  for (int tick = 0; tick < 5; ++tick) device->elapse(1);
  Vec3 at;
  return check({{was_away, "it was told that it is gone"},
                {figure(*device, "disconnects") == 1, "gone once"},
                {figure(*device, "reconnects") == 1, "back once"},
                {device->read(at), "it has positions again"},
                {device->forceOff() == ForceOff::kUncalibrated, "without force until it is calibrated"}});
}

bool run(const std::string& name, HidBackEnd back_end) {
  if (name == "loop") return loops(back_end);
  if (name == "faults") return survivesFaults(back_end);
  if (name == "replug") return comesBack(back_end);
  if (name == "unplug") return isGone(back_end);
  if (name == "stall") return fallsSilent(back_end);
  const std::string why = refusal(back_end);
  std::printf("  %s\n", why.c_str());
  if (name == "none") return check({{has(why, "none of this machine's HID devices is one"), "there is none"}});
  if (name == "two") {
    const std::vector<HidInfo> all = listHid(back_end);
    return check({{has(why, "there are two"), "there are two"},
                  {all.size() == 2 && refusal(back_end, all.back().path).empty(), "the second can be chosen"}});
  }
  if (name == "gadget") return check({{has(why, "is another thing: its usage is ff00:0001"), "another thing"}});
  if (name == "silent") return check({{has(why, "it answers no report"), "it answers nothing"}});
  return check({{false, "there is no case " + name}});
}

}  // namespace
}  // namespace palpate

// BACKEND is "hidraw" or "libusb", or with "-sandboxed" behind it: then in a process that has given up its rights as a
// servo does, and has a broker as it has.
int main(int count, char** words) {
  if (count != 3) return 2;
  const std::string chosen = words[1];
  const auto back_end = chosen.starts_with("libusb") ? palpate::HidBackEnd::kLibusb : palpate::HidBackEnd::kHidraw;
  palpate::WithoutRights without;
  try {
    if (chosen.ends_with("-sandboxed")) {
      without = palpate::giveUpRights({.modules = {"hidraw", "hidusb"}});
      std::printf("  %s\n", palpate::wordsOf(without.report).c_str());
      if (!without.report.missing.empty()) return 1;
    }
    const bool held = palpate::run(words[2], back_end);
    std::fflush(stdout);
    return held ? 0 : 1;
  } catch (const std::exception& error) {
    std::printf("  FAILED: %s\n", error.what());
    return 1;
  }
}
