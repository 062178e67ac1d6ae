// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/brick_pool.hpp"

#include <array>
#include <span>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

static_assert(BRICK_EDGE == kBrickSize);
static_assert(BINDING_OWN == BINDING_SLABS + DENSITY_SLABS);

layout::PoolDomain domainOf(const Volume& volume) {
  const auto size = volume.size().cast<layout::uint>().eval();
  const auto bricks = volume.brickCount().cast<layout::uint>().eval();
  return {size.x(), size.y(), size.z(), bricks.x(), bricks.y(), bricks.z()};
}

Error tooLarge(const Volume& volume, std::size_t slabs) {
  return {Error::Code::kOutOfMemory, volume.facts().source,
          fmt::format("its {} bricks with content need more than {} slabs of 128 MiB on the GPU", volume.storedBricks(),
                      slabs),
          "crop or resample the volume"};
}

}  // namespace

BrickPool::BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const Volume& volume)
    : domain_(domainOf(volume)), lattice_(volume.lattice()) {
  std::vector<layout::BrickPage> pages;
  pages.reserve(brickCount());
  std::vector<float> slab;
  std::array<float, kBrickVoxels> brick{};
  const Vec3i counts = brickCounts();
  for (int z = 0; z < counts.z(); ++z) {
    for (int y = 0; y < counts.y(); ++y) {
      for (int x = 0; x < counts.x(); ++x) {
        if (volume.readBrick({x, y, z}, brick.data())) {
          pages.push_back({NO_SLOT, brick[0]});
          continue;
        }
        pages.push_back({static_cast<layout::uint>(stored_bricks_++), 0.0F});
        slab.insert(slab.end(), brick.begin(), brick.end());
        if (slab.size() == std::size_t{BRICKS_PER_DENSITY_SLAB} * kBrickVoxels) {
          if (slabs_.size() == DENSITY_SLABS) throw tooLarge(volume, DENSITY_SLABS);
          addSlab(gpu, transfer, slab);
          slab.clear();
        }
      }
    }
  }
  if (slab.empty() && slabs_.empty()) slab.resize(kBrickVoxels);  // all constant: one brick that no page names
  if (!slab.empty()) {
    if (slabs_.size() == DENSITY_SLABS) throw tooLarge(volume, DENSITY_SLABS);
    addSlab(gpu, transfer, slab);
  }
  pages_.emplace_back(gpu, "page table", pages.size() * sizeof(layout::BrickPage), gpu::MemoryKind::kDevice);
  transfer.upload(std::as_bytes(std::span(pages)), pages_.front());
}

void BrickPool::addSlab(gpu::Gpu& gpu, gpu::Transfer& transfer, const std::vector<float>& values) {
  slabs_.emplace_back(gpu, fmt::format("density slab {}", slabs_.size()), values.size() * sizeof(float),
                      gpu::MemoryKind::kDevice);
  transfer.upload(std::as_bytes(std::span(values)), slabs_.back());
}

Vec3i BrickPool::size() const noexcept {
  return Eigen::Vector<layout::uint, 3>(domain_.size_x, domain_.size_y, domain_.size_z).cast<int>();
}

Vec3i BrickPool::brickCounts() const noexcept {
  return Eigen::Vector<layout::uint, 3>(domain_.bricks_x, domain_.bricks_y, domain_.bricks_z).cast<int>();
}

std::size_t BrickPool::brickCount() const noexcept {
  return std::size_t{domain_.bricks_x} * domain_.bricks_y * domain_.bricks_z;
}

std::size_t BrickPool::bytes() const noexcept {
  std::size_t total = pages_.front().bytes();
  for (const gpu::Buffer& slab : slabs_) total += slab.bytes();
  return total;
}

}  // namespace palpate
