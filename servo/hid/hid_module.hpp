// SPDX-License-Identifier: Apache-2.0
// servo/hid/hid_module.hpp: the table of the modules "hidraw" and "hidusb". Private to servo/hid.
#pragma once

#include "servo/hid/hid.hpp"

namespace palpate {

struct HidModule {
  static constexpr const char* kTable = "palpate_hid";

  std::string (*begin)();  // why hidapi cannot begin; empty: it can
  std::vector<HidInfo> (*list)();
  std::unique_ptr<ReportPort> (*open)(const std::string& path, std::string& why_not);  // null: why_not says why
  std::string (*version)();
};

}  // namespace palpate
