// SPDX-License-Identifier: Apache-2.0
// apps/devices/device_files.hpp: the program's own table of devices, as text. Private to apps/devices.
#pragma once

#include <string_view>

namespace palpate {

extern const std::string_view kDevicesToml;

}  // namespace palpate
