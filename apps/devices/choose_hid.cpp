// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/choose_hid.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/devices/hid_lock.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

std::string describe(const HidInfo& device) {
  const std::string name = device.name.empty() ? "" : fmt::format(" \"{}\"", device.name);
  return fmt::format("{}{} at {}", usbText(device.vendor, device.product), name, device.path);
}

std::string numbersOf(const DeviceKind& kind) {
  constexpr std::size_t kNamed = 4;
  std::vector<std::string> ids;
  for (const UsbId& usb : kind.usb) ids.push_back(usbText(usb.vendor, usb.product));
  if (ids.size() <= kNamed + 1) return fmt::format("{}", fmt::join(ids, ", "));
  const std::size_t more = ids.size() - kNamed;
  ids.resize(kNamed);
  return fmt::format("{} and {} others", fmt::join(ids, ", "), more);
}

DeviceValues valuesOf(const DeviceKind& kind, const HidInfo& device) {
  DeviceValues values = kind.values;
  for (const auto& [key, value] : kind.idOf(device.vendor, device.product)->values) values[key] = value;
  return values;
}

[[noreturn]] void refuseOtherUsage(const DeviceKind& kind, const HidInfo& device) {
  throw Error(Error::Code::kNotFound, fmt::format("device {}", kind.name),
              fmt::format("{} has its USB numbers, but is another thing: its usage is {}, not {}", describe(device),
                          usbText(device.usage_page, device.usage), usbText(kind.usage->first, kind.usage->second)),
              "plug the device in; if this is it, its firmware is another one");
}

[[noreturn]] void refuseNone(const DeviceKind& kind, std::span<const HidInfo> all) {
  std::vector<std::string> others;
  for (const HidInfo& device : all) others.push_back(describe(device));
  const std::string there =
      others.empty() ? "no HID device is there at all" : fmt::format("there are only {}", fmt::join(others, "; "));
  throw Error(Error::Code::kNotFound, fmt::format("device {}", kind.name),
              fmt::format("none of this machine's HID devices is one ({}); {}", numbersOf(kind), there),
              "plug it in; 'palpate devices' lists what is here");
}

const HidInfo& chooseAt(const DeviceKind& kind, std::span<const HidInfo> all, const std::string& path) {
  const auto at = std::ranges::find(all, path, &HidInfo::path);
  if (at == all.end())
    throw Error(Error::Code::kNotFound, path, "there is no HID device", "'palpate doctor' lists them");
  const Fit fit = fitOf(kind, *at);
  if (fit == Fit::kYes) return *at;
  if (fit == Fit::kOtherUsage) refuseOtherUsage(kind, *at);
  refuse(path, fmt::format("the device there is no {}: it is {}", kind.name, describe(*at)),
         "choose the kind that it is with --device; 'palpate devices' lists them");
}

}  // namespace

CheckedAs HidChoice::asChecked() const {
  return {.kind = kind,
          .usb = usbText(device.vendor, device.product),
          .place = device.serial.empty() ? hidPortName(device.path) : device.serial,
          .values = values};
}

std::vector<DeviceKind> lookAlikes(const DeviceKind& kind, const HidInfo& device) {
  std::vector<DeviceKind> others;
  for (const DeviceKind& other : knownDeviceKinds()) {
    if (other.name != kind.name && other.family == kind.family && fitOf(other, device) == Fit::kYes)
      others.push_back(other);
  }
  return others;
}

// A usage of 0 was not told: libusb does not read it.
Fit fitOf(const DeviceKind& kind, const HidInfo& device) {
  if (kind.idOf(device.vendor, device.product) == nullptr) return Fit::kNo;
  if (!kind.usage || device.usage_page == 0) return Fit::kYes;
  return std::pair(device.usage_page, device.usage) == *kind.usage ? Fit::kYes : Fit::kOtherUsage;
}

const HidInfo& chooseHid(const DeviceKind& kind, std::span<const HidInfo> all, const std::string& path) {
  if (!path.empty()) return chooseAt(kind, all, path);
  const HidInfo* chosen = nullptr;
  const HidInfo* other = nullptr;
  for (const HidInfo& device : all) {
    const Fit fit = fitOf(kind, device);
    if (fit == Fit::kOtherUsage) other = &device;
    if (fit != Fit::kYes) continue;
    if (chosen != nullptr && chosen->path != device.path) {
      refuse(fmt::format("device {}", kind.name),
             fmt::format("there are two: {} and {}", describe(*chosen), describe(device)),
             fmt::format("say which one, as --device-path {}", chosen->path));
    }
    chosen = &device;
  }
  if (chosen != nullptr) return *chosen;
  if (other != nullptr) refuseOtherUsage(kind, *other);
  refuseNone(kind, all);
}

void refuseUnknown(const std::string& path, const HidNumbers& numbers) {
  const auto has = [&](const DeviceKind& kind) { return kind.idOf(numbers.vendor, numbers.product) != nullptr; };
  if (std::ranges::any_of(knownDeviceKinds(), has)) return;
  refuse(path, fmt::format("{} is no device of a known kind", usbText(numbers.vendor, numbers.product)),
         "'palpate devices' lists the kinds; start the servo again if its kind was added since");
}

Descriptor openKnownNode(const std::string& path) {
  Descriptor node = openHidrawNode(path);
  refuseUnknown(path, numbersAt(node, path));
  return node;
}

HidChoice chooseHid(const DeviceKind& kind, const std::string& path, HidBackEnd back_end) {
  const std::vector<HidInfo> all = listHid(back_end);
  HidChoice choice;
  choice.device = chooseHid(kind, all, path);
  choice.kind = kind.name;
  choice.values = valuesOf(kind, choice.device);
  for (const DeviceKind& other : lookAlikes(kind, choice.device))
    choice.look_alikes.push_back(valuesOf(other, choice.device));
  choice.open = [kind, back_end, first = choice.device, opened = false]() mutable {
    if (!opened) {
      std::unique_ptr<ReportPort> port = openHidAlone(first.path, back_end);
      opened = true;
      return port;
    }
    std::vector<HidInfo> now = listHid(back_end);
    if (!first.serial.empty()) std::erase_if(now, [&](const HidInfo& device) { return device.serial != first.serial; });
    return openHidAlone(chooseHid(kind, now, "").path, back_end);
  };
  return choice;
}

}  // namespace palpate
