// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/servo_sandbox.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "service/sandbox/call_filter.hpp"
#include "service/sandbox/capabilities.hpp"
#include "service/sandbox/file_fence.hpp"
#include "service/sandbox/memory_images.hpp"

namespace palpate {
namespace {

// Of all devices those of USB alone, and what swallows the words of children. HID devices are opened by another process
// (service/broker): a device that is plugged in later is a new file, and lies beside all others.
constexpr const char* kAllDevices = "/dev";
constexpr const char* kDevices[] = {"/dev/bus/usb", "/dev/null"};

FencedPlaces fencedPlaces(const std::string& own_folder) {
  FencedPlaces places{.hidden = kAllDevices, .own = own_folder};
  for (const char* device : kDevices)
    if (access(device, F_OK) == 0) places.devices.emplace_back(device);
  return places;
}

void noteCapabilities(const CapabilitiesLeft& left, SandboxReport& report) {
  if (!left.failure.empty()) {
    report.missing.push_back(fmt::format("capabilities ({})", left.failure));
  } else if (!left.kept.empty()) {
    report.given_up.emplace_back("other capabilities");
    report.kept.push_back(
        fmt::format("{}, since no limit gives real time (give limits instead: ulimit -r {} -l unlimited)",
                    fmt::join(left.kept, " and "), kRealTimePriorityLimit));
  } else {
    report.given_up.emplace_back("capabilities");
  }
}

}  // namespace

SandboxReport enterServoSandbox(const std::string& own_folder) {
  SandboxReport report;
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) {
    report.given_up.emplace_back("new privileges");
  } else {
    report.missing.push_back(fmt::format("new privileges ({})", std::strerror(errno)));
  }
  noteCapabilities(dropCapabilities(), report);
  report.is_root = geteuid() == 0;
  if (refuseMemoryImages()) {
    report.given_up.emplace_back("being looked into");
  } else {
    report.missing.push_back(fmt::format("its memory open to debuggers ({})", std::strerror(errno)));
  }
  const FileFence fence = fenceFiles(fencedPlaces(own_folder));
  if (fence.stands) {
    report.given_up.push_back(fmt::format("all of {} but USB", kAllDevices));
    report.given_up.push_back(own_folder.empty() ? std::string("writing files")
                                                 : fmt::format("writing files outside of {}", own_folder));
  }
  const std::string no_filter = filterCalls(fence.holds_signals);
  if (no_filter.empty()) report.given_up.emplace_back("most system calls");
  std::ranges::move(missingOf(fence, no_filter), std::back_inserter(report.missing));
  return report;
}

// Where the filter stands no file is emptied, whatever the version of Landlock (call_filter.hpp).
std::vector<std::string> missingOf(const FileFence& fence, const std::string& no_filter) {
  std::vector<std::string> missing;
  if (!fence.stands) missing.push_back(fmt::format("all of {} and writing files ({})", kAllDevices, fence.why_not));
  if (fence.stands && !fence.holds_emptying && !no_filter.empty())
    missing.emplace_back("emptying files (this kernel's Landlock is too old for it: take Linux 6.2 or newer)");
  if (!no_filter.empty()) missing.push_back(fmt::format("all system calls ({})", no_filter));
  return missing;
}

std::string wordsOf(const SandboxReport& report) {
  const std::string words = report.given_up.empty()
                                ? std::string("it has given up nothing")
                                : fmt::format("it has given up {}", fmt::join(report.given_up, ", "));
  std::vector<std::string> kept = report.missing;
  kept.insert(kept.end(), report.kept.begin(), report.kept.end());
  if (report.is_root) kept.emplace_back("the user root (start it as whoever sits at the machine)");
  return kept.empty() ? words : fmt::format("{}; it keeps {}", words, fmt::join(kept, ", and "));
}

}  // namespace palpate
