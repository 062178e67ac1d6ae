// SPDX-License-Identifier: Apache-2.0
// Which write a report answers, and how old what it tells may be, with an answer that comes too late.
#include "servo/devices/report_link.hpp"

#include <chrono>
#include <deque>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/monotonic_clock.hpp"

namespace palpate {
namespace report_link_test {

// Answers each write with its number, a millisecond after the one before; the first one comes after the second write.
class LateDevice final : public ReportPort {
 public:
  PortRead read(Report& report, int timeout_ms) noexcept override {
    if (answers_.empty()) return PortRead::kNothing;
    const std::int64_t early_ns = answers_.front().first - monotonicNow_ns();
    if (early_ns > timeout_ms * 1'000'000LL) return PortRead::kNothing;
    if (early_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(early_ns));
    report = Report{};
    report.size = 1;
    report.bytes[0] = answers_.front().second;
    answers_.pop_front();
    return PortRead::kReport;
  }
  bool write(const Report&) noexcept override {
    written_ns.push_back(monotonicNow_ns());
    const auto number = static_cast<std::uint8_t>(written_ns.size());
    if (number == 1) return true;
    std::int64_t at_ns = monotonicNow_ns();
    if (number == 2) answers_.emplace_back(at_ns, std::uint8_t{1});
    answers_.emplace_back(at_ns + 1'000'000, number);
    return true;
  }
  std::vector<std::int64_t> written_ns;

 private:
  std::deque<std::pair<std::int64_t, std::uint8_t>> answers_;
};

TEST(ReportLink, KnowsWhichWriteALateAnswerBelongsTo) {
  auto port = std::make_unique<LateDevice>();
  LateDevice& device = *port;
  Report ask;
  ask.size = 1;
  ReportLink link([&] { return std::move(port); }, {.rest = ask, .answer_ms = 20});
  EXPECT_FALSE(link.exchange());
  EXPECT_EQ(link.figures().lost, 1U);
  for (std::uint8_t number = 2; number < 6; ++number) {
    EXPECT_TRUE(link.exchange());
    const Received& newest = link.newest();
    EXPECT_EQ(newest.report.bytes[0], number);
    EXPECT_LE(newest.asked_ns, device.written_ns[number - 1U]);
    EXPECT_TRUE(number == 2 || newest.asked_ns > device.written_ns[number - 2U]);
    // The device was waited for in the first exchange alone.
    EXPECT_GE(newest.silent_ns, 19'000'000);
    EXPECT_LE(newest.silent_ns, 20'000'000);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // no fault of the device's
  }
  EXPECT_EQ(link.figures().superseded, 1U);
  EXPECT_EQ(link.figures().received, 4U);
}

TEST(ReportLink, CountsARequestWithTheReportAfterItsAnswer) {
  auto port = std::make_unique<LateDevice>();
  Report ask;
  ask.size = 1;
  ReportLink link([&] { return std::move(port); }, {.rest = ask, .answer_ms = 5});
  static_cast<void>(link.exchange());
  EXPECT_TRUE(link.exchange());
  link.askOnce(ask);
  EXPECT_TRUE(link.exchange());
  EXPECT_EQ(link.newest().requests, 0U);
  EXPECT_TRUE(link.exchange());
  EXPECT_EQ(link.newest().requests, 1U);
}

}  // namespace report_link_test
}  // namespace palpate
