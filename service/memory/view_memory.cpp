// SPDX-License-Identifier: Apache-2.0
#include "service/memory/view_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/other_version.hpp"

namespace palpate {
namespace {

std::size_t bytesFor(const ViewMemory::Room& room) {
  if (room.pixels < 1 || room.pixels > PICTURE_MOST_PIXELS || room.ticks < 1 || room.ticks > ViewMemory::kMostTicks) {
    throw Error(Error::Code::kBadInput, "a view",
                formatted("there is no room for {} pixels and {} ticks; up to {} and {} there is", room.pixels,
                          room.ticks, PICTURE_MOST_PIXELS, ViewMemory::kMostTicks),
                "make the window smaller");
  }
  return SealedMemory::wholePages(sizeof(ViewBlock)) +
         3 * SealedMemory::wholePages(room.pixels * sizeof(layout::PicturePixel)) +
         SealedMemory::wholePages(room.ticks * sizeof(TickRecord));
}

ViewHeader headerFor(const ViewMemory::Room& room) {
  ViewHeader header;
  header.block_bytes = sizeof(ViewBlock);
  header.capacity_pixels = room.pixels;
  header.capacity_ticks = room.ticks;
  return header;
}

Vec3 vectorOf(const double (&of)[3]) {
  return {of[0], of[1], of[2]};
}

void put(double (&into)[3], const Vec3& v) {
  std::copy_n(v.data(), 3, into);
}

// Empty: it is none.
std::optional<Camera> cameraOf(const PictureRecord& record) {
  Camera camera;
  camera.position_W = vectorOf(record.position_W);
  camera.forward_W = vectorOf(record.forward_W);
  camera.right_W = vectorOf(record.right_W);
  camera.up_W = vectorOf(record.up_W);
  camera.vertical_fov_rad = record.vertical_fov_rad;
  camera.width = record.width;
  camera.height = record.height;
  const bool is_one = camera.position_W.allFinite() && camera.forward_W.allFinite() && camera.right_W.allFinite() &&
                      camera.up_W.allFinite() && std::isfinite(camera.vertical_fov_rad) && camera.width > 0 &&
                      camera.height > 0 && camera.width <= PICTURE_MOST_SIDE && camera.height <= PICTURE_MOST_SIDE;
  return is_one ? std::optional(camera) : std::nullopt;
}

std::size_t pixelsOf(const Camera& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

ViewBlock& blockIn(const SealedMemory& memory) {
  return *std::launder(reinterpret_cast<ViewBlock*>(memory.data()));
}

SealedMemory made(const ViewMemory::Room& room) {
  SealedMemory memory("palpate-view", bytesFor(room), SealedMemory::Pages::kWhenUsed);
  (new (memory.data()) ViewBlock{})->header = headerFor(room);
  return memory;
}

SealedMemory checked(SealedMemory memory, const ViewMemory::Room& room) {
  const ViewHeader header = blockIn(memory).header, expected = headerFor(room);
  if (std::memcmp(&header, &expected, sizeof header) != 0) {
    refuseOtherVersion("a view", formatted("its layout is not number {}, which this program knows", kViewLayout));
  }
  return memory;
}

}  // namespace

ViewMemory::ViewMemory(const Room& room) : room_(room), memory_(made(room)), pictures_(block().pictures) {}

ViewMemory::ViewMemory(Descriptor given, const Room& room)
    : room_(room),
      memory_(checked(SealedMemory(std::move(given), bytesFor(room), SealedMemory::Pages::kWhenUsed), room)),
      pictures_(block().pictures) {}

ViewBlock& ViewMemory::block() noexcept {
  return blockIn(memory_);
}

layout::PicturePixel* ViewMemory::pixelsOf(unsigned slot) noexcept {
  return reinterpret_cast<layout::PicturePixel*>(
      memory_.data() + SealedMemory::wholePages(sizeof(ViewBlock)) +
      slot * SealedMemory::wholePages(room_.pixels * sizeof(layout::PicturePixel)));
}

TickRecord* ViewMemory::tickRing() noexcept {
  return reinterpret_cast<TickRecord*>(pixelsOf(3));
}

bool ViewMemory::put(const Camera& camera, std::span<const layout::PicturePixel> pixels, std::uint64_t edit_version,
                     bool fine, bool whole) noexcept {
  if (pixels.size() > room_.pixels || camera.width < 1 || camera.height < 1 ||
      palpate::pixelsOf(camera) != pixels.size())
    return false;
  std::ranges::copy(pixels, pixelsOf(pictures_.backIndex()));
  PictureRecord record{.number = ++put_, .edit_version = edit_version};
  palpate::put(record.position_W, camera.position_W);
  palpate::put(record.forward_W, camera.forward_W);
  palpate::put(record.right_W, camera.right_W);
  palpate::put(record.up_W, camera.up_W);
  record.vertical_fov_rad = camera.vertical_fov_rad;
  record.width = camera.width;
  record.height = camera.height;
  record.fine = fine ? 1 : 0;
  record.whole = whole ? 1 : 0;
  pictures_.back() = record;
  pictures_.publish();
  return true;
}

const ViewFrame& ViewMemory::latest() {
  if (!pictures_.renew()) return latest_;
  const PictureRecord record = pictures_.front();  // a copy: the other side may write on
  std::atomic_signal_fence(std::memory_order_seq_cst);
  const std::optional<Camera> camera = cameraOf(record);
  if (!camera || palpate::pixelsOf(*camera) > room_.pixels) return latest_;
  const layout::PicturePixel* const first = pixelsOf(pictures_.frontIndex());
  latest_.pixels.assign(first, first + palpate::pixelsOf(*camera));
  latest_.number = record.number;
  latest_.camera = *camera;
  latest_.edit_version = record.edit_version;
  latest_.fine = record.fine != 0;
  latest_.whole = record.whole != 0;
  return latest_;
}

}  // namespace palpate
