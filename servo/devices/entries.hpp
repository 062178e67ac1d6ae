// SPDX-License-Identifier: Apache-2.0
// servo/devices/entries.hpp: the devices' rows in the registry, each made in the file NAME_entry.cpp. Private to
// servo/devices.
#pragma once

#include "servo/devices/registry.hpp"

namespace palpate {

[[nodiscard]] DeviceEntry simulatedEntry();
[[nodiscard]] DeviceEntry mouseEntry();  // in simulated_entry.cpp
[[nodiscard]] DeviceEntry recordedEntry();
[[nodiscard]] DeviceEntry polhemEntry();
[[nodiscard]] DeviceEntry spaceMouseEntry();

}  // namespace palpate
