// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/isosurface_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

namespace palpate {
namespace {

// Drawn at once. A picture of a large volume takes a processor many seconds; no single submission may take a minute.
constexpr int kBandRows = 8 * ISOSURFACE_GROUP;

layout::IsosurfacePush pushFor(const BrickPool& pool, const Camera& camera, double isovalue) {
  const Lattice& lattice = pool.lattice();
  const auto toLattice = [&](const Vec3& direction_W) -> Vec3 { return lattice.R_WL.transpose() * direction_W; };
  // The image plane at unit distance: pixels are square.
  const double pixel = 2.0 * std::tan(camera.vertical_fov_rad / 2) / camera.height;
  const Vec3 right = toLattice(camera.right_W) * pixel;
  const Vec3 down = toLattice(-camera.up_W) * pixel;
  const Vec3 corner = toLattice(camera.forward_W) - right * (camera.width / 2.0) - down * (camera.height / 2.0);
  const Vec3 eye = lattice.toIndex(camera.position_W);
  const auto f = [](double value) { return static_cast<float>(value); };
  return {pool.domain(),
          static_cast<layout::uint>(camera.width),
          static_cast<layout::uint>(camera.height),
          f(isovalue),
          f(lattice.spacing_m.x()),
          f(lattice.spacing_m.y()),
          f(lattice.spacing_m.z()),
          f(eye.x()),
          f(eye.y()),
          f(eye.z()),
          f(corner.x()),
          f(corner.y()),
          f(corner.z()),
          f(right.x()),
          f(right.y()),
          f(right.z()),
          f(down.x()),
          f(down.y()),
          f(down.z()),
          0};
}

}  // namespace

IsosurfacePass::IsosurfacePass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool,
                               const BrickBoundsPass& bounds)
    : gpu_(gpu),
      transfer_(transfer),
      pool_(pool),
      bounds_(bounds),
      kernel_(gpu, "isosurface", pool, ISOSURFACE_BINDINGS, sizeof(layout::IsosurfacePush)),
      commands_(gpu, "isosurface", 1) {}

RenderedImage IsosurfacePass::draw(const Camera& camera, double isovalue, const std::function<void()>& between) {
  const std::size_t count = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  const gpu::Buffer pixels(gpu_, "pixels", count * sizeof(layout::IsosurfacePixel), gpu::MemoryKind::kDevice);
  const auto groups = [](int length) {
    return static_cast<std::uint32_t>((length + ISOSURFACE_GROUP - 1) / ISOSURFACE_GROUP);
  };
  layout::IsosurfacePush push = pushFor(pool_, camera, isovalue);
  for (int row = 0; row < camera.height; row += kBandRows) {
    push.first_row = static_cast<layout::uint>(row);
    commands_.begin();
    commands_.dispatch(kernel_.get(), poolBindings(pool_, {&bounds_.bounds(), &pixels}), gpu::pushBytes(push),
                       {groups(camera.width), groups(std::min(kBandRows, camera.height - row))});
    commands_.run();
    if (between) between();
  }

  std::vector<layout::IsosurfacePixel> raw(count);
  transfer_.download(pixels, std::as_writable_bytes(std::span(raw)));
  RenderedImage image{camera.width, camera.height, {}, {}};
  image.rgba.resize(4 * count);
  image.distance_m.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&image.rgba[4 * i], &raw[i].rgba, 4);  // red lowest, so red first on a little-endian host
    image.distance_m[i] = raw[i].distance_m;
  }
  return image;
}

}  // namespace palpate
