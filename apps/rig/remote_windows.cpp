// SPDX-License-Identifier: Apache-2.0
#include "apps/rig/remote_windows.hpp"

namespace palpate {

void publishTo(RemoteServo& servo, Engine& engine) {
  LinkMemory& memory = servo.memory();
  engine.shareWindows({.block = &memory.windows(),
                       .samples = memory.samples(),
                       .capacity = memory.capacity(),
                       .bytes = memory.windowBytes(),
                       .first_version = servo.firstVersion()});
}

}  // namespace palpate
