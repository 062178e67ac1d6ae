// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/attachments.hpp"

#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/servo/support/seeded.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace attachments_test {

Descriptor sent(const SealedMemory& memory) {
  return Descriptor(fcntl(memory.descriptor(), F_DUPFD_CLOEXEC, 0));
}

TEST(Attachments, AWayIsTheSameToTheBit) {
  Seeded random(1);
  for (const int points : {1, 2, 50}) {
    for (const auto how : {SampledPath::Interpolation::kLinear, SampledPath::Interpolation::kCubic}) {
      std::vector<double> times;
      std::vector<Vec3> places;
      for (int i = 0; i < points; ++i) {
        times.push_back(0.3 + 0.1 * i);
        places.push_back(random.inCube(1));
      }
      const SampledPath way(times, places, how);
      const SampledPath back = wayOf(sent(wayMemory(way)), static_cast<std::uint64_t>(points),
                                     way.interpolation() == SampledPath::Interpolation::kLinear);
      EXPECT_EQ(back.duration_s(), way.duration_s());
      for (double t = -0.1; t < 6; t += 0.013) ASSERT_EQ(back.position(t), way.position(t)) << points << " " << t;
    }
  }
}

TEST(Attachments, AMeshIsTheSame) {
  Seeded random(2);
  TriangleMesh mesh;
  for (int i = 0; i < 30; ++i) mesh.vertices_W.push_back(random.inCube(1));
  for (std::uint32_t i = 0; i < 28; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  const TriangleMesh back = meshOf(sent(meshMemory(mesh)), 30, 28);
  EXPECT_EQ(back.vertices_W, mesh.vertices_W);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST(Attachments, RecordsAreTheSame) {
  RunRecords records;
  for (int i = 0; i < 100; ++i) records.ticks.push_back({.tick = i, .time_s = 0.1 * i, .depth_m = 1e-3 * i});
  records.recording = "any bytes";
  const RunRecords back = recordsOf(sent(recordsMemory(records)), 100, 9);
  ASSERT_EQ(back.ticks.size(), 100U);
  EXPECT_EQ(back.ticks[99].depth_m, 0.099);
  EXPECT_EQ(back.recording, "any bytes");
  EXPECT_TRUE(recordsOf(sent(recordsMemory({})), 0, 0).ticks.empty());
}

// A flag is true or false whatever byte came for it.
TEST(Attachments, FlagsAreFlags) {
  const RunRecords records{.ticks = std::vector<TickRecord>(2), .recording = ""};
  const SealedMemory memory = recordsMemory(records);
  memory.data()[offsetof(TickRecord, in_contact)] = std::byte{0x40};
  memory.data()[sizeof(TickRecord) + offsetof(TickRecord, damped)] = std::byte{0xff};
  const RunRecords back = recordsOf(sent(memory), 2, 0);
  std::byte flag{};
  std::memcpy(&flag, &back.ticks[0].in_contact, 1);
  EXPECT_EQ(flag, std::byte{1});
  std::memcpy(&flag, &back.ticks[1].damped, 1);
  EXPECT_EQ(flag, std::byte{1});
  EXPECT_FALSE(back.ticks[0].damped);
  EXPECT_FALSE(back.ticks[1].in_contact);
}

// Of a tick that is told while the servo runs: numbers that no servo has are found, one by one, and flags are mended.
TEST(Attachments, TicksAreThoseOfAServo) {
  const auto sound = [](const std::function<void(TickRecord&)>& change) {
    TickRecord record{.tick = 3, .time_s = 0.1, .density = std::numeric_limits<float>::quiet_NaN()};
    change(record);
    return makeSound(record);
  };
  EXPECT_TRUE(sound([](TickRecord&) {}));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kMuch = 1e300;
  EXPECT_FALSE(sound([](TickRecord& r) { r.hip_W[0] = kNone; }));
  EXPECT_FALSE(sound([](TickRecord& r) { r.vhip_W[1] = kMuch; }));
  EXPECT_FALSE(sound([](TickRecord& r) { r.normal_W[2] = kNone; }));
  EXPECT_FALSE(sound([](TickRecord& r) { r.force_W[2] = -kMuch; }));
  EXPECT_FALSE(sound([](TickRecord& r) { r.time_s = kNone; }));
  EXPECT_FALSE(sound([](TickRecord& r) { r.depth_m = kNone; }));
  EXPECT_FALSE(sound([](TickRecord& r) { r.energy_J = kNone; }));
  EXPECT_TRUE(sound([](TickRecord& r) {
    const std::byte seven{7};
    std::memcpy(&r.in_contact, &seven, 1);
  }));
  TickRecord record;
  const std::byte seven{7};
  std::memcpy(&record.damped, &seven, 1);
  static_cast<void>(makeSound(record));
  std::byte flag{};
  std::memcpy(&flag, &record.damped, 1);
  EXPECT_EQ(flag, std::byte{1});
}

// Counts that another side may say.
TEST(Attachments, CountsThatDoNotFitAreRefused) {
  const RunRecords records{.ticks = std::vector<TickRecord>(3), .recording = ""};
  const SealedMemory memory = recordsMemory(records);
  for (const std::uint64_t ticks : {std::uint64_t{2}, std::uint64_t{4}, std::uint64_t{1} << 33U, UINT64_MAX})
    EXPECT_NE(refusalOf([&] { static_cast<void>(recordsOf(sent(memory), ticks, 0)); }), kNoRefusal) << ticks;
  EXPECT_NE(refusalOf([&] { static_cast<void>(recordsOf(Descriptor(), 3, 0)); }), kNoRefusal);
  EXPECT_NE(refusalOf([&] { static_cast<void>(wayOf(sent(memory), UINT64_MAX, true)); }), kNoRefusal);
  EXPECT_NE(refusalOf([&] { static_cast<void>(meshOf(sent(memory), UINT64_MAX, 1)); }), kNoRefusal);
}

}  // namespace attachments_test
}  // namespace palpate
