// SPDX-License-Identifier: Apache-2.0
// Which of the devices that are there is meant.
#include "apps/devices/choose_hid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace choose_hid_test {

using testing::HasSubstr;

HidInfo polhem(const std::string& path) {
  return {.path = path, .vendor = 0x1234, .product = 6, .usage_page = 0xFFAB, .usage = 0x0200, .name = "Polhem"};
}
HidInfo lamp() {
  return {.path = "/dev/hidraw7", .vendor = 0x1234, .product = 6, .usage_page = 0xFF00, .usage = 1, .name = "Lamp"};
}
HidInfo keyboard() {
  return {.path = "/dev/hidraw8", .vendor = 0x046D, .product = 0xC31C, .usage_page = 1, .usage = 6, .name = "Keys"};
}
const DeviceKind& kind() {
  return *deviceKindNamed("polhem-v1");
}
std::string refusal(Error::Code code, const std::vector<HidInfo>& all, const std::string& path = "") {
  return refusalOf([&] { static_cast<void>(chooseHid(kind(), all, path)); }, code);
}
constexpr auto kNone = Error::Code::kNotFound, kWrong = Error::Code::kBadInput;

TEST(ChooseHid, FitsByNumbersAndUsage) {
  EXPECT_EQ(fitOf(kind(), polhem("a")), Fit::kYes);
  EXPECT_EQ(fitOf(kind(), lamp()), Fit::kOtherUsage);
  EXPECT_EQ(fitOf(kind(), keyboard()), Fit::kNo);
  HidInfo untold = lamp();
  untold.usage_page = untold.usage = 0;  // libusb reads no usages
  EXPECT_EQ(fitOf(kind(), untold), Fit::kYes);
  EXPECT_EQ(fitOf(*deviceKindNamed("spacemouse"), {.vendor = 0x046D, .product = 0xC626, .usage_page = 1, .usage = 8}),
            Fit::kYes);
}

TEST(ChooseHid, TakesTheOnlyOneOrTheOneThatIsNamed) {
  EXPECT_EQ(chooseHid(kind(), std::vector{keyboard(), lamp(), polhem("/dev/hidraw1")}, "").path, "/dev/hidraw1");
  const std::vector two = {polhem("/dev/hidraw1"), polhem("/dev/hidraw2")};
  EXPECT_EQ(chooseHid(kind(), two, "/dev/hidraw2").path, "/dev/hidraw2");
  EXPECT_THAT(refusal(kWrong, two), HasSubstr("there are two"));
  EXPECT_THAT(refusal(kWrong, two), HasSubstr("--device-path /dev/hidraw1"));
  // The same node for several usages of one device is one.
  EXPECT_EQ(chooseHid(kind(), std::vector{polhem("/dev/hidraw1"), polhem("/dev/hidraw1")}, "").path, "/dev/hidraw1");
}

TEST(ChooseHid, SaysWhyThereIsNone) {
  EXPECT_THAT(refusal(kNone, {}), HasSubstr("no HID device is there at all"));
  EXPECT_THAT(refusal(kNone, {keyboard()}), HasSubstr("there are only 046d:c31c \"Keys\" at /dev/hidraw8"));
  EXPECT_THAT(refusal(kNone, {lamp()}), HasSubstr("is another thing: its usage is ff00:0001, not ffab:0200"));
  EXPECT_THAT(refusal(kNone, {lamp()}, "/dev/hidraw7"), HasSubstr("is another thing"));
  EXPECT_THAT(refusal(kWrong, {keyboard()}, "/dev/hidraw8"), HasSubstr("the device there is no polhem-v1"));
  EXPECT_THAT(refusal(kNone, {keyboard()}, "/dev/hidraw9"), HasSubstr("there is no HID device"));
}

// What a broker opens for a servo (apps/servo_rights): what a scene may name, and no keyboard or security key.
TEST(ChooseHid, OnlyKnownNumbersAreOpenedForAServo) {
  for (const DeviceKind& one : knownDeviceKinds())
    for (const UsbId& usb : one.usb) EXPECT_NO_THROW(refuseUnknown("/dev/hidraw0", {usb.vendor, usb.product}));
  for (const HidNumbers& other : {HidNumbers{0x1050, 0x0407}, HidNumbers{keyboard().vendor, keyboard().product},
                                  HidNumbers{0x1234, 7}, HidNumbers{6, 0x1234}, HidNumbers{}})
    EXPECT_THAT(refusalOf([&] { refuseUnknown("/dev/hidraw0", other); }, kWrong),
                HasSubstr("/dev/hidraw0: " + usbText(other.vendor, other.product) + " is no device of a known kind"));
  EXPECT_THAT(refusalOf([] { static_cast<void>(openKnownNode("/dev/null")); }, kWrong),
              HasSubstr("no device of hidraw"));
}

}  // namespace choose_hid_test
}  // namespace palpate
