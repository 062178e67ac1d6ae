// SPDX-License-Identifier: Apache-2.0
// apps/touch/device_ahead.hpp: the Vulkan device, opened by another thread while the volume is made.
#pragma once

#include <future>
#include <memory>
#include <string>

namespace palpate {

// Only for phantoms. Most files are read in a child process, and a process is not to be divided while one of its
// threads loads libraries, as a driver does: in the child the loader would stay locked for ever.
class DeviceAhead {
 public:
  // Begins to open it, if `volume` is a phantom and a thread can be had. Whoever opens it later waits for that, and
  // throws what was wrong, if anything was.
  DeviceAhead(const std::string& volume, const std::string& gpu_name);

 private:
  std::future<std::shared_ptr<const void>> opened_;  // its destructor waits for the thread
};

}  // namespace palpate
