// SPDX-License-Identifier: Apache-2.0
// Reports of both layouts as bytes, and the motion that they make.
#include <atomic>
#include <cmath>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "servo/devices/space_mouse_device.hpp"
#include "servo/devices/space_mouse_report.hpp"

namespace palpate {
namespace space_mouse_test {

using Bytes = std::vector<std::uint8_t>;

TEST(SpaceMouseReport, ReadsBothLayouts) {
  // 350, -350 and 1; then the turn in the same report, or in one of its own.
  const Bytes push = {1, 0x5E, 0x01, 0xA2, 0xFE, 0x01, 0x00};
  EXPECT_EQ(parseSpaceMouse(push)->push, (std::array<std::int16_t, 3>{350, -350, 1}));
  EXPECT_FALSE(parseSpaceMouse(push)->turn);
  const Bytes turn = {2, 0x02, 0x00, 0x03, 0x00, 0xFC, 0xFF};
  EXPECT_EQ(parseSpaceMouse(turn)->turn, (std::array<std::int16_t, 3>{2, 3, -4}));
  EXPECT_FALSE(parseSpaceMouse(turn)->push);
  Bytes both = push;
  both.insert(both.end(), turn.begin() + 1, turn.end());
  EXPECT_EQ(parseSpaceMouse(both)->push, parseSpaceMouse(push)->push);
  EXPECT_EQ(parseSpaceMouse(both)->turn, parseSpaceMouse(turn)->turn);
  EXPECT_EQ(parseSpaceMouse(Bytes{3, 0x05, 0x01})->buttons, 0x0105U);
  EXPECT_EQ(parseSpaceMouse(Bytes{3, 1, 2, 3, 4, 9, 9})->buttons, 0x04030201U);
}

TEST(SpaceMouseReport, RefusesWhatIsNone) {
  EXPECT_FALSE(parseSpaceMouse(Bytes{}));
  for (std::size_t length = 1; length <= 64; ++length) {
    for (const unsigned number : {0U, 1U, 2U, 3U, 4U, 23U}) {
      Bytes report(length, 0);
      report[0] = static_cast<std::uint8_t>(number);
      const bool is_one = (number == 1 && (length == 7 || length == 13)) || (number == 2 && length == 7) ||
                          (number == 3 && length >= 2 && length <= 13);
      EXPECT_EQ(parseSpaceMouse(report).has_value(), is_one) << number << ", " << length;
    }
  }
}

// Reports that a test hands out; a read waits for one as a real one does.
class Mouse {
 public:
  void send(const Bytes& bytes) {
    const std::lock_guard lock(mutex_);
    Report report;
    std::copy(bytes.begin(), bytes.end(), report.bytes.begin());
    report.size = bytes.size();
    waiting_.push_back(report);
  }
  void push(int x, int y, int z) {
    const auto low = [](int v) { return static_cast<std::uint8_t>(v & 0xFF); };
    const auto high = [](int v) { return static_cast<std::uint8_t>(v >> 8 & 0xFF); };
    send({1, low(x), high(x), low(y), high(y), low(z), high(z)});
  }
  PortOpener opener() {
    return [this] { return std::make_unique<Port>(*this); };
  }
  std::atomic<bool> unplugged{false};

 private:
  class Port final : public ReportPort {
   public:
    explicit Port(Mouse& mouse) : mouse_(mouse) {}
    PortRead read(Report& report, int timeout_ms) noexcept override {
      if (mouse_.unplugged) return PortRead::kGone;
      {
        const std::lock_guard lock(mouse_.mutex_);
        if (!mouse_.waiting_.empty()) {
          report = mouse_.waiting_.front();
          mouse_.waiting_.pop_front();
          return PortRead::kReport;
        }
      }
      if (timeout_ms > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return PortRead::kNothing;
    }
    bool write(const Report&) noexcept override { return false; }

   private:
    Mouse& mouse_;
  };

  std::mutex mutex_;
  std::deque<Report> waiting_;
};

double figure(const Device& device, std::string_view key) {
  for (const DeviceFigure& f : device.figures()) {
    if (f.key == key) return f.value;
  }
  return -1;
}

void awaitReports(const SpaceMouseDevice& device, double count) {
  for (int i = 0; i < 5000 && figure(device, "reports_received") + figure(device, "reports_superseded") +
                                      figure(device, "reports_garbled") <
                                  count;
       ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

class SpaceMouseMotion : public testing::Test {
 protected:
  Vec3 read() {
    Vec3 p;
    EXPECT_TRUE(device_.read(p));
    return p;
  }
  // By the simulated clock.
  Vec3 after(double time_s) {
    for (int i = 0; i < static_cast<int>(std::lround(1000 * time_s)); ++i) {
      device_.elapse(1);
      last_ = read();
    }
    return last_;
  }

  Mouse mouse_;
  SpaceMouseParameters p_ = {.silence_s = 1};
  SpaceMouseDevice device_{p_, {.simulated_clock = true}, mouse_.opener()};
  Vec3 last_ = Vec3::Zero();
};

// Pushed fully for t: u (t - s (1 - e^(-t/s))) of way, as the velocity has to rise first.
TEST_F(SpaceMouseMotion, GoesAsFastAsItIsPushed) {
  mouse_.push(350, 0, 0);
  awaitReports(device_, 1);
  static_cast<void>(read());
  const double t = 0.5, s = p_.smooth_s;
  const Vec3 there = after(t);
  EXPECT_NEAR(there.x(), 0.1 * (t - s * (1 - std::exp(-t / s))), 1e-9);
  EXPECT_EQ(there.y(), 0);
  EXPECT_EQ(there.z(), 0);
}

// Its own y points to the user and its z down.
TEST_F(SpaceMouseMotion, TurnsItsAxes) {
  mouse_.push(0, 350, -350);
  awaitReports(device_, 1);
  static_cast<void>(read());
  const Vec3 there = after(0.2);
  EXPECT_GT(there.z(), 0.01);
  EXPECT_GT(there.y(), 0.01);
  EXPECT_EQ(there.x(), 0);
}

// No step of velocity: from tick to tick it changes by at most u T / s.
TEST_F(SpaceMouseMotion, IsSmoothBetweenReports) {
  Vec3 before = read(), way_before = Vec3::Zero();
  for (int i = 0; i < 300; ++i) {
    if (i % 100 == 0) {
      mouse_.push(i % 200 == 0 ? 350 : -350, 0, 0);
      awaitReports(device_, 1 + i / 100);
      static_cast<void>(read());
    }
    device_.elapse(1);
    const Vec3 now = read(), way = now - before;
    EXPECT_LE((way - way_before).norm(), 2 * 0.1 * 1e-3 * 1e-3 / p_.smooth_s * 1.0001);
    before = now;
    way_before = way;
  }
}

TEST_F(SpaceMouseMotion, RestsInItsDeadZoneAndStopsWithoutReports) {
  mouse_.push(10, -10, 5);  // 3 % of 350
  awaitReports(device_, 1);
  EXPECT_EQ(after(0.2), Vec3(Vec3::Zero()));
  mouse_.push(350, 0, 0);
  awaitReports(device_, 2);
  const double soon = after(0.9).x(), end = after(0.5).x();
  EXPECT_NEAR(soon, 0.1 * (0.9 - p_.smooth_s), 1e-4);
  EXPECT_NEAR(end, 0.1 * 1.0, 2e-4);  // for one second, and what the smoothing gives back at the end
  EXPECT_NEAR(after(0.5).x(), end, 1e-6);
}

TEST_F(SpaceMouseMotion, StaysInItsWorkspace) {
  mouse_.push(350, 350, 350);
  awaitReports(device_, 1);
  static_cast<void>(read());
  for (int i = 0; i < 40; ++i) {
    EXPECT_LE(after(0.1).norm(), p_.workspace_radius_m * (1 + 1e-12));
    mouse_.push(350, 350, 350);
    awaitReports(device_, 2 + i);
  }
  EXPECT_NEAR(last_.norm(), p_.workspace_radius_m, 1e-9);
}

// Push and turn come in reports of their own: the newest of each counts.
TEST_F(SpaceMouseMotion, KeepsThePushBesideATurn) {
  mouse_.push(350, 0, 0);
  mouse_.send({2, 9, 0, 9, 0, 9, 0});
  mouse_.send({3, 0x02, 0x00});
  awaitReports(device_, 3);
  static_cast<void>(read());
  EXPECT_GT(after(0.1).x(), 5e-3);
  EXPECT_EQ(device_.buttons(), 2U);
}

TEST_F(SpaceMouseMotion, CountsGarbageAndTellsThatItIsUnplugged) {
  mouse_.send({9, 9, 9});
  mouse_.send({1, 2, 3});
  awaitReports(device_, 2);
  EXPECT_EQ(figure(device_, "reports_garbled"), 2);
  EXPECT_EQ(after(0.1), Vec3(Vec3::Zero()));
  EXPECT_EQ(device_.forceOff(), ForceOff::kInputOnly);
  mouse_.unplugged = true;
  for (int i = 0; i < 2000 && device_.forceOff() != ForceOff::kDisconnected; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(device_.forceOff(), ForceOff::kDisconnected);
  EXPECT_FALSE(device_.limits().follows_force);
}

}  // namespace space_mouse_test
}  // namespace palpate
