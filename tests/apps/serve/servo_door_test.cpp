// SPDX-License-Identifier: Apache-2.0
// A service's servos come one at a time, whatever the one before did.
#include "apps/serve/servo_door.hpp"

#include <chrono>
#include <mutex>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/servo_side/wire_settings.hpp"
#include "service/messages/message.hpp"
#include "tests/servo/support/still_device.hpp"

namespace palpate {
namespace servo_door_test {

using testing::ElementsAre;
using testing::HasSubstr;

class Door : public testing::Test {
 protected:
  ~Door() override { door_.close(); }
  [[nodiscard]] static wire::HelloT hello(const std::string& commit = "this") {
    wire::HelloT words;
    words.layout = kLinkLayout;
    words.commit = commit;
    return words;
  }
  [[nodiscard]] std::vector<std::string> told() {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  // One who connects; keeps the other end.
  [[nodiscard]] bool comes(const wire::HelloT& words) {
    auto [ours, theirs] = channelPair();
    servo_ = std::move(theirs);
    return door_.letIn(std::move(ours), words);
  }
  void makesItsDevice() {
    Packet packet;
    ASSERT_EQ(servo_.receive(packet, 5000), Channel::Got::kPacket);  // it is asked for one
    ASSERT_TRUE(servo_.send(encoded(wireOf(StillDevice())), 0));
  }
  [[nodiscard]] std::unique_ptr<RemoteServo> waitForNext() {
    for (int i = 0; i < 5000; ++i) {
      if (std::unique_ptr<RemoteServo> next = door_.takeNext()) return next;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return nullptr;
  }

  Scene scene_;
  Channel servo_;
  std::mutex mutex_;  // guards the next
  std::vector<std::string> told_;
  ServoDoor door_{{.scene = scene_, .box = {}, .way = nullptr, .told_ticks = 0, .window_samples = 64, .commit = "this"},
                  [this](const std::string& words) {
                    const std::lock_guard lock(mutex_);
                    told_.push_back(words);
                  }};
};

TEST_F(Door, OneAtATime) {
  EXPECT_EQ(door_.takeNext(), nullptr);
  EXPECT_FALSE(door_.isServo(getpid()));
  ASSERT_TRUE(comes(hello()));
  Channel first = std::move(servo_);
  EXPECT_FALSE(comes(hello())) << "while one makes its device";
  servo_ = std::move(first);
  makesItsDevice();
  const std::unique_ptr<RemoteServo> servo = waitForNext();
  ASSERT_NE(servo, nullptr);
  EXPECT_EQ(servo->device().name(), StillDevice().name());
  EXPECT_TRUE(door_.isServo(getpid()));
  EXPECT_EQ(servo->process(), getpid());
  EXPECT_EQ(door_.takeNext(), nullptr);
  first = std::move(servo_);
  EXPECT_FALSE(comes(hello())) << "while one is there";
  door_.hasLeft();
  EXPECT_TRUE(comes(hello()));
  makesItsDevice();
  EXPECT_NE(waitForNext(), nullptr);
  EXPECT_THAT(told(), testing::IsEmpty());
}

// It may come again and again, once a second say.
TEST_F(Door, ATroubleIsToldOnceAndKeepsNobodyOut) {
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(comes(hello("another"))) << i;
    door_.close();
    Packet packet;
    ASSERT_EQ(servo_.receive(packet, 0), Channel::Got::kPacket) << "it is told, too, and does not come again at once";
    wire::BodyUnion body = decoded(packet.bytes, "the engine");
    const auto* const refusal = contentOf<wire::RefusalT>(body);
    ASSERT_NE(refusal, nullptr);
    EXPECT_EQ(refusal->reason, "it was built from another, this program from this");
  }
  EXPECT_THAT(told(), ElementsAre(HasSubstr("it was built from another, this program from this")));
  ASSERT_TRUE(comes(hello()));
  servo_.close();  // before it has made its device
  door_.close();
  EXPECT_THAT(told(), ElementsAre(HasSubstr("built from"), HasSubstr("its process has ended")));
  EXPECT_EQ(door_.takeNext(), nullptr);
  door_.noTrouble();
  ASSERT_TRUE(comes(hello()));
  servo_.close();
  door_.close();
  EXPECT_EQ(told().size(), 3U) << "since it went well meanwhile";
}

}  // namespace servo_door_test
}  // namespace palpate
