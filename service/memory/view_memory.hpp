// SPDX-License-Identifier: Apache-2.0
// service/memory/view_memory.hpp: what an engine and a client who looks on share: pictures that the engine draws, the
// servo's ticks, and where the client's pointer leads the tool.
//
// The engine makes one for each such client, and never uses it for another. Each side finds the layout's number, the
// sizes and the seals as it expects them, or refuses. What the other side writes is not believed: a picture has a
// camera, and as many pixels as there is room for, or it is left out.
// Room that no picture fills costs no memory. World frame, [m]. Threads: one of the engine's and one of the client's
// each use their end. Wait-free.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "service/memory/sealed_memory.hpp"
#include "service/memory/view_frame.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/loop/live_ticks.hpp"
#include "servo/window/triple_buffer.hpp"
#include "shaders/picture.layout.h"

namespace palpate {

// Counted up with every change of ViewBlock or of what it holds.
inline constexpr std::uint32_t kViewLayout = 1;

struct ViewHeader {
  std::uint64_t magic = 0x574549564c415050;  // "PPALVIEW", little-endian
  std::uint32_t layout = kViewLayout;
  std::uint32_t block_bytes = 0;
  std::uint64_t capacity_pixels = 0;  // of each of the three pictures
  std::uint64_t capacity_ticks = 0;   // of the ring of ticks
};
static_assert(std::is_trivially_copyable_v<ViewHeader> && sizeof(ViewHeader) == 32);

// A picture as it lies there, beside its pixels.
struct PictureRecord {
  std::uint64_t number = 0, edit_version = 0;
  double position_W[3] = {}, forward_W[3] = {}, right_W[3] = {}, up_W[3] = {};
  double vertical_fov_rad = 0;
  std::int32_t width = 0, height = 0;
  std::uint32_t fine = 0, whole = 0;  // 0 or 1
};
static_assert(std::is_trivially_copyable_v<PictureRecord> && sizeof(PictureRecord) == 136);

struct ViewBlock {
  alignas(64) ViewHeader header;
  TripleBlock<PictureRecord> pictures;
  PointerAimBlock aims;
  LiveTicksBlock ticks;
};
static_assert(std::is_standard_layout_v<ViewBlock> && sizeof(ViewBlock) == 64 + 640 + 256 + 768);

class ViewMemory {
 public:
  struct Room {
    std::size_t pixels = 0;  // of each picture, 1 to PICTURE_MOST_PIXELS
    std::size_t ticks = 0;   // of the ring, 1 to kMostTicks
  };
  static constexpr std::size_t kMostTicks = std::size_t{1} << 16U;
  // The engine's. Throws as SealedMemory does, and Error(kBadInput) for such a room.
  explicit ViewMemory(const Room& room);
  // The client's, as it was sent for this room. Throws Error(kBadInput) for anything else.
  ViewMemory(Descriptor given, const Room& room);
  ViewMemory(const ViewMemory&) = delete;
  ViewMemory& operator=(const ViewMemory&) = delete;

  // Engine: the next picture. False: it has more pixels than there is room for, or not those of its camera.
  bool put(const Camera& camera, std::span<const layout::PicturePixel> pixels, std::uint64_t edit_version, bool fine,
           bool whole) noexcept;
  // Client: the newest picture, valid until the next call; its `request` is not told.
  [[nodiscard]] const ViewFrame& latest();

  [[nodiscard]] PointerAimBlock& aims() noexcept { return block().aims; }
  [[nodiscard]] LiveTicksBlock& ticks() noexcept { return block().ticks; }
  [[nodiscard]] TickRecord* tickRing() noexcept;
  [[nodiscard]] const Room& room() const noexcept { return room_; }
  [[nodiscard]] int descriptor() const noexcept { return memory_.descriptor(); }

 private:
  [[nodiscard]] ViewBlock& block() noexcept;
  [[nodiscard]] layout::PicturePixel* pixelsOf(unsigned slot) noexcept;

  Room room_;
  SealedMemory memory_;
  TripleBuffer<PictureRecord> pictures_;
  std::uint64_t put_ = 0;  // the engine's
  ViewFrame latest_;       // the client's
};

}  // namespace palpate
