// SPDX-License-Identifier: Apache-2.0
// The modules "hidraw" and "hidusb": this file with one of hidapi's back ends each.
#include "servo/hid/hid_module.hpp"

#include <cwchar>

#include <hidapi.h>

namespace palpate {
namespace {

// Strings of devices are any UTF-16; what is no character becomes '?'.
std::string utf8(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != 0; ++text) {
    const auto c = static_cast<std::uint32_t>(*text);
    if (c < 0x20 || c == 0x7F || (c >= 0xD800 && c < 0xE000) || c > 0x10FFFF) {
      out += '?';
    } else if (c < 0x80) {
      out += static_cast<char>(c);
    } else if (c < 0x800) {
      out += static_cast<char>(0xC0U | c >> 6U);
      out += static_cast<char>(0x80U | (c & 0x3FU));
    } else if (c < 0x10000) {
      out += static_cast<char>(0xE0U | c >> 12U);
      out += static_cast<char>(0x80U | (c >> 6U & 0x3FU));
      out += static_cast<char>(0x80U | (c & 0x3FU));
    } else {
      out += static_cast<char>(0xF0U | c >> 18U);
      out += static_cast<char>(0x80U | (c >> 12U & 0x3FU));
      out += static_cast<char>(0x80U | (c >> 6U & 0x3FU));
      out += static_cast<char>(0x80U | (c & 0x3FU));
    }
  }
  return out;
}

std::string lastError(hid_device* device) {
  const std::string words = utf8(hid_error(device));
  return words.empty() ? "hidapi does not say why" : words;
}

#ifdef PALPATE_HIDAPI_OPENS
class HidPort final : public ReportPort {
 public:
  explicit HidPort(hid_device* device) : device_(device) {}
  ~HidPort() override { hid_close(device_); }
  HidPort(const HidPort&) = delete;
  HidPort& operator=(const HidPort&) = delete;

  [[nodiscard]] PortRead read(Report& report, int timeout_ms) noexcept override {
    const int got = hid_read_timeout(device_, report.bytes.data(), report.bytes.size(), timeout_ms);
    report.size = static_cast<std::size_t>(got > 0 ? got : 0);
    if (got < 0) return PortRead::kGone;
    return got > 0 ? PortRead::kReport : PortRead::kNothing;
  }
  [[nodiscard]] bool write(const Report& report) noexcept override {
    return hid_write(device_, report.bytes.data(), report.size) == static_cast<int>(report.size);
  }

 private:
  hid_device* device_;
};

std::unique_ptr<ReportPort> openPath(const std::string& path, std::string& why_not) {
  hid_device* const device = hid_open_path(path.c_str());
  if (device == nullptr) {
    why_not = lastError(nullptr);
    return nullptr;
  }
  return std::make_unique<HidPort>(device);
}
#else
constexpr decltype(HidModule::open) openPath = nullptr;
#endif

std::string begin() {
  return hid_init() == 0 ? "" : lastError(nullptr);
}

std::vector<HidInfo> list() {
  std::vector<HidInfo> all;
  hid_device_info* const first = hid_enumerate(0, 0);
  for (const hid_device_info* d = first; d != nullptr; d = d->next) {
    all.push_back({.path = d->path != nullptr ? d->path : "",
                   .vendor = d->vendor_id,
                   .product = d->product_id,
                   .usage_page = d->usage_page,
                   .usage = d->usage,
                   .interface_number = d->interface_number,
                   .release = d->release_number,
                   .maker = utf8(d->manufacturer_string),
                   .name = utf8(d->product_string),
                   .serial = utf8(d->serial_number)});
  }
  hid_free_enumeration(first);
  return all;
}

std::string version() {
  return hid_version_str();
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::HidModule palpate_hid = {palpate::begin, palpate::list, palpate::openPath, palpate::version};
