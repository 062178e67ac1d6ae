// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/brick_pool.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "base/error.hpp"

namespace palpate {
namespace {

static_assert(BRICK_EDGE == kBrickSize);
static_assert(BINDING_OWN == BINDING_SLABS + DENSITY_SLABS);

constexpr std::size_t kUploadBricks = 4096;  // at once: 8 MiB

layout::PoolDomain domainOf(const Volume& volume) {
  const auto size = volume.size().cast<layout::uint>().eval();
  const auto bricks = volume.brickCount().cast<layout::uint>().eval();
  return {size.x(), size.y(), size.z(), bricks.x(), bricks.y(), bricks.z()};
}

}  // namespace

BrickPool::BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const Volume& volume, std::shared_ptr<GpuBudget> budget)
    : domain_(domainOf(volume)), lattice_(volume.lattice()), budget_(std::move(budget)) {
  const SlotSlabs::Shape shape{"density", kBrickBytes, BRICKS_PER_DENSITY_SLAB, DENSITY_SLABS};
  slabs_ = std::make_unique<SlotSlabs>(gpu, shape, volume.storedBricks(), budget_);
  pages_.reserve(std::size_t{domain_.bricks_x} * domain_.bricks_y * domain_.bricks_z);
  std::vector<float> pending;  // densities of the slots from `first_slot` on
  std::uint32_t first_slot = 0;
  std::array<float, kBrickVoxels> brick{};
  grid().forEach([&](const Vec3i& at) {
    if (volume.readBrick(at, brick.data())) {
      pages_.push_back({NO_SLOT, brick[0]});
      return;
    }
    pages_.push_back({slabs_->take(), 0.0F});
    pending.insert(pending.end(), brick.begin(), brick.end());
    if (pending.size() < kUploadBricks * kBrickVoxels) return;
    upload(transfer, pending, first_slot);
    first_slot += kUploadBricks;
    pending.clear();
  });
  if (!pending.empty()) upload(transfer, pending, first_slot);
  page_table_.emplace(gpu, "page table", pages_.size() * sizeof(layout::BrickPage), gpu::MemoryKind::kDevice);
  transfer.upload(std::as_bytes(std::span(pages_)), *page_table_);
}

BrickPool::BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& like, const std::string& name)
    : domain_(like.domain_),
      lattice_(like.lattice_),
      budget_(like.budget_),
      pages_(like.brickCount(), {NO_SLOT, 0.0F}) {
  const SlotSlabs::Shape shape{name, kBrickBytes, BRICKS_PER_DENSITY_SLAB, DENSITY_SLABS};
  slabs_ = std::make_unique<SlotSlabs>(gpu, shape, 0, budget_);
  page_table_.emplace(gpu, name + " page table", pages_.size() * sizeof(layout::BrickPage), gpu::MemoryKind::kDevice);
  transfer.upload(std::as_bytes(std::span(pages_)), *page_table_);
}

void BrickPool::assign(gpu::Transfer& transfer, std::vector<layout::BrickPage> pages) {
  const auto stored = [](const layout::BrickPage& page) { return page.slot != NO_SLOT; };
  slabs_->releaseAll();
  stale_.clear();
  std::fill(pages_.begin(), pages_.end(), layout::BrickPage{NO_SLOT, 0.0F});
  slabs_->reserve(static_cast<std::size_t>(std::count_if(pages.begin(), pages.end(), stored)));
  pages_ = std::move(pages);
  for (layout::BrickPage& page : pages_) page = stored(page) ? layout::BrickPage{slabs_->take(), 0.0F} : page;
  transfer.upload(std::as_bytes(std::span(pages_)), *page_table_);
}

// A slab holds a whole number of uploads, so none of them crosses its end.
void BrickPool::upload(gpu::Transfer& transfer, const std::vector<float>& values, std::uint32_t first_slot) {
  static_assert(BRICKS_PER_DENSITY_SLAB % kUploadBricks == 0);
  const Place at = place(first_slot);
  transfer.upload(std::as_bytes(std::span(values)), slabs_->slab(at.slab), at.offset_bytes);
}

Vec3i BrickPool::size() const noexcept {
  return Eigen::Vector<layout::uint, 3>(domain_.size_x, domain_.size_y, domain_.size_z).cast<int>();
}

BrickPool::Place BrickPool::place(std::uint32_t slot) noexcept {
  return {slot / BRICKS_PER_DENSITY_SLAB, slot % BRICKS_PER_DENSITY_SLAB * kBrickBytes};
}

std::uint32_t BrickPool::store(std::size_t brick) {
  pages_[brick] = {slabs_->take(), 0.0F};
  return pages_[brick].slot;
}

void BrickPool::empty(std::size_t brick) {
  slabs_->release(pages_[brick].slot);
  pages_[brick] = {NO_SLOT, 0.0F};
}

void BrickPool::makeConstant(std::size_t brick, float value) {
  if (pages_[brick].slot != NO_SLOT) slabs_->release(pages_[brick].slot);
  pages_[brick] = {NO_SLOT, value};
  stale_.push_back(static_cast<std::uint32_t>(brick));
}

std::vector<std::uint32_t> BrickPool::takeStalePages() {
  return std::exchange(stale_, {});
}

bool BrickPool::readBrick(gpu::Transfer& transfer, std::size_t brick, float* values) const {
  const layout::BrickPage& page = pages_[brick];
  if (page.slot == NO_SLOT) {
    values[0] = page.constant;
    return true;
  }
  const Place at = place(page.slot);
  transfer.download(slabs_->slab(at.slab), std::as_writable_bytes(std::span(values, kBrickVoxels)), at.offset_bytes);
  return false;
}

}  // namespace palpate
