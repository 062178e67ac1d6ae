// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/hid_lock.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace hid_lock_test {

namespace fs = std::filesystem;

// One device by both back ends is one; two devices, and two machines, are not.
TEST(HidLock, NamesADeviceByItsUsbPort) {
  TemporaryFolder folder;
  const auto machine = [&](const char* name) {
    fs::path sys = folder.path() / name;
    const fs::path usb = sys / "devices/pci0/usb1";
    for (const char* port : {"1-2.3", "1-4"})
      fs::create_directories(usb / port / (port + std::string(":1.0/0003:1.2.3")));
    fs::create_directories(sys / "bus/usb/devices");
    for (const char* port : {"1-2.3", "1-4"}) fs::create_symlink(usb / port, sys / "bus/usb/devices" / port);
    fs::create_directories(sys / "class/hidraw/hidraw0");
    fs::create_directories(sys / "class/hidraw/hidraw1");
    fs::create_symlink(usb / "1-2.3/1-2.3:1.0/0003:1.2.3", sys / "class/hidraw/hidraw0/device");
    fs::create_symlink(usb / "1-4/1-4:1.0/0003:1.2.3", sys / "class/hidraw/hidraw1/device");
    return sys;
  };
  const fs::path one = machine("one"), other = machine("other");
  EXPECT_EQ(hidLockName("/dev/hidraw0", one), hidLockName("1-2.3:1.0", one));
  EXPECT_EQ(hidLockName("/dev/hidraw1", one), hidLockName("1-4:1.1", one));
  EXPECT_NE(hidLockName("/dev/hidraw0", one), hidLockName("/dev/hidraw1", one));
  EXPECT_NE(hidLockName("/dev/hidraw0", one), hidLockName("/dev/hidraw0", other));
}

TEST(HidLock, NamesOthersByTheirFile) {
  TemporaryFolder folder;
  const std::string node = (folder.path() / "hidraw0").string();
  EXPECT_EQ(hidLockName(node, folder.path()), node);  // not there
  std::ofstream(node) << "x";
  const std::string named = hidLockName(node, folder.path());
  EXPECT_TRUE(named.starts_with(node + ":")) << named;
  EXPECT_EQ(hidLockName("5-1:1.0", folder.path()), "5-1");  // hidden in a container
}

}  // namespace hid_lock_test
}  // namespace palpate
