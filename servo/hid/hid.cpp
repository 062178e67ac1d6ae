// SPDX-License-Identifier: Apache-2.0
#include "servo/hid/hid.hpp"

#include <utility>

#include <iconv.h>

#include "base/error.hpp"
#include "base/module.hpp"
#include "servo/hid/hid_module.hpp"
#include "servo/hid/hidraw_node.hpp"

namespace palpate {
namespace {

const HidModule& module(HidBackEnd back_end) {
  const char* name = back_end == HidBackEnd::kHidraw ? "hidraw" : "hidusb";
  const auto& table = *static_cast<const HidModule*>(moduleTable(moduleFile(name), HidModule::kTable));
  if (const std::string why = table.begin(); !why.empty())
    throw Error(Error::Code::kDevice, "hidapi", why, "see that /sys and /dev are there (containers may hide them)");
  return table;
}

HidrawOpener& hidrawOpener() {
  static HidrawOpener opener = openHidrawNode;
  return opener;
}

}  // namespace

std::vector<HidInfo> listHid(HidBackEnd back_end) {
  return module(back_end).list();
}

void openHidrawBy(HidrawOpener opener) {
  hidrawOpener() = std::move(opener);
}

std::unique_ptr<ReportPort> openHid(const std::string& path, HidBackEnd back_end) {
  if (back_end == HidBackEnd::kHidraw) return portAt(hidrawOpener()(path));
  std::string why_not;
  std::unique_ptr<ReportPort> port = module(back_end).open(path, why_not);
  if (port == nullptr) {
    throw Error(Error::Code::kDevice, path, "it cannot be opened: " + why_not, "see that no other program uses it");
  }
  return port;
}

void loadHidNames() noexcept {
  static_cast<void>(iconv_open("WCHAR_T", "UTF-16LE"));  // never closed, so the table stays
}

std::string hidapiVersion(HidBackEnd back_end) {
  return module(back_end).version();
}

}  // namespace palpate
