// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/slot_slabs.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"

namespace palpate {
SlotSlabs::SlotSlabs(gpu::Gpu& gpu, Shape shape, std::size_t slots, std::shared_ptr<GpuBudget> budget)
    : gpu_(gpu), shape_(std::move(shape)), budget_(std::move(budget)), commands_(gpu, shape_.name + " growth", 1) {
  try {
    reserve(std::max<std::size_t>(slots, 1));
  } catch (...) {  // the destructor will not run
    budget_->used_bytes -= bytes();
    throw;
  }
}

SlotSlabs::~SlotSlabs() {
  budget_->used_bytes -= bytes();
}

std::size_t SlotSlabs::free() const noexcept {
  return capacity_ - next_ + free_count_;
}

std::size_t SlotSlabs::lastSlabSlots() const noexcept {
  return slabs_.empty() ? 0 : slabs_.back().bytes() / shape_.slot_bytes;
}

void SlotSlabs::reserve(std::size_t slots) {
  while (free() < slots) grow(slots - free());
}

// One step: widens the newest slab, or begins a new one. It at least doubles the capacity, unless that would take more
// than half of what the budget has left; others grow from it too.
void SlotSlabs::grow(std::size_t wanted_slots) {
  const std::uint64_t affordable = budget_->leftBytes() / shape_.slot_bytes;
  if (affordable < wanted_slots) {
    throw Error(Error::Code::kOutOfMemory, fmt::format("GPU memory for {}", shape_.name),
                fmt::format("{} are in use, {} more are needed, and the budget is {}", inMiB(budget_->used_bytes),
                            inMiB(wanted_slots * shape_.slot_bytes), inMiB(budget_->limit_bytes)),
                "nothing was changed; raise --gpu-memory, or use a smaller brush or volume");
  }
  const std::size_t doubling = next_ == 0 ? 0 : capacity_;
  const std::size_t step = doubling <= affordable / 2 ? std::max(wanted_slots, doubling) : wanted_slots;
  const std::size_t last = lastSlabSlots();
  if (!slabs_.empty() && last < shape_.slots_a_slab) {
    widenLastSlab(std::min<std::size_t>(last + step, shape_.slots_a_slab));
    return;
  }
  if (shape_.max_slabs != 0 && slabs_.size() == shape_.max_slabs) {
    throw Error(Error::Code::kOutOfMemory, fmt::format("GPU memory for {}", shape_.name),
                fmt::format("more than {} bricks are needed, which is all that {} slabs of 128 MiB hold",
                            shape_.max_slabs * shape_.slots_a_slab, shape_.max_slabs),
                "crop or resample the volume");
  }
  addSlab(std::min<std::size_t>(step, shape_.slots_a_slab));
}

void SlotSlabs::addSlab(std::size_t slots) {
  slabs_.emplace_back(gpu_, fmt::format("{} slab {}", shape_.name, slabs_.size()), slots * shape_.slot_bytes,
                      gpu::MemoryKind::kDevice);
  capacity_ += slots;
  budget_->used_bytes += slots * shape_.slot_bytes;
}

void SlotSlabs::widenLastSlab(std::size_t slots) {
  const std::size_t old_slots = lastSlabSlots();
  gpu::Buffer wider(gpu_, fmt::format("{} slab {}", shape_.name, slabs_.size() - 1), slots * shape_.slot_bytes,
                    gpu::MemoryKind::kDevice);
  commands_.begin();
  commands_.copy(slabs_.back(), 0, wider, 0, slabs_.back().bytes());
  commands_.run();
  slabs_.back() = std::move(wider);
  capacity_ += slots - old_slots;
  budget_->used_bytes += (slots - old_slots) * shape_.slot_bytes;
}

std::uint32_t SlotSlabs::take(std::size_t slab) noexcept {
  if (free_count_ == 0) return static_cast<std::uint32_t>(next_++);
  if (slab >= free_.size() || free_[slab].empty()) {
    const auto any = std::find_if(free_.rbegin(), free_.rend(), [](const auto& list) { return !list.empty(); });
    slab = static_cast<std::size_t>(free_.rend() - any) - 1;
  }
  const std::uint32_t slot = free_[slab].back();
  free_[slab].pop_back();
  --free_count_;
  return slot;
}

void SlotSlabs::release(std::uint32_t slot) {
  const std::size_t slab = slot / shape_.slots_a_slab;
  if (free_.size() <= slab) free_.resize(slab + 1);
  free_[slab].push_back(slot);
  ++free_count_;
}

void SlotSlabs::releaseAll() noexcept {
  next_ = 0;
  free_.clear();
  free_count_ = 0;
}

}  // namespace palpate
