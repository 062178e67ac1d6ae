// SPDX-License-Identifier: Apache-2.0
// The bytes, as the firmware has them: against blocks that were written by hand, and back and forth for any content.
#include "servo/devices/polhem_report.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace polhem_report_test {

using Bytes = std::vector<std::uint8_t>;

Bytes bytesOf(const Report& report) {
  return {report.bytes.begin(), report.bytes.begin() + static_cast<std::ptrdiff_t>(report.size)};
}

// Encoders 1, -2, 300, -5000, 0x7FFF, -32768; no calibration asked for.
const Bytes kState = {0x01, 0x00, 0xFE, 0xFF, 0x2C, 0x01, 0x78, 0xEC, 0xFF, 0x7F, 0x00, 0x80, 0x00, 0x00};

TEST(PolhemReport, ReadsWhatTheFirmwareSends) {
  const auto state = parsePolhem(kState, 14);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->counts, (PolhemCounts{1, -2, 300, -5000, 32767, -32768}));
  EXPECT_FALSE(state->asks_for_calibration);
  EXPECT_FALSE(state->pressed);
  Bytes padded = kState;
  padded.resize(64, 0xAB);
  EXPECT_EQ(parsePolhem(padded, 64), state);
  Bytes asking = kState;
  asking[12] = 1;
  EXPECT_TRUE(parsePolhem(asking, 14)->asks_for_calibration);
}

// The handle's switch adds 10000 to encoder d.
TEST(PolhemReport, TellsTheSwitchFromTheFourthEncoder) {
  for (const int d : {-4999, -1, 0, 4999}) {
    for (const bool pressed : {false, true}) {
      PolhemState state;
      state.counts[3] = static_cast<std::int16_t>(d);
      state.pressed = pressed;
      const auto read = parsePolhem(polhemStateReport(state, 14).content(), 14);
      ASSERT_TRUE(read);
      EXPECT_EQ(*read, state) << d;
    }
  }
}

TEST(PolhemReport, WritesWhatTheFirmwareReads) {
  EXPECT_EQ(bytesOf(polhemReport({.currents_mA = {1, -2, 3000}}, 14)),
            (Bytes{0, 0x01, 0x00, 0xFE, 0xFF, 0xB8, 0x0B, 0, 0, 0, 0, 0, 0, 0, 0}));
  // Command 1: a to c in the last three places, d to f in those of the currents.
  EXPECT_EQ(bytesOf(polhemReport({.count_from = PolhemCounts{1, 2, 3, 4, 5, 6}}, 14)),
            (Bytes{0, 4, 0, 5, 0, 6, 0, 1, 0, 1, 0, 2, 0, 3, 0}));
  const Bytes padded = bytesOf(polhemReport({.currents_mA = {1, -2, 3000}}, 64));
  EXPECT_EQ(padded.size(), 65U);
  EXPECT_EQ(padded[6], 0x0B);
  EXPECT_EQ(Bytes(padded.begin() + 7, padded.end()), Bytes(58, 0));
}

TEST(PolhemReport, IsTheSameThereAndBack) {
  std::mt19937 bits(1);
  const auto any = [&] { return static_cast<std::int16_t>(bits()); };
  for (int i = 0; i < 2000; ++i) {
    const std::size_t size = i % 2 == 0 ? 14 : 64;
    PolhemCommand command{.currents_mA = {any(), any(), any()}};
    if (i % 3 == 0) command = {.count_from = PolhemCounts{any(), any(), any(), any(), any(), any()}};
    const Report report = polhemReport(command, size);
    EXPECT_EQ(parsePolhemCommand(report.content().subspan(1), size), command);
  }
}

TEST(PolhemReport, RefusesWhatIsNone) {
  for (std::size_t length = 0; length <= 64; ++length) {
    const Bytes zeros(length, 0);
    EXPECT_EQ(parsePolhem(zeros, 14).has_value(), length == 14) << length;
    EXPECT_EQ(parsePolhem(zeros, 64).has_value(), length == 64) << length;
    EXPECT_EQ(parsePolhemCommand(zeros, 14).has_value(), length == 14) << length;
  }
  EXPECT_FALSE(parsePolhem(Bytes(10, 0), 10));  // shorter than any layout
  Bytes info = kState;
  for (const int low : {2, 0x80, 0xFF}) {
    info[12] = static_cast<std::uint8_t>(low);
    EXPECT_FALSE(parsePolhem(info, 14)) << low;
  }
  info[12] = 1;
  info[13] = 1;
  EXPECT_FALSE(parsePolhem(info, 14));
  Bytes command(14, 0);
  command[6] = 2;
  EXPECT_FALSE(parsePolhemCommand(command, 14));
}

}  // namespace polhem_report_test
}  // namespace palpate
