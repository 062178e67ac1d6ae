// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/registry.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/nearest_word.hpp"
#include "servo/devices/entries.hpp"

namespace palpate {
namespace {

std::span<const DeviceEntry> entries() noexcept {
  static const std::array kEntries = {simulatedEntry(), mouseEntry(), recordedEntry(), polhemEntry(),
                                      spaceMouseEntry()};
  return kEntries;
}

const DeviceParameter* find(const DeviceEntry& entry, std::string_view key) {
  const std::span<const DeviceParameter> all = entry.parameters();
  const auto at = std::find_if(all.begin(), all.end(), [&](const DeviceParameter& p) { return p.key == key; });
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

std::span<const DeviceEntry> devices() noexcept {
  return entries();
}

const DeviceEntry& deviceEntry(std::string_view name) {
  std::vector<std::string> names;
  for (const DeviceEntry& entry : entries()) {
    if (entry.name == name) return entry;
    names.emplace_back(entry.name);
  }
  refuse(formatted("device \"{}\"", name), "there is none of this name",
         withDidYouMean(name, names, formatted("choose one of {}", listed(names))));
}

const DeviceParameter& deviceParameter(std::string_view device, std::string_view key) {
  const DeviceParameter* parameter = find(deviceEntry(device), key);
  if (parameter == nullptr) throw std::logic_error(formatted("device {} has no parameter {}", device, key));
  return *parameter;
}

std::unique_ptr<Device> makeDevice(std::string_view name, const DeviceSetup& setup) {
  const DeviceEntry& entry = deviceEntry(name);
  for (const auto& [key, value] : setup.values) {
    const std::string input = formatted("{} of device {}", key, name);
    const DeviceParameter* parameter = find(entry, key);
    if (parameter == nullptr) refuse(input, "the device has no such parameter", "leave it out");
    if (value >= parameter->lowest && value <= parameter->highest) continue;
    refuse(input, formatted("{} is out of range", value),
           formatted("give {} to {}", parameter->lowest, parameter->highest));
  }
  if (entry.needs_path && setup.path == nullptr)
    refuse(formatted("device {}", name), "there is no path to lead it along", "give a path");
  if (entry.needs_port && !setup.open)
    refuse(formatted("device {}", name), "nothing connects it", "give a way to open it");
  return entry.make(setup);
}

}  // namespace palpate
