// SPDX-License-Identifier: Apache-2.0
#include "servo/hid/hid.hpp"

#include <cerrno>

#include <unistd.h>

#include "base/error.hpp"
#include "base/module.hpp"
#include "servo/hid/hid_module.hpp"

namespace palpate {
namespace {

const HidModule& module(HidBackEnd back_end) {
  const char* name = back_end == HidBackEnd::kHidraw ? "hidraw" : "hidusb";
  const auto& table = *static_cast<const HidModule*>(moduleTable(moduleFile(name), HidModule::kTable));
  if (const std::string why = table.begin(); !why.empty())
    throw Error(Error::Code::kDevice, "hidapi", why, "see that /sys and /dev are there (containers may hide them)");
  return table;
}

}  // namespace

std::vector<HidInfo> listHid(HidBackEnd back_end) {
  return module(back_end).list();
}

std::unique_ptr<ReportPort> openHid(const std::string& path, HidBackEnd back_end) {
  const HidModule& hid = module(back_end);
  if (back_end == HidBackEnd::kHidraw && access(path.c_str(), R_OK | W_OK) != 0) {
    if (errno == ENOENT) throw Error(Error::Code::kNotFound, path, "it is not there any more", "plug the device in");
    throw Error(Error::Code::kDevice, path, "you have no right to use it",
                "run 'palpate doctor --install-udev', which installs a rule for it, and plug the device in again");
  }
  std::string why_not;
  std::unique_ptr<ReportPort> port = hid.open(path, why_not);
  if (port == nullptr) {
    throw Error(Error::Code::kDevice, path, "it cannot be opened: " + why_not, "see that no other program uses it");
  }
  return port;
}

std::string hidapiVersion(HidBackEnd back_end) {
  return module(back_end).version();
}

}  // namespace palpate
