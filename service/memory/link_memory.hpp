// SPDX-License-Identifier: Apache-2.0
// service/memory/link_memory.hpp: what an engine and a servo in two processes share: the window exchange with its
// samples, the tool's pose, where a pointer leads the tool, and the ticks that a window shows.
//
// The engine makes one for each servo that connects, and never uses it for another: who held a servo's end before may
// still write there. Its layout is fixed, and counted: each side finds the other's version, the sizes and the seals as
// it knows them, or refuses. What the blocks hold is checked where it is read (servo/window).
// Set-up code; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "service/memory/sealed_memory.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/loop/live_ticks.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

// Counted up with every change of LinkBlock or of what it holds.
inline constexpr std::uint32_t kLinkLayout = 3;

struct LinkHeader {
  std::uint64_t magic = 0x4b4e494c50414c50;  // "PLAPLINK", little-endian
  std::uint32_t layout = kLinkLayout;
  std::uint32_t block_bytes = 0;
  std::uint64_t capacity_samples = 0;  // of each of the three windows
  std::uint64_t capacity_ticks = 0;    // of the ring of ticks; 0: none are told
};
static_assert(std::is_trivially_copyable_v<LinkHeader> && sizeof(LinkHeader) == 32);

struct LinkBlock {
  alignas(64) LinkHeader header;
  WindowBlock windows;
  ToolPoseBlock tool;
  PointerAimBlock aims;
  LiveTicksBlock ticks;
};
static_assert(std::is_standard_layout_v<LinkBlock> && sizeof(LinkBlock) == 64 + 704 + 640 + 256 + 768);

class LinkMemory {
 public:
  struct Room {
    std::size_t samples = 0;  // of each of three windows, 8 to kMostWindowSamples
    std::size_t ticks = 0;    // of the ring of ticks, up to kMostTicks
  };
  // The engine's. Throws as SealedMemory does, and Error(kBadInput) for such a room.
  explicit LinkMemory(const Room& room);
  // The servo's, as it was sent for this room. Throws Error(kBadInput) for anything else.
  LinkMemory(Descriptor given, const Room& room);

  static constexpr std::size_t kMostTicks = std::size_t{1} << 16U;
  static constexpr std::size_t kMostWindowSamples = std::size_t{64} * 64 * 64;
  // Each window begins at a page, so that a driver can use it in place.
  static constexpr std::size_t kPage = SealedMemory::kPage;

  [[nodiscard]] WindowBlock& windows() noexcept { return block().windows; }
  [[nodiscard]] ToolPoseBlock& tool() noexcept { return block().tool; }
  [[nodiscard]] std::array<Sample*, 3> samples() noexcept;
  [[nodiscard]] PointerAimBlock& aims() noexcept { return block().aims; }
  [[nodiscard]] LiveTicksBlock& ticks() noexcept { return block().ticks; }
  [[nodiscard]] TickRecord* tickRing() noexcept;
  [[nodiscard]] std::size_t capacity() const noexcept { return room_.samples; }
  [[nodiscard]] std::size_t tickCapacity() const noexcept { return room_.ticks; }
  [[nodiscard]] std::size_t windowBytes() const noexcept;  // of each, whole pages
  [[nodiscard]] int descriptor() const noexcept { return memory_.descriptor(); }

 private:
  [[nodiscard]] LinkBlock& block() noexcept;

  Room room_;
  SealedMemory memory_;
};

}  // namespace palpate
