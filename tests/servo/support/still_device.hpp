// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/still_device.hpp: a device whose handle does not move.
#pragma once

#include "servo/devices/device.hpp"

namespace palpate {

class StillDevice final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "still"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {.force_limit_N = 3}; }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    position_W = Vec3::Zero();
    return true;
  }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return true; }
};

}  // namespace palpate
