// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/half_voxel_march.hpp"

#include <algorithm>
#include <span>

#include "engine/draw/draw_push.hpp"
#include "engine/draw/drawing.hpp"
#include "engine/draw/picture_image.hpp"

namespace palpate {
namespace {

// Drawn at once. A picture of a large volume takes a processor many seconds; no single submission may take a minute.
constexpr layout::uint kBandRows = 8 * HALF_VOXEL_MARCH_GROUP;

}  // namespace

HalfVoxelMarch::HalfVoxelMarch(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool,
                               const BrickBoundsPass& bounds)
    : gpu_(gpu),
      transfer_(transfer),
      pool_(pool),
      bounds_(bounds),
      kernel_(gpu, "half_voxel_march", pool, HALF_VOXEL_MARCH_BINDINGS, sizeof(layout::HalfVoxelMarchPush)),
      commands_(gpu, "half_voxel_march", 1) {}

void HalfVoxelMarch::show(const Camera& camera, double isovalue) {
  push_ = {pool_.domain(),
           static_cast<layout::uint>(camera.width),
           static_cast<layout::uint>(camera.height),
           static_cast<float>(isovalue),
           pictureRays(pool_.lattice(), camera),
           0};
  pixels_.emplace(gpu_, "pixels", std::size_t{push_.width} * push_.height * sizeof(layout::PicturePixel),
                  gpu::MemoryKind::kDevice);
}

void HalfVoxelMarch::finish() {
  const auto groups = [](layout::uint length) {
    return (length + HALF_VOXEL_MARCH_GROUP - 1) / HALF_VOXEL_MARCH_GROUP;
  };
  for (layout::uint row = 0; row < push_.height; row += kBandRows) {
    push_.first_row = row;
    commands_.begin();
    commands_.dispatch(kernel_.get(), poolBindings(pool_, {&bounds_.bounds(), &*pixels_}), gpu::pushBytes(push_),
                       {groups(push_.width), groups(std::min(kBandRows, push_.height - row))});
    commands_.run();
  }
}

RenderedImage HalfVoxelMarch::image() {
  std::vector<layout::PicturePixel> raw(std::size_t{push_.width} * push_.height);
  transfer_.download(*pixels_, std::as_writable_bytes(std::span(raw)));
  return asImage(static_cast<int>(push_.width), static_cast<int>(push_.height), raw);
}

}  // namespace palpate
