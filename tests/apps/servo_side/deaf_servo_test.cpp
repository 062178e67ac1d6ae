// SPDX-License-Identifier: Apache-2.0
// A servo's process that does not read what it is told, as one that was stopped: nobody waits long for it, and it is
// let go.
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/servo_side/remote_servo.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "service/messages/message.hpp"
#include "tests/servo/support/still_device.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace deaf_servo_test {

using testing::HasSubstr;

TEST(DeafServo, IsLetGo) {
  auto [ours, theirs] = channelPair();
  std::thread answers([&theirs = theirs] {
    Packet packet;
    if (theirs.receive(packet, 5000) != Channel::Got::kPacket) return;  // make a device
    static_cast<void>(theirs.send(encoded(wireOf(StillDevice())), 0));
    if (theirs.receive(packet, 5000) != Channel::Got::kPacket) return;  // make a loop
    static_cast<void>(theirs.send(encoded(wire::LoopMadeT{}), 0));
  });
  const Scene scene;
  wire::HelloT hello;
  hello.layout = kLinkLayout;
  RemoteServo servo(std::move(ours), {.scene = scene, .box = {}, .window_samples = 64, .hello = &hello});
  const RigSettings settings;
  servo.makeLoop(LoopParameters{}, settings, {}, makeAlgorithm(settings, {}));
  answers.join();
  servo.start();
  EXPECT_TRUE(servo.running());

  int given = 0;
  const std::string refusal = refusalOf(
      [&] {
        for (; given < 100'000; ++given) static_cast<void>(servo.give({.force_limit_N = 1.0}, settings));
      },
      Error::Code::kDevice);
  EXPECT_THAT(refusal, HasSubstr("does not listen any more"));
  EXPECT_GT(given, 10) << "some have room on their way";
  for (int i = 0; i < 2000 && servo.running(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(servo.running());
  EXPECT_TRUE(servo.isGone());
  EXPECT_THAT(refusalOf([&] { static_cast<void>(servo.wait()); }, Error::Code::kDevice),
              HasSubstr("does not take what it is told"));
  EXPECT_FALSE(servo.ended(1)) << "it has taken none";
}

}  // namespace deaf_servo_test
}  // namespace palpate
