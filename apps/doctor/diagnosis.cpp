// SPDX-License-Identifier: Apache-2.0
#include "apps/doctor/diagnosis.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>
#include <unistd.h>

#include "apps/devices/choose_hid.hpp"
#include "apps/doctor/udev_rules.hpp"
#include "apps/held/chosen_device.hpp"
#include "apps/held/held_words.hpp"
#include "base/error.hpp"
#include "engine/gpu/gpu.hpp"
#include "service/sandbox/call_filter.hpp"
#include "service/sandbox/file_fence.hpp"
#include "servo/devices/force_off.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {
namespace {

using State = Finding::State;

constexpr double kSeenMotion_m = 1e-3;
constexpr double kNoGoodShare = 0.5;  // of the reports: with more of them garbled or impossible no force is any good
constexpr const char* kMendReports =
    "see that --device names what it is ('palpate devices' lists the kinds), and use another cable";
constexpr double kLateShare = 0.5;  // of a period: a tick that wakes later leaves the device too little

bool exertsForces(const DeviceKind& kind) {
  for (const DeviceParameter& p : deviceEntry(kind.family).parameters()) {
    if (p.key == "force_limit_N") return true;
  }
  return false;
}

// What of an arm can be seen and measured.
std::string looksOf(const DeviceKind& kind) {
  const auto value = [&](const char* key) {
    const auto at = kind.values.find(key);
    return at != kind.values.end() ? at->second : deviceParameter(kind.family, key).usual;
  };
  return fmt::format("links of {:g} and {:g} mm, motor a of {:g} and b of {:g} mNm/A", 1e3 * value("length_b_m"),
                     1e3 * value("length_c_m"), 1e3 * value("torque_a_Nm_per_A"), 1e3 * value("torque_b_Nm_per_A"));
}

constexpr const char* kHowToRealTime =
    "put '@audio - rtprio 95' and '@audio - memlock unlimited' into /etc/security/limits.d/palpate.conf, add yourself "
    "to the group (sudo usermod -aG audio $USER) and log in again";

std::string describe(const HidInfo& device) {
  return fmt::format("{} \"{}\" at {}", usbText(device.vendor, device.product), device.name, device.path);
}

class Doctor {
 public:
  Doctor(const DoctorRequest& request, Progress& progress) : request_(request), progress_(progress) {}

  Diagnosis run() {
    progress_.stage("looking for devices");
    lookForHid();
    chooseKind();
    openDevice();
    lookAtLimits();
    lookAtRights();
    lookAtVulkan();
    tryIt();
    conclude();
    progress_.done();
    return std::move(diagnosis_);
  }

 private:
  [[nodiscard]] HidBackEnd backEnd() const { return request_.by_libusb ? HidBackEnd::kLibusb : HidBackEnd::kHidraw; }
  void find(State state, const char* topic, std::string text, std::string remedy = "") {
    diagnosis_.findings.push_back({state, topic, std::move(text), std::move(remedy)});
  }

  void lookForHid() {
    try {
      for (const HidInfo& device : listHid(backEnd())) {
        FoundHid found{.device = device, .kinds = {}};
        for (const DeviceKind& kind : knownDeviceKinds()) {
          if (fitOf(kind, device) == Fit::kYes) found.kinds.push_back(kind.name);
        }
        found.may_use = request_.by_libusb || access(device.path.c_str(), R_OK | W_OK) == 0;
        diagnosis_.hid.push_back(std::move(found));
      }
    } catch (const Error& error) {
      find(State::kBad, "HID", fmt::format("HID devices cannot be listed: {}", error.what()));
      return;
    }
    if (diagnosis_.hid.empty()) {
      find(State::kNote, "HID", "no HID device is here at all",
           "plug one in; in a container or a virtual machine hand it through");
    }
    for (const FoundHid& found : diagnosis_.hid) {
      const std::string can_be = found.kinds.empty() ? "no haptic device that Palpate knows"
                                                     : fmt::format("can be {}", fmt::join(found.kinds, " or "));
      const bool forbidden = !found.kinds.empty() && !found.may_use;
      find(forbidden ? State::kBad : State::kNote, "HID",
           fmt::format("{}: {}{}", describe(found.device), can_be, forbidden ? ", and you may not use it" : ""),
           forbidden ? rightsRemedy(found) : "");
    }
    for (const std::string& complaint : deviceKindComplaints()) find(State::kBad, "device tables", complaint);
  }

  // The rule that is missing, and the command that installs it. Rules for a kind of the user's own are known to the
  // user's programs alone.
  [[nodiscard]] static std::string rightsRemedy(const FoundHid& found) {
    const std::string rule = udevRule(found.device.vendor, found.device.product);
    if (hasUdevRule(kUdevRulesFile, rule))
      return fmt::format("its rule in {} is there: plug the device in again, or log in at the machine itself",
                         kUdevRulesFile);
    const bool is_own =
        std::ranges::all_of(found.kinds, [](const std::string& name) { return !deviceKindNamed(name)->file.empty(); });
    const std::string command = is_own ? fmt::format("palpate doctor --udev-rules | sudo tee {}", kUdevRulesFile)
                                       : "sudo palpate doctor --install-udev";
    return fmt::format("{}, and plug the device in again (its rule: {})", command, rule.substr(0, rule.find('\n')));
  }

  // What is asked for, or the only thing that is here.
  void chooseKind() {
    if (!request_.device.empty()) {
      kind_ = deviceKindNamed(request_.device);
      return;
    }
    // One with forces, if there is one.
    const auto felt = [](const FoundHid& found) {
      return !found.kinds.empty() && exertsForces(*deviceKindNamed(found.kinds.front()));
    };
    auto usable = std::ranges::find_if(diagnosis_.hid, felt);
    if (usable == diagnosis_.hid.end())
      usable = std::ranges::find_if(diagnosis_.hid, [](const FoundHid& found) { return !found.kinds.empty(); });
    if (usable == diagnosis_.hid.end()) return;
    kind_ = deviceKindNamed(usable->kinds.front());
    if (usable->kinds.size() == 1) return;
    ambiguous_ = usable->kinds;
  }

  void openDevice() {
    if (kind_ == nullptr) return;
    diagnosis_.device = kind_->name;
    try {
      HidChoice choice = chooseHid(*kind_, request_.device_path, backEnd());
      tried_path_ = choice.device.path;
      const std::string words = describe(choice.device);
      tellLookAlikes(choice.device);
      DeviceSetup setup{.rate_hz = request_.rate_hz, .calibrated = request_.calibrated};
      if (request_.current_limit_A) setup.values["current_limit_A"] = *request_.current_limit_A;
      device_ = openChosenDevice(*kind_, std::move(choice), std::move(setup));
      find(State::kGood, "device", fmt::format("{} answers: {}", kind_->name, words));
      if (device_->limits().motors_unchecked) {
        const UncheckedWords unchecked = uncheckedWords(kind_->name);
        find(State::kNote, "motors", unchecked.reason, unchecked.remedy);
      }
    } catch (const Error& error) {
      trouble_ = error;
      find(State::kBad, "device", fmt::format("{}: {}", error.input(), error.reason()), error.remedy());
    }
  }

  // Kinds that nobody can tell from this one by what it says, and what a user can tell them apart by.
  void tellLookAlikes(const HidInfo& device) {
    std::vector<std::string> others;
    for (const DeviceKind& other : lookAlikes(*kind_, device))
      others.push_back(fmt::format("{} ({})", other.name, looksOf(other)));
    if (others.empty()) return;
    find(State::kNote, "look-alikes",
         fmt::format("it was named {} ({}); by its reports it could be {}", kind_->name, looksOf(*kind_),
                     fmt::join(others, ", ")),
         "measure its links, and read its motors' type off them");
  }

  void lookAtLimits() {
    rlimit memory{};
    getrlimit(RLIMIT_MEMLOCK, &memory);
    const bool root = geteuid() == 0;
    constexpr rlim_t kEnough = 1ULL << 30;
    if (root || memory.rlim_cur >= kEnough) return;
    find(State::kNote, "real time",
         fmt::format("only {} KiB of memory may be locked, so a tick may wait for the disk", memory.rlim_cur / 1024),
         kHowToRealTime);
  }

  // What the system gave the trial's thread, whatever the limits say: a container may take from root what root has.
  void tellRealTime(const TrialFigures& trial) {
    if (trial.fifo) return find(State::kGood, "real time", "the servo gets real-time priority");
    rlimit priority{};
    getrlimit(RLIMIT_RTPRIO, &priority);
    const bool allowed = geteuid() == 0 || priority.rlim_cur >= 80;
    find(State::kNote, "real time",
         allowed ? std::string("the system refuses the servo real-time priority, which this user may have")
                 : fmt::format("the servo gets no real-time priority (rtprio {}), so ticks will be late",
                               priority.rlim_cur),
         allowed ? "give the container or unit the right to it (CAP_SYS_NICE)" : kHowToRealTime);
  }

  // Of a servo in a process of its own; no force depends on it.
  void lookAtRights() {
    const bool has_filters = hasCallFilters(), has_fence = landlockVersion() > 0;
    if (has_filters && has_fence)
      return find(State::kGood, "rights",
                  "a servo's own process gives up files and system calls that it has no use for");
    find(State::kNote, "rights",
         fmt::format("this kernel lets a servo's own process give up {}",
                     has_filters ? "system calls, but no files (it lacks Landlock)"
                     : has_fence ? "files, but no system calls (it lacks seccomp)"
                                 : "neither files nor system calls (it lacks Landlock and seccomp)"),
         "take a kernel that has both, as Debian's, with landlock in /sys/kernel/security/lsm; forces do not depend on "
         "it");
  }

  void lookAtVulkan() {
    try {
      bool usable = false;
      for (const gpu::GpuInfo& info : gpu::listGpus()) {
        const bool good = info.unusable.empty();
        usable = usable || good;
        find(good ? State::kGood : State::kNote, "Vulkan",
             fmt::format("{} ({}, {}){}", info.name, info.type, info.driver,
                         good ? "" : fmt::format(": {}", info.unusable)));
      }
      if (!usable) find(State::kBad, "Vulkan", "no Vulkan device can be used", "install a driver: mesa-vulkan-drivers");
    } catch (const Error& error) {
      find(State::kBad, "Vulkan", error.reason(), error.remedy());
    }
  }

  void tryIt() {
    progress_.stage(fmt::format("trying the servo for {:g} s without force{}", request_.trial_s,
                                device_ ? "; move the handle" : ""));
    const TrialFigures trial =
        tryServo(device_.get(), request_.rate_hz, request_.trial_s, [&](double share) { progress_.fraction(share); });
    diagnosis_.trial = trial;
    tellRealTime(trial);
    const double period_us = 1e6 / request_.rate_hz;
    const bool late = trial.late_p99_us > kLateShare * period_us;
    find(late ? State::kNote : State::kGood, "servo",
         fmt::format(
             "at {:g} Hz ticks woke {:.0f} us late in the middle, {:.0f} us at 99 %, {:.0f} us at most; {:.2g} % "
             "were left out",
             trial.rate_hz, trial.late_p50_us, trial.late_p99_us, trial.late_max_us, 100 * trial.skipped_share),
         late ? "end what else runs, give real-time priority, or lower --rate" : "");
    if (!device_) return;
    const auto figure = [&](std::string_view key) {
      const auto at = std::ranges::find(trial.figures, key, &DeviceFigure::key);
      return at == trial.figures.end() ? 0.0 : at->value;
    };
    const double came = figure("reports_received") + figure("reports_garbled");
    const double useless = figure("reports_garbled") + figure("reports_implausible");
    const double bad = figure("reports_lost") + useless;
    if (exertsForces(*kind_) && !(trial.reports_per_s > 0) && useless == 0) {
      silent_ = true;
      return find(State::kBad, "device", "it answered when it was opened, and nothing since",
                  "switch it off and on, and see that no other program uses it");
    }
    find(bad > 0.01 * came ? State::kNote : State::kGood, "device",
         fmt::format(
             "{:.0f} reports a second; {:.0f} lost, {:.0f} garbled, {:.0f} not possible; a write takes {:.0f} us "
             "in the middle, {:.0f} us at 99 %",
             trial.reports_per_s, figure("reports_lost"), figure("reports_garbled"), figure("reports_implausible"),
             figure("write_p50_us"), figure("write_p99_us")),
         bad > 0.01 * came ? "use another cable or port, without a hub" : "");
    if (figure("poses_impossible") > 0) {
      find(State::kBad, "device",
           fmt::format("{:.0f} reports tell of a pose that no {} has", figure("poses_impossible"), kind_->name),
           fmt::format(
               "see that it is one, hold its handle in its home position, and run 'palpate calibrate --device {}'",
               kind_->name));
    }
    is_garbled_ = exertsForces(*kind_) && useless > kNoGoodShare * came;
    if (is_garbled_) return find(State::kBad, "device", "most of its reports cannot be used", kMendReports);
    if (trial.motion_m >= kSeenMotion_m)
      find(State::kGood, "device", fmt::format("its handle moved by {:.1f} mm", 1e3 * trial.motion_m));
    else
      find(State::kNote, "device", "its handle did not move",
           "move it while this runs: encoders that count are seen then");
  }

  void off(const std::string& why, const std::string& remedy) {
    diagnosis_.verdict = fmt::format("forces are off because {}{}{}", why, remedy.empty() ? "" : "; ", remedy);
  }

  void conclude() {
    const auto no_vulkan = std::ranges::find_if(
        diagnosis_.findings, [](const Finding& f) { return f.topic == "Vulkan" && f.state == State::kBad; });
    const auto tried = std::ranges::find(diagnosis_.hid, tried_path_, [](const FoundHid& f) { return f.device.path; });
    const bool forbidden = tried != diagnosis_.hid.end() && !tried->may_use;
    if (trouble_ && forbidden)
      return off(fmt::format("you have no right to use {}", tried_path_), rightsRemedy(*tried));
    if (trouble_) return off(fmt::format("{}: {}", trouble_->input(), trouble_->reason()), trouble_->remedy());
    if (!deviceKindComplaints().empty() && kind_ != nullptr)
      return off("a table of devices cannot be read, which may be about it", deviceKindComplaints().front());
    if (kind_ == nullptr && !request_.device.empty()) {
      return off(fmt::format("nobody holds the device '{}'", request_.device),
                 "choose a real one with --device, or leave it out; 'palpate devices' lists them");
    }
    if (kind_ == nullptr) {
      return off("no haptic device is here",
                 "plug one in; without one 'palpate touch phantom:sphere' feels with a simulated hand");
    }
    if (!exertsForces(*kind_))
      return off(std::string(wordsOf(ForceOff::kInputOnly).reason), std::string(wordsOf(ForceOff::kInputOnly).remedy));
    if (!ambiguous_.empty()) {
      return off(fmt::format("its USB numbers do not say which arm it is ({})", fmt::join(ambiguous_, ", ")),
                 fmt::format("measure its links (look-alikes above) and say it, as --device {}", ambiguous_.front()));
    }
    if (silent_) return off("the device does not answer any more", "switch it off and on, and try again");
    if (is_garbled_) return off("most of the device's reports cannot be used", kMendReports);
    const ForceOff why = device_->forceOff();
    if (why != ForceOff::kNone) return off(std::string(wordsOf(why).reason), std::string(wordsOf(why).remedy));
    if (no_vulkan != diagnosis_.findings.end()) return off(no_vulkan->text, no_vulkan->remedy);
    diagnosis_.forces_on = true;
    diagnosis_.verdict = fmt::format("forces are on: {}", kind_->name);
  }

  const DoctorRequest& request_;
  Progress& progress_;
  Diagnosis diagnosis_;
  const DeviceKind* kind_ = nullptr;
  std::vector<std::string> ambiguous_;
  std::string tried_path_;
  bool silent_ = false, is_garbled_ = false;
  std::shared_ptr<Device> device_;
  std::optional<Error> trouble_;
};

}  // namespace

Diagnosis diagnose(const DoctorRequest& request, Progress& progress) {
  return Doctor(request, progress).run();
}

}  // namespace palpate
