// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_rights/give_up_rights.hpp"

#include "apps/devices/choose_hid.hpp"
#include "base/module.hpp"
#include "servo/hid/hid.hpp"

namespace palpate {

WithoutRights giveUpRights(const RightsNeeded& needed) {
  static_cast<void>(knownDeviceKinds());
  WithoutRights without{.broker = std::make_unique<Broker>(Broker::Tasks{.greet = needed.greet, .open = openKnownNode}),
                        .report = {}};
  openHidrawBy([broker = without.broker.get()](const std::string& path) { return broker->open(path); });
  loadAhead(needed.modules);
  loadHidNames();
  without.report = enterServoSandbox(needed.own_folder);
  return without;
}

}  // namespace palpate
