// SPDX-License-Identifier: Apache-2.0
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "servo/devices/entries.hpp"
#include "servo/devices/recording_device.hpp"

namespace palpate {
namespace {

std::span<const DeviceParameter> noParameters() {
  return {};
}

// A recording of another rate would be another motion.
std::unique_ptr<Device> makeRecorded(const DeviceSetup& setup) {
  if (setup.recording == nullptr) refuse("device recorded", "no recording is given", "give one with --recording FILE");
  if (setup.recording->rate_hz != setup.rate_hz) {
    refuse("device recorded",
           formatted("it was recorded at {} Hz, and the servo runs at {} Hz", setup.recording->rate_hz, setup.rate_hz),
           formatted("give --rate {}", setup.recording->rate_hz));
  }
  return std::make_unique<RecordedDevice>(setup.recording);
}

}  // namespace

DeviceEntry recordedEntry() {
  return {.name = "recorded",
          .description = "a recorded session, played back to the bit (--recording FILE)",
          .parameters = noParameters,
          .make = makeRecorded};
}

}  // namespace palpate
