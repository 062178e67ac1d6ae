// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene.hpp"

#include "servo/algorithms/registry.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {

std::string defaultAlgorithm() {
  return std::string(algorithms().front().name);
}

std::string defaultDevice() {
  return std::string(devices().front().name);
}

double usualOfDevice(std::string_view key) {
  return deviceParameter(devices().front().name, key).usual;
}

}  // namespace palpate
