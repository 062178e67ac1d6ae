// SPDX-License-Identifier: Apache-2.0
#include "apps/check/gradient_check.hpp"

#include <array>
#include <chrono>
#include <span>
#include <vector>

#include "apps/check/ulp.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/active_bricks.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/reference/gradient.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace {

constexpr std::array<const char*, 4> kComponents = {"gradient_i", "gradient_j", "gradient_k", "density"};

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void compare(GradientCheck& check, const Vec3i& voxel, const Sample& gpu, const std::array<float, 4>& cpu) {
  const std::array<float, 4> values = {gpu.gradient_i, gpu.gradient_j, gpu.gradient_k, gpu.density};
  for (std::size_t c = 0; c < values.size(); ++c) {
    ++check.compared;
    const std::uint32_t ulp = ulpDistance(values[c], cpu[c]);
    if (ulp == 0) continue;
    ++check.differing;
    if (ulp > check.largest_ulp) {
      check.largest_ulp = ulp;
      check.voxel = voxel;
      check.component = kComponents[c];
      check.gpu_value = values[c];
      check.cpu_value = cpu[c];
    }
  }
}

// All voxels of one brick that lie in the domain.
void compareBrick(GradientCheck& check, const reference::DenseField& field, const Vec3i& brick, const Sample* samples) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i end = (first.array() + kBrickSize).min(field.size.array());
  for (int k = first.z(); k < end.z(); ++k) {
    for (int j = first.y(); j < end.y(); ++j) {
      for (int i = first.x(); i < end.x(); ++i) {
        const Vec3i in_brick = Vec3i(i, j, k) - first;
        const Sample& gpu = samples[(in_brick.z() * kBrickSize + in_brick.y()) * kBrickSize + in_brick.x()];
        const std::array<float, 3> gradient = reference::gradientAt(field, i, j, k);
        compare(check, {i, j, k}, gpu, {gradient[0], gradient[1], gradient[2], field.at(i, j, k)});
      }
    }
  }
}

}  // namespace

GradientCheck checkGradient(const Volume& volume, const std::string& gpu_name,
                            const std::function<void(double)>& progress) {
  return checkGradient(volume, reference::denseField(volume), gpu_name, progress);
}

GradientCheck checkGradient(const Volume& volume, const reference::DenseField& field, const std::string& gpu_name,
                            const std::function<void(double)>& progress) {
  GradientCheck check;
  gpu::Gpu gpu({.name = gpu_name});
  check.device = gpu.info().name;
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  const SampleStore store(gpu, pool.brickCount(), allBricks(pool.brickCounts()));
  GradientPass pass(gpu, transfer, pool, store);
  pass.run();  // the first run pays for the driver's compiler
  const Stopwatch gpu_watch;
  pass.run();
  check.gpu_seconds = gpu_watch.seconds();

  const Stopwatch cpu_watch;
  std::vector<Sample> samples;
  for (std::size_t brick = 0; brick < pool.brickCount(); ++brick) {
    const SampleStore::Place place = store.place(brick);
    if (place.slot == 0) {
      samples.resize(store.slab(place.slab).bytes() / sizeof(Sample));
      transfer.download(store.slab(place.slab), std::as_writable_bytes(std::span(samples)));
    }
    const Vec3i counts = pool.brickCounts();
    const auto b = static_cast<int>(brick);
    const Vec3i at(b % counts.x(), b / counts.x() % counts.y(), b / (counts.x() * counts.y()));
    compareBrick(check, field, at, samples.data() + std::size_t{place.slot} * kBrickVoxels);
    if (brick % 256 == 0) progress(static_cast<double>(brick) / static_cast<double>(pool.brickCount()));
  }
  check.cpu_seconds = cpu_watch.seconds();
  return check;
}

}  // namespace palpate
