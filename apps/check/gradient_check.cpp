// SPDX-License-Identifier: Apache-2.0
#include "apps/check/gradient_check.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "base/stopwatch.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/reference/gradient.hpp"
#include "engine/reference/half.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace {

constexpr std::array<const char*, 4> kComponents = {"gradient_i", "gradient_j", "gradient_k", "density"};

using Values = std::array<float, 4>;

Values valuesOf(const Sample& sample) {
  return {sample.gradient_i, sample.gradient_j, sample.gradient_k, sample.density};
}

void compare(Check& check, const Vec3i& voxel, const Values& values, const Values& cpu) {
  for (std::size_t c = 0; c < values.size(); ++c) check.compare(voxel, kComponents[c], values[c], cpu[c]);
}

// The samples of a slab as they are stored: floats or halves.
class StoredSamples {
 public:
  explicit StoredSamples(const SampleFormat& format) : format_(format) {}

  void download(gpu::Transfer& transfer, const gpu::Buffer& slab) {
    bytes_.resize(slab.bytes());
    transfer.download(slab, bytes_);
  }
  // The stored sample of a voxel, and the wanted one. Halves are compared as stored, without their scales.
  [[nodiscard]] Values got(std::size_t voxel) const {
    Values values{};
    if (!format_.half) {
      std::memcpy(values.data(), bytes_.data() + voxel * sizeof values, sizeof values);
      return values;
    }
    std::array<std::uint16_t, 4> halves{};
    std::memcpy(halves.data(), bytes_.data() + voxel * sizeof halves, sizeof halves);
    std::transform(halves.begin(), halves.end(), values.begin(), reference::fromHalf);
    return values;
  }
  [[nodiscard]] Values wanted(const Sample& sample) const {
    Values values = valuesOf(sample);
    if (!format_.half) return values;
    for (std::size_t c = 0; c < 3; ++c) values[c] = values[c] * format_.code.gradient_scale;
    values[3] = (values[3] - format_.code.zero) * format_.code.density_scale;
    for (float& value : values) value = reference::fromHalf(reference::toHalf(value));
    return values;
  }

 private:
  SampleFormat format_;
  std::vector<std::byte> bytes_;
};

// The twin's input: the field, and the smoothed field whose gradient is taken.
struct TwinFields {
  const reference::DenseField& density;
  const reference::DenseField& smoothed;
};

// All voxels of one brick that lie in the domain.
void compareBrick(Check& check, const TwinFields& twin, const GradientOperator& gradient_operator, const Vec3i& brick,
                  const StoredSamples& samples, std::size_t first_voxel) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i end = (first.array() + kBrickSize).min(twin.density.size.array());
  for (int k = first.z(); k < end.z(); ++k) {
    for (int j = first.y(); j < end.y(); ++j) {
      for (int i = first.x(); i < end.x(); ++i) {
        const Vec3i in_brick = Vec3i(i, j, k) - first;
        const std::size_t voxel =
            (static_cast<std::size_t>(in_brick.z()) * kBrickSize + in_brick.y()) * kBrickSize + in_brick.x();
        const std::array<float, 3> gradient = reference::gradientAt(twin.smoothed, gradient_operator, i, j, k);
        compare(check, {i, j, k}, samples.got(first_voxel + voxel),
                samples.wanted({gradient[0], gradient[1], gradient[2], twin.density.at(i, j, k)}));
      }
    }
  }
}

}  // namespace

Check checkGradient(const Volume& volume, const GradientCheckRequest& request,
                    const std::function<void(double)>& progress) {
  return checkGradient(volume, reference::denseField(volume), request, progress);
}

Check checkGradient(const Volume& volume, const reference::DenseField& field, const GradientCheckRequest& request,
                    const std::function<void(double)>& progress) {
  Check check;
  check.name = "gradient";
  check.what = std::string(request.gradient.kind.name) + (request.format.half ? ", halves" : ", floats");
  check.volume = volume.facts().source;
  check.bound_ulp = request.bound_ulp;
  gpu::Gpu gpu({.name = request.gpu});
  check.device = gpu.info().name;
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  // If the operator smooths, this takes half of the twin's time.
  const double smoothing_share = request.gradient.smoothing.empty() ? 0 : 0.5;
  const auto before = [&](double) { progress(0); };
  const auto smoothing =
      filteredBy(gpu, transfer, pool, lowerFilters(request.gradient.smoothing, pool.lattice().spacing_m), before);
  const SampleStore store(gpu, pool.brickCount(), allBricks(pool.grid()), makeGpuBudget(), request.format);
  GradientPass pass(gpu, transfer, pool, store, request.gradient, smoothing ? &smoothing->result() : nullptr);
  pass.run(before);  // the first run pays for the driver's compiler
  const Stopwatch gpu_watch;
  pass.run();
  check.gpu_seconds = gpu_watch.seconds();

  const Stopwatch cpu_watch;
  const reference::DenseField smoothed =
      reference::smoothedFor(request.gradient, field, [&](double done) { progress(smoothing_share * done); });
  StoredSamples samples(request.format);
  for (std::uint32_t brick = 0; brick < pool.brickCount(); ++brick) {
    const SampleStore::Place place = store.place(brick);
    if (place.slot == 0) samples.download(transfer, store.slab(place.slab));
    compareBrick(check, {field, smoothed}, request.gradient, pool.grid().brick(brick), samples,
                 std::size_t{place.slot} * kBrickVoxels);
    if (brick % 256 != 0) continue;
    progress(smoothing_share +
             (1 - smoothing_share) * static_cast<double>(brick) / static_cast<double>(pool.brickCount()));
  }
  check.cpu_seconds = cpu_watch.seconds();
  return check;
}

}  // namespace palpate
