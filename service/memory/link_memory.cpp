// SPDX-License-Identifier: Apache-2.0
#include "service/memory/link_memory.hpp"

#include <cstring>
#include <new>
#include <utility>

#include "base/formatted.hpp"
#include "base/other_version.hpp"

namespace palpate {
namespace {

void checkRoom(const LinkMemory::Room& room) {
  if (room.samples < 8 || room.samples > LinkMemory::kMostWindowSamples) {
    refuseOtherVersion("shared memory", formatted("windows of {} samples are none; they have 8 to {}", room.samples,
                                                  LinkMemory::kMostWindowSamples));
  }
  if (room.ticks > LinkMemory::kMostTicks) {
    refuseOtherVersion("shared memory",
                       formatted("there is no room for {} ticks, but for {}", room.ticks, LinkMemory::kMostTicks));
  }
}

std::size_t bytesFor(const LinkMemory::Room& room) {
  checkRoom(room);
  return SealedMemory::wholePages(sizeof(LinkBlock)) + 3 * SealedMemory::wholePages(room.samples * sizeof(Sample)) +
         SealedMemory::wholePages(room.ticks * sizeof(TickRecord));
}

LinkHeader headerFor(const LinkMemory::Room& room) {
  LinkHeader header;
  header.block_bytes = sizeof(LinkBlock);
  header.capacity_samples = room.samples;
  header.capacity_ticks = room.ticks;
  return header;
}

}  // namespace

LinkMemory::LinkMemory(const Room& room) : room_(room), memory_("palpate-link", bytesFor(room)) {
  auto* const made = new (memory_.data()) LinkBlock{};
  made->header = headerFor(room);
}

LinkMemory::LinkMemory(Descriptor given, const Room& room) : room_(room), memory_(std::move(given), bytesFor(room)) {
  const LinkHeader header = block().header, expected = headerFor(room);
  if (std::memcmp(&header, &expected, sizeof header) != 0) {
    refuseOtherVersion("shared memory",
                       formatted("its layout is not number {}, which this program knows", kLinkLayout));
  }
}

LinkBlock& LinkMemory::block() noexcept {
  return *std::launder(reinterpret_cast<LinkBlock*>(memory_.data()));
}

std::size_t LinkMemory::windowBytes() const noexcept {
  return SealedMemory::wholePages(room_.samples * sizeof(Sample));
}

TickRecord* LinkMemory::tickRing() noexcept {
  return reinterpret_cast<TickRecord*>(memory_.data() + SealedMemory::wholePages(sizeof(LinkBlock)) +
                                       3 * windowBytes());
}

std::array<Sample*, 3> LinkMemory::samples() noexcept {
  std::array<Sample*, 3> samples{};
  for (std::size_t slot = 0; slot < 3; ++slot)
    samples[slot] =
        reinterpret_cast<Sample*>(memory_.data() + SealedMemory::wholePages(sizeof(LinkBlock)) + slot * windowBytes());
  return samples;
}

}  // namespace palpate
