// SPDX-License-Identifier: Apache-2.0
// The window exchange and the tool's pose between two processes: whole windows alone, also when the other process is
// killed in mid-window, and nothing that harms where the other process writes anything at all.
#include "service/memory/link_memory.hpp"

#include <cstring>
#include <functional>
#include <random>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include "base/stopwatch.hpp"
#include "other_process.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace link_memory_test {

constexpr int kSide = 8;
constexpr std::size_t kSamples = std::size_t{kSide} * kSide * kSide;

Descriptor copyOf(const LinkMemory& memory) {
  return Descriptor(fcntl(memory.descriptor(), F_DUPFD_CLOEXEC, 0));
}

// All that a window has follows from its version.
void fill(WindowExchange& exchange) {
  const auto number = static_cast<double>(exchange.nextVersion());
  SampleWindow& window = exchange.back();
  window.lattice.origin_W = Vec3(number, -number, 0.5 * number);
  window.lattice.spacing_m = Vec3::Constant(1e-3 * number);
  window.size = Vec3i::Constant(kSide);
  window.low_is_border = {true, false, exchange.nextVersion() % 2 == 0};
  window.edit_version = 3 * exchange.nextVersion();
  window.stamp_ns = static_cast<std::int64_t>(exchange.nextVersion());
  const auto value = static_cast<float>(number);
  std::fill_n(exchange.backSamples(), kSamples, Sample{value, value, value, value});
}

bool isWhole(const SampleWindow& window) {
  const auto number = static_cast<double>(window.version);
  bool whole = window.usable() && window.lattice.origin_W == Vec3(number, -number, 0.5 * number) &&
               window.lattice.spacing_m == Vec3::Constant(1e-3 * number) && window.size == Vec3i::Constant(kSide) &&
               window.low_is_border == std::array{true, false, window.version % 2 == 0} &&
               window.high_is_border == std::array{false, false, false} && window.edit_version == 3 * window.version &&
               window.stamp_ns == static_cast<std::int64_t>(window.version);
  for (std::size_t i = 0; i < kSamples; ++i) whole = whole && window.samples[i].density == static_cast<float>(number);
  return whole;
}

TEST(LinkMemory, CarriesWindowsAndPosesBetweenProcesses) {
  constexpr std::uint64_t kFirst = 1000, kWindows = 20'000;
  LinkMemory memory({.samples = kSamples});
  OtherProcess engine([&] {
    LinkMemory theirs(copyOf(memory), {.samples = kSamples});
    WindowExchange exchange(theirs.windows(), theirs.samples(), kSamples, kFirst);
    ToolPoseMailbox tool(theirs.tool());
    for (std::uint64_t n = 0; n < kWindows; ++n) {
      fill(exchange);
      exchange.publish();
    }
    while (tool.latest().tick < 7) std::this_thread::yield();
    exchange.confirm(static_cast<std::int64_t>(tool.latest().position_W.x()));
  });
  WindowExchange exchange(memory.windows(), memory.samples(), kSamples);
  ToolPoseMailbox tool(memory.tool());
  std::uint64_t last = 0, broken = 0;
  while (last < kFirst + kWindows - 1) {
    const std::int64_t confirmed = exchange.confirmedAt_ns();
    const SampleWindow& window = exchange.latest();
    if (window.version == 0) continue;
    broken +=
        isWhole(window) && window.version >= last && static_cast<std::int64_t>(window.version) >= confirmed ? 0 : 1;
    last = window.version;
  }
  EXPECT_EQ(broken, 0U);
  tool.back() = {.position_W = Vec3(123456, 0, 0), .tick = 7};
  tool.publish();
  while (exchange.confirmedAt_ns() != 123456) std::this_thread::yield();
  EXPECT_EQ(engine.end(), 0);
}

TEST(LinkMemory, CarriesAllOfAPose) {
  LinkMemory memory({.samples = kSamples});
  ToolPoseMailbox servo(memory.tool()), engine(memory.tool());
  EXPECT_EQ(engine.latest().tick, -1);
  ToolPose pose;
  pose.position_W = Vec3(1, 2, 3);
  pose.velocity_W = Vec3(4, 5, 6);
  pose.tick = 7;
  pose.time_ns = -8;
  pose.at_surface = true;
  pose.surface_W = Vec3(9, 10, 11);
  pose.normal_W = Vec3(0, 0, 1);
  pose.force_W = Vec3(12, 13, 14);
  pose.window_version = 15;
  servo.back() = pose;
  servo.publish();
  const ToolPose& seen = engine.latest();
  EXPECT_EQ(seen.position_W, pose.position_W);
  EXPECT_EQ(seen.velocity_W, pose.velocity_W);
  EXPECT_EQ(seen.tick, 7);
  EXPECT_EQ(seen.time_ns, -8);
  EXPECT_TRUE(seen.at_surface);
  EXPECT_EQ(seen.surface_W, pose.surface_W);
  EXPECT_EQ(seen.normal_W, pose.normal_W);
  EXPECT_EQ(seen.force_W, pose.force_W);
  EXPECT_EQ(seen.window_version, 15U);
}

// Each of its vectors: a pose that is no place is left out, and the one before stays.
TEST(LinkMemory, LeavesOutPosesThatAreNoPlace) {
  Vec3 ToolPose::*const parts[] = {&ToolPose::position_W, &ToolPose::velocity_W, &ToolPose::surface_W,
                                   &ToolPose::normal_W, &ToolPose::force_W};
  ToolPoseMailbox tool;
  std::int64_t tick = 0;
  for (Vec3 ToolPose::*const part : parts) {
    for (const double bad : {std::nan(""), HUGE_VAL, -1e300}) {
      tool.back() = {.position_W = Vec3(1, 2, 3), .tick = ++tick};
      tool.publish();
      EXPECT_EQ(tool.latest().tick, tick);
      tool.back() = {.tick = 1000};
      (tool.back().*part).z() = bad;
      tool.publish();
      EXPECT_EQ(tool.latest().tick, tick);
      EXPECT_EQ(tool.latest().position_W, Vec3(1, 2, 3));
    }
  }
}

// Killed at any moment, an engine leaves the last whole window, which is not confirmed any more.
TEST(LinkMemory, AKilledEngineLeavesAWholeWindow) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 60; ++trial) {
    LinkMemory memory({.samples = kSamples});
    OtherProcess engine([&] {
      WindowExchange exchange(memory.windows(), memory.samples(), kSamples);
      while (true) {
        fill(exchange);
        exchange.publish();
      }
    });
    WindowExchange exchange(memory.windows(), memory.samples(), kSamples);
    std::uint64_t last = 0;
    const auto look = [&] {
      const SampleWindow& window = exchange.latest();
      if (window.version == 0) return;
      ASSERT_TRUE(isWhole(window)) << window.version;
      ASSERT_GE(window.version, last);
      last = window.version;
    };
    const auto looks = 1 + random() % 3000;
    while (last == 0) look();
    for (std::size_t i = 0; i < looks; ++i) look();
    engine.stop();
    static_cast<void>(engine.end());
    look();
    const std::int64_t confirmed = exchange.confirmedAt_ns();
    EXPECT_LE(confirmed, static_cast<std::int64_t>(last));
    look();
    EXPECT_EQ(exchange.confirmedAt_ns(), confirmed);
  }
}

// The other process writes anything anywhere. A window is then unusable, or has a lattice and samples that are there.
TEST(LinkMemory, WhatIsNoWindowIsNotUsed) {
  LinkMemory memory({.samples = kSamples});
  OtherProcess hostile([&] {
    std::mt19937_64 random(2);
    auto* const bytes = reinterpret_cast<std::byte*>(&memory.windows());
    constexpr std::size_t kAll = sizeof(WindowBlock) + sizeof(ToolPoseBlock);
    while (true) {
      for (std::size_t i = 0; i < kAll; i += 8) {
        const std::uint64_t word = random();
        std::memcpy(bytes + i, &word, 8);
      }
      memory.windows().windows.middle.store(4 + random() % 4);
      memory.tool().middle.store(4 + random() % 4);
      // At times a window with one number that is none.
      auto& record = memory.windows().windows.slots[random() % 3].value;
      SampleWindow window;
      window.size = Vec3i::Constant(kSide);
      record = recordOf(window);
      record.size[random() % 3] = static_cast<std::int32_t>(random());
    }
  });
  WindowExchange exchange(memory.windows(), memory.samples(), kSamples);
  ToolPoseMailbox tool(memory.tool());
  std::int64_t windows = 0, bad = 0;
  // And on, while the other process has not had a core yet.
  const Stopwatch watch;
  for (int look = 0; look < 300'000 || (windows <= 100 && watch.seconds() < 60); ++look) {
    static_cast<void>(exchange.confirmedAt_ns());
    const SampleWindow& window = exchange.latest();
    if (window.version != 0) ++windows;
    if (window.usable()) {
      const bool holds = window.size.minCoeff() >= 2 && window.size.cast<double>().prod() <= double{kSamples};
      const bool lattice = window.lattice.origin_W.allFinite() && window.lattice.spacing_m.minCoeff() > 0 &&
                           std::abs(std::abs(window.lattice.R_WL.determinant()) - 1) < 0.01;
      const auto inside = [&](std::size_t slot) { return window.samples == memory.samples()[slot]; };
      if (!holds || !lattice || !(inside(0) || inside(1) || inside(2))) ++bad;
    }
    if (!tool.latest().position_W.allFinite() || !tool.latest().force_W.allFinite()) ++bad;
  }
  EXPECT_GT(windows, 100);
  EXPECT_EQ(bad, 0);
}

// One number at a time that no engine writes.
TEST(LinkMemory, EachNumberOfAWindowIsChecked) {
  SampleWindow good;
  good.size = Vec3i(8, 4, 2);
  good.version = 5;
  const Sample samples[64] = {};
  ASSERT_TRUE(windowOf(recordOf(good), samples, 64).usable());
  const auto refused = [&](const std::function<void(WindowRecord&)>& spoil, std::size_t capacity = 64) {
    WindowRecord record = recordOf(good);
    spoil(record);
    const SampleWindow window = windowOf(record, samples, capacity);
    EXPECT_FALSE(window.usable());
    EXPECT_EQ(window.version, 5U);
  };
  refused([](WindowRecord&) {}, 63);
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t size : {1, 0, -1, -8, 9, 1 << 30, INT32_MIN, INT32_MAX})
      refused([&](WindowRecord& r) { r.size[axis] = size; });
    for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      refused([&](WindowRecord& r) { r.origin_W[axis] = none; });
      refused([&](WindowRecord& r) { r.spacing_m[axis] = none; });
      refused([&](WindowRecord& r) { r.axes_WL[4 * axis] = none; });
    }
    refused([&](WindowRecord& r) { r.spacing_m[axis] = 0; });
    refused([&](WindowRecord& r) { r.spacing_m[axis] = -1e-3; });
    refused([&](WindowRecord& r) { r.axes_WL[4 * axis] = 1.01; });
  }
  for (const double spacing : {1e-13, 1e5}) {
    refused([&](WindowRecord& r) { r.spacing_m[0] = r.spacing_m[1] = r.spacing_m[2] = spacing; });
  }
  // So far away that the tolerance at a window's faces would be voxels.
  refused([](WindowRecord& r) {
    r.origin_W[1] = -1e10;
    r.spacing_m[0] = r.spacing_m[1] = r.spacing_m[2] = 1e-6;
  });
  refused([](WindowRecord& r) { r.size[0] = r.size[1] = r.size[2] = 1 << 22; });  // 2^66 samples
}

TEST(LinkMemory, EachSideKnowsWhatItMaps) {
  const LinkMemory memory({.samples = kSamples});
  EXPECT_THAT(refusalOf([&] { LinkMemory none(copyOf(memory), {.samples = kSamples + 512}); }),
              testing::HasSubstr("same version"));
  for (const std::size_t bad : {std::size_t{0}, std::size_t{7}, LinkMemory::kMostWindowSamples + 1, SIZE_MAX}) {
    EXPECT_THAT(refusalOf([&] { LinkMemory none({.samples = bad}); }), testing::HasSubstr("they have 8 to"));
    EXPECT_THAT(refusalOf([&] { LinkMemory none(copyOf(memory), {.samples = bad}); }),
                testing::HasSubstr("they have 8 to"));
  }
  EXPECT_NO_THROW(static_cast<void>(LinkMemory({.samples = 8, .ticks = 0})));
  EXPECT_NO_THROW(
      static_cast<void>(LinkMemory({.samples = LinkMemory::kMostWindowSamples, .ticks = LinkMemory::kMostTicks})));
  for (const std::size_t bad : {LinkMemory::kMostTicks + 1, SIZE_MAX}) {
    EXPECT_THAT(refusalOf([&] { LinkMemory none({.samples = 8, .ticks = bad}); }), testing::HasSubstr("no room for"));
    EXPECT_THAT(refusalOf([&] { LinkMemory none(copyOf(memory), {.samples = kSamples, .ticks = bad}); }),
                testing::HasSubstr("no room for"));
  }
  EXPECT_THAT(refusalOf([&] { LinkMemory none(copyOf(memory), {.samples = kSamples, .ticks = 64}); }),
              testing::HasSubstr("same version"));
  // Of another layout: each byte of the header counts.
  for (std::size_t i = 0; i < sizeof(LinkHeader); ++i) {
    LinkMemory other({.samples = kSamples});
    auto* const header = reinterpret_cast<std::byte*>(&other.windows()) - 64;
    header[i] ^= std::byte{1};
    EXPECT_THAT(refusalOf([&] { LinkMemory none(copyOf(other), {.samples = kSamples}); }), testing::HasSubstr("layout"))
        << i;
  }
}

// Ticks go the one way and a pointer's aims the other, between two processes.
TEST(LinkMemory, CarriesTicksAndAimsBetweenProcesses) {
  constexpr std::int64_t kTicks = 50'000;
  const LinkMemory::Room room{.samples = kSamples, .ticks = 128};
  LinkMemory memory(room);
  OtherProcess servo([&] {
    LinkMemory theirs(copyOf(memory), room);
    LiveTicks ticks(theirs.ticks(), theirs.tickRing(), theirs.tickCapacity());
    PointerPath path(Vec3(0, 0, 0));
    path.follow(theirs.aims());
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      const auto number = static_cast<double>(tick);
      ticks.add({.tick = tick, .time_s = number, .force_W = {number, -number, 2 * number}});
      if (tick % 64 == 0) std::this_thread::yield();
    }
    for (double time_s = 1; path.position(time_s).x() < 2.999; time_s += 0.001) std::this_thread::yield();
  });
  LiveTicks ticks(memory.ticks(), memory.tickRing(), memory.tickCapacity());
  PointerAim pointer(memory.aims());
  std::vector<TickRecord> taken;
  std::int64_t last = -1, broken = 0;
  for (bool all_are_told = false; !all_are_told;) {
    all_are_told = ticks.latest().tick == kTicks - 1;  // first: they are taken once more then
    taken.clear();
    ticks.take(taken);
    for (const TickRecord& record : taken) {
      const auto number = static_cast<double>(record.tick);
      broken += record.tick > last && record.time_s == number && record.force_W[2] == 2 * number ? 0 : 1;
      last = record.tick;
    }
  }
  EXPECT_EQ(broken, 0);
  EXPECT_GT(last, 0);
  pointer.aim(Vec3(3, 0, 0));
  EXPECT_EQ(servo.end(), 0);
}

// Whatever the other side counts, no more is taken than there can be, and nothing beyond the ring is read.
TEST(LinkMemory, CountsOfTicksAreNotBelieved) {
  LinkMemory memory({.samples = kSamples, .ticks = 16});
  LiveTicks servo(memory.ticks(), memory.tickRing(), 16), window(memory.ticks(), memory.tickRing(), 16);
  std::vector<TickRecord> taken;
  for (const std::uint64_t lie : {std::uint64_t{17}, ~std::uint64_t{0}, std::uint64_t{1} << 63U}) {
    memory.ticks().added = lie;
    window.take(taken);
    EXPECT_LE(taken.size(), 16U) << lie;
    taken.clear();
  }
  for (const std::uint64_t lie : {std::uint64_t{5}, ~std::uint64_t{0}}) {
    memory.ticks().taken = lie;
    for (std::int64_t tick = 0; tick < 100; ++tick) servo.add({.tick = tick});
  }
  EXPECT_EQ(window.latest().tick, 99);
}

TEST(LinkMemory, EachWindowBeginsAtAPage) {
  for (const std::size_t samples : {std::size_t{8}, std::size_t{257}, std::size_t{32768}}) {
    LinkMemory memory({.samples = samples});
    const auto places = memory.samples();
    EXPECT_GE(memory.windowBytes(), samples * sizeof(Sample));
    for (std::size_t slot = 0; slot < 3; ++slot) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(places[slot]) % LinkMemory::kPage, 0U);
      EXPECT_EQ(places[slot], places[0] + slot * (memory.windowBytes() / sizeof(Sample)));
      places[slot][samples - 1].density = 1;  // is there
    }
  }
}

}  // namespace link_memory_test
}  // namespace palpate
