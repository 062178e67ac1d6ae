// SPDX-License-Identifier: Apache-2.0
// The engine's end of a servo's process that does not do its part; remote_rig_test.cpp has those that do.
#include "apps/servo_side/remote_servo.hpp"

#include <chrono>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/servo_side/attachments.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "service/messages/message.hpp"
#include "tests/servo/support/still_device.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace remote_servo_test {

using testing::HasSubstr;

// Makes device and loop, and does not read any further.
class Silent {
 public:
  Silent() {
    auto [ours, theirs] = channelPair();
    ours_ = std::move(ours);
    theirs_ = std::move(theirs);
    wire::HelloT hello;
    hello.layout = kLinkLayout;
    EXPECT_TRUE(theirs_.send(encoded(std::move(hello)), 0));
    answers_ = std::jthread([this] {
      Packet packet;
      if (theirs_.receive(packet, 5000) != Channel::Got::kPacket) return;  // make a device
      static_cast<void>(theirs_.send(encoded(wireOf(StillDevice())), 0));
      if (theirs_.receive(packet, 5000) != Channel::Got::kPacket) return;  // make a loop
      static_cast<void>(theirs_.send(encoded(wire::LoopMadeT{}), 0));
    });
  }
  [[nodiscard]] Channel takeChannel() { return std::move(ours_); }
  [[nodiscard]] Channel& theirs() { return theirs_; }

 private:
  Channel ours_, theirs_;
  std::jthread answers_;  // last member: it uses the others
};

struct Running : testing::Test {
  Silent silent;
  const Scene scene;
  const RigSettings settings;
  RemoteServo servo;
  explicit Running(std::optional<int> end_patience_ms = 500)
      : servo(silent.takeChannel(),
              {.scene = scene, .box = {}, .window_samples = 64, .end_patience_ms = end_patience_ms}) {
    servo.makeLoop(LoopParameters{}, settings, {}, makeAlgorithm(settings, {}));
    servo.start();
  }
};

// As one that was stopped: nobody waits long for it, and it is let go.
TEST_F(Running, OneThatDoesNotReadIsLetGo) {
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

// Whatever else it says.
TEST_F(Running, OneThatTalksOnIsNotWaitedForWithoutAnEnd) {
  std::jthread talks([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      static_cast<void>(silent.theirs().send(encoded(wire::DeviceStateT{}), 0));
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(servo.running());
  servo.requestStop();
  EXPECT_THAT(refusalOf([&] { static_cast<void>(servo.wait()); }, Error::Code::kDevice), HasSubstr("does not end"));
}

// A servo's own file may let the force fade for longer than the scene says (`least_fade_s`): it is told to stop, and
// ends 6 s later, where the scene's fade takes 0.1 s.
struct RunningForLong : Running {
  RunningForLong() : Running(std::nullopt) {}
};
TEST_F(RunningForLong, OneThatFadesForLongIsWaitedFor) {
  const auto begin = std::chrono::steady_clock::now();
  servo.requestStop();
  std::jthread fades([&] {
    std::this_thread::sleep_for(std::chrono::seconds(6));
    wire::EndedT ended;
    ended.released = true;
    const SealedMemory none = recordsMemory({});
    static_cast<void>(silent.theirs().send(encoded(std::move(ended)), 0, none.descriptor()));
  });
  const LoopResult result = servo.wait();
  EXPECT_TRUE(result.released);
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(5900));
}

TEST_F(Running, AMessageOfAnotherKindEndsIt) {
  EXPECT_TRUE(silent.theirs().send(encoded(wire::LoopMadeT{}), 0));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(servo.wait()); }), HasSubstr("a message LoopMade where none may be"));
}

TEST(RemoteServo, TellsTicksOnlyIfItWasAskedTo) {
  const Scene scene;
  LiveTicks live(16);
  for (const std::size_t room : {std::size_t{0}, std::size_t{16}}) {
    Silent silent;
    RemoteServo servo(silent.takeChannel(), {.scene = scene, .box = {}, .told_ticks = room, .window_samples = 64});
    const std::string refusal = refusalOf([&] { servo.tellTicksTo(live); });
    EXPECT_EQ(refusal.find("it was not asked to tell its ticks") != std::string::npos, room == 0) << refusal;
  }
}

}  // namespace remote_servo_test
}  // namespace palpate
