// SPDX-License-Identifier: Apache-2.0
// servo/hid/hid_module.hpp: the table of the modules "hidraw" and "hidusb". Private to servo/hid.
#pragma once

#include "servo/hid/hid.hpp"

namespace palpate {

struct HidModule {
  static constexpr const char* kTable = "palpate_hid";

  std::string (*begin)();  // why hidapi cannot begin; empty: it can
  std::vector<HidInfo> (*list)();
  // Null, and why_not says why. Of "hidusb" alone: nodes of hidraw are opened by hidraw_node.hpp.
  std::unique_ptr<ReportPort> (*open)(const std::string& path, std::string& why_not);
  std::string (*version)();
};

}  // namespace palpate
