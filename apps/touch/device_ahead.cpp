// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/device_ahead.hpp"

#include <system_error>

#include "engine/gpu/gpu.hpp"

namespace palpate {

DeviceAhead::DeviceAhead(const std::string& volume, const std::string& gpu_name) {
  if (!volume.starts_with("phantom:")) return;
  try {
    opened_ = std::async(std::launch::async, [gpu_name] { return gpu::openAhead({.name = gpu_name}); });
  } catch (
      const std::system_error&) {  // NOLINT(bugprone-empty-catch): without a thread it is opened when its turn comes
  }
}

}  // namespace palpate
