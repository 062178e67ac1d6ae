// SPDX-License-Identifier: Apache-2.0
// Pictures between two processes: whole ones alone, and nothing that harms where the other side writes anything at all.
#include "service/memory/view_memory.hpp"

#include <cmath>
#include <cstring>
#include <random>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "other_process.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace view_memory_test {

constexpr ViewMemory::Room kRoom{.pixels = 64 * 48, .ticks = 32};

Descriptor copyOf(const ViewMemory& memory) {
  return Descriptor(fcntl(memory.descriptor(), F_DUPFD_CLOEXEC, 0));
}

// All that a picture has follows from its number.
Camera cameraOf(std::uint64_t number) {
  const auto n = static_cast<double>(number);
  Camera camera;
  camera.position_W = Vec3(n, -n, 2 * n);
  camera.forward_W = Vec3(1, n, 0);
  camera.right_W = Vec3(0, 1, n);
  camera.up_W = Vec3(n, 0, 1);
  camera.vertical_fov_rad = 0.1 + 1e-6 * n;
  camera.width = 1 + static_cast<int>(number % 64);
  camera.height = 1 + static_cast<int>(number % 48);
  return camera;
}

void putNumber(ViewMemory& memory, std::uint64_t number) {
  const Camera camera = cameraOf(number);
  const std::vector<layout::PicturePixel> pixels(static_cast<std::size_t>(camera.width * camera.height),
                                                 {static_cast<layout::uint>(number), static_cast<float>(number)});
  ASSERT_TRUE(memory.put(camera, pixels, 3 * number, number % 2 == 0, number % 3 == 0));
}

bool isWhole(const ViewFrame& picture) {
  const std::uint64_t n = picture.number;
  bool whole = picture.camera == cameraOf(n) && picture.edit_version == 3 * n && picture.fine == (n % 2 == 0) &&
               picture.whole == (n % 3 == 0) &&
               picture.pixels.size() == static_cast<std::size_t>(picture.camera.width * picture.camera.height);
  for (const layout::PicturePixel& pixel : picture.pixels)
    whole = whole && pixel.rgba == n && pixel.distance_m == static_cast<float>(n);
  return whole;
}

TEST(ViewMemory, CarriesPicturesBetweenProcesses) {
  constexpr std::uint64_t kPictures = 20'000;
  ViewMemory memory(kRoom);
  OtherProcess client([&] {
    ViewMemory theirs(copyOf(memory), kRoom);
    std::uint64_t last = 0;
    while (last < kPictures) {
      const ViewFrame& picture = theirs.latest();
      if (picture.number == last) continue;
      if (picture.number < last || !isWhole(picture)) _exit(1);
      last = picture.number;
    }
  });
  EXPECT_EQ(memory.latest().number, 0U);
  for (std::uint64_t number = 1; number <= kPictures; ++number) {
    putNumber(memory, number);
    if (number % 16 == 0) std::this_thread::yield();
  }
  EXPECT_EQ(client.end(), 0);
}

TEST(ViewMemory, TakesNoPictureThatDoesNotFit) {
  ViewMemory memory(kRoom);
  const ViewMemory end(copyOf(memory), kRoom);
  Camera camera = cameraOf(7);
  std::vector<layout::PicturePixel> pixels(kRoom.pixels + 1);
  camera.width = static_cast<int>(pixels.size());
  camera.height = 1;
  EXPECT_FALSE(memory.put(camera, pixels, 0, true, true));
  --camera.width;
  EXPECT_FALSE(memory.put(camera, pixels, 0, true, true));  // not its camera's
  pixels.pop_back();
  EXPECT_TRUE(memory.put(camera, pixels, 0, true, true));
  camera.width = 0;
  EXPECT_FALSE(memory.put(camera, {}, 0, true, true));
  camera.width = camera.height = -1;
  EXPECT_FALSE(memory.put(camera, std::span(pixels).first(1), 0, true, true));
}

// What is no picture is left out, and the one before stays.
TEST(ViewMemory, EachNumberOfAPictureIsChecked) {
  const auto left = [](const std::function<void(PictureRecord&)>& change) {
    ViewMemory memory(kRoom), client(copyOf(memory), kRoom);
    putNumber(memory, 1);
    EXPECT_TRUE(isWhole(client.latest()));
    putNumber(memory, 2);
    auto* const block = reinterpret_cast<ViewBlock*>(reinterpret_cast<std::byte*>(&memory.aims()) - 640 - 64);
    for (auto& slot : block->pictures.slots) change(slot.value);
    return client.latest().number == 1 && isWhole(client.latest());
  };
  EXPECT_FALSE(left([](PictureRecord&) {}));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(left([&](PictureRecord& r) { r.position_W[1] = infinite; }));
  EXPECT_TRUE(left([&](PictureRecord& r) { r.forward_W[0] = std::nan(""); }));
  EXPECT_TRUE(left([&](PictureRecord& r) { r.right_W[2] = infinite; }));
  EXPECT_TRUE(left([&](PictureRecord& r) { r.up_W[2] = -infinite; }));
  EXPECT_TRUE(left([&](PictureRecord& r) { r.vertical_fov_rad = std::nan(""); }));
  EXPECT_TRUE(left([](PictureRecord& r) { r.width = 0; }));
  EXPECT_TRUE(left([](PictureRecord& r) { r.height = -5; }));
  EXPECT_TRUE(left([](PictureRecord& r) { r.width = 65, r.height = 48; }));
  EXPECT_TRUE(left([](PictureRecord& r) { r.width = r.height = PICTURE_MOST_SIDE + 1; }));
  EXPECT_TRUE(left([](PictureRecord& r) { r.width = r.height = std::numeric_limits<std::int32_t>::max(); }));
}

TEST(ViewMemory, WhatIsNoPictureIsNotShown) {
  ViewMemory memory(kRoom);
  OtherProcess hostile([&] {
    std::mt19937_64 random(3);
    auto* const bytes = reinterpret_cast<std::byte*>(&memory.aims()) - 640;
    while (true) {
      const auto word = static_cast<std::uint32_t>(random() % 8 == 0 ? random() : random() % 8);
      std::memcpy(bytes + 4 * (random() % 160), &word, 4);
    }
  });
  ViewMemory client(copyOf(memory), kRoom);
  std::uint64_t last = 0, seen = 0;
  for (std::int64_t look = 0; look < 2'000'000'000 && seen < 50; ++look) {
    const ViewFrame& picture = client.latest();
    if (picture.number == last) continue;
    last = picture.number;
    ++seen;
    ASSERT_LE(picture.pixels.size(), kRoom.pixels);
    ASSERT_EQ(picture.pixels.size(),
              static_cast<std::size_t>(picture.camera.width) * static_cast<std::size_t>(picture.camera.height));
    ASSERT_TRUE(picture.camera.position_W.allFinite());
  }
  EXPECT_GE(seen, 50U);
}

TEST(ViewMemory, EachSideKnowsWhatItMaps) {
  const ViewMemory memory(kRoom);
  EXPECT_EQ(memory.room().pixels, kRoom.pixels);
  const auto refused = [&](std::size_t pixels, std::size_t ticks) {
    return refusalOf([&] { const ViewMemory none({.pixels = pixels, .ticks = ticks}); });
  };
  EXPECT_THAT(refused(0, 32), testing::HasSubstr("no room for 0 pixels"));
  EXPECT_THAT(refused(PICTURE_MOST_PIXELS + 1, 32), testing::HasSubstr("no room for"));
  EXPECT_THAT(refused(64, 0), testing::HasSubstr("0 ticks"));
  EXPECT_THAT(refused(64, ViewMemory::kMostTicks + 1), testing::HasSubstr("no room for"));
  EXPECT_NO_THROW(const ViewMemory most({.pixels = PICTURE_MOST_PIXELS, .ticks = ViewMemory::kMostTicks}));
  EXPECT_THAT(refusalOf([&] { const ViewMemory other(copyOf(memory), {.pixels = 10'000, .ticks = 32}); }),
              testing::HasSubstr("same version"));
  for (std::size_t i = 0; i < sizeof(ViewHeader); ++i) {
    ViewMemory other(kRoom);
    auto* const header = reinterpret_cast<std::byte*>(&other.aims()) - 640 - 64;
    header[i] ^= std::byte{1};
    EXPECT_THAT(refusalOf([&] { const ViewMemory none(copyOf(other), kRoom); }), testing::HasSubstr("layout")) << i;
  }
}

// The rest is there too, and lies where nothing else does.
TEST(ViewMemory, CarriesTicksAndAims) {
  ViewMemory memory(kRoom), client(copyOf(memory), kRoom);
  LiveTicks engine(memory.ticks(), memory.tickRing(), kRoom.ticks);
  LiveTicks window(client.ticks(), client.tickRing(), kRoom.ticks);
  PointerAim pointer(client.aims());
  TripleBuffer<PointerAimRecord> aims(memory.aims());
  pointer.aim(Vec3(1, 2, 3));
  for (std::int64_t tick = 0; tick < 20; ++tick) engine.add({.tick = tick});
  for (std::uint64_t number = 1; number < 200; ++number) putNumber(memory, number);
  std::vector<TickRecord> ticks;
  window.take(ticks);
  ASSERT_EQ(ticks.size(), 20U);
  EXPECT_EQ(ticks.back().tick, 19);
  EXPECT_EQ(aims.latest().hip_W[1], 2);
  EXPECT_TRUE(isWhole(client.latest()));
  EXPECT_EQ(client.latest().number, 199U);
}

}  // namespace view_memory_test
}  // namespace palpate
