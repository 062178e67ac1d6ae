// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/resident_gradient.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/passes/brick_tasks.hpp"
#include "engine/reference/half.hpp"

namespace palpate {
namespace {

// A sample as floats, from the bytes of a slab.
Sample sampleIn(const std::byte* bytes, const SampleFormat& format) {
  if (!format.half) {
    Sample sample{};
    std::memcpy(&sample, bytes, sizeof sample);
    return sample;
  }
  std::array<std::uint16_t, 4> halves{};
  std::memcpy(halves.data(), bytes, sizeof halves);
  const layout::SampleCode code = format.readingCode();
  const auto gradient = [&](std::size_t axis) { return reference::fromHalf(halves[axis]) * code.gradient_scale; };
  return {gradient(0), gradient(1), gradient(2), reference::fromHalf(halves[3]) * code.density_scale + code.zero};
}

}  // namespace

ResidentGradient::ResidentGradient(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool,
                                   const GradientOperator& gradient_operator, const std::vector<std::uint32_t>& bricks,
                                   const SampleFormat& format)
    : transfer_(transfer),
      pool_(pool),
      steps_(lowerFilters(gradient_operator.smoothing, pool_.lattice().spacing_m)),
      store_(gpu, pool_.brickCount(), bricks, pool_.budget(), format) {
  if (!steps_.empty()) smoothing_.emplace(gpu, transfer, pool_, steps_);
  pass_.emplace(gpu, transfer, pool_, store_, gradient_operator, smoothing_ ? &smoothing_->result() : nullptr);
  BrickTasks by_slab;
  for (const std::uint32_t brick : store_.bricks()) by_slab.add(brick, store_.place(brick));
  std::vector<layout::BrickTask> list;
  ranges_ = by_slab.moveTo(list);
  tasks_.emplace(gpu, "gradient tasks", std::max<std::size_t>(1, list.size()) * sizeof(layout::BrickTask),
                 gpu::MemoryKind::kDevice);
  transfer.upload(std::as_bytes(std::span(list)), *tasks_);
  const std::uint32_t smoothing = smoothing_ ? smoothing_->dispatches() : 0;
  commands_.emplace(gpu, "gradient", std::max(1U, smoothing + static_cast<std::uint32_t>(ranges_.size())));
}

RunCost ResidentGradient::run() {
  return costOf([&] {
    if (smoothing_) smoothing_->plan();
    commands_->begin();
    if (smoothing_) smoothing_->record(*commands_);
    pass_->record(*commands_, *tasks_, ranges_, {});
    commands_->run();
    if (smoothing_) smoothing_->settle();
  });
}

double ResidentGradient::movedBytes() const {
  const std::size_t fields = smoothing_ ? 2 : 1;
  const double gradient = static_cast<double>(store_.brickCount()) * kBrickVoxels *
                          static_cast<double>(fields * sizeof(float) + store_.format().bytesAVoxel());
  return gradient + (smoothing_ ? smoothing_->movedBytes() : 0);
}

std::vector<Sample> ResidentGradient::at(std::span<const Vec3i> voxels) const {
  std::vector<Sample> samples(voxels.size());
  std::vector<std::byte> bytes;
  const std::size_t sample_bytes = store_.format().bytesAVoxel();
  for (std::uint32_t slab = 0; slab < store_.slabCount(); ++slab) {
    bytes.resize(store_.slab(slab).bytes());
    transfer_.download(store_.slab(slab), bytes);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      const Vec3i brick = voxels[i] / kBrickSize, in_brick = voxels[i] - brick * kBrickSize;
      const SampleStore::Place place = store_.place(pool_.grid().index(brick));
      if (place.slab != slab) continue;
      const std::size_t voxel =
          (static_cast<std::size_t>(in_brick.z()) * kBrickSize + in_brick.y()) * kBrickSize + in_brick.x();
      samples[i] =
          sampleIn(bytes.data() + (std::size_t{place.slot} * kBrickVoxels + voxel) * sample_bytes, store_.format());
    }
  }
  return samples;
}

SampleFormat halvesFor(const Volume& volume) {
  const auto isovalue = static_cast<float>(volume.facts().declared_isovalue.value_or(0));
  return halfSamples(isovalue, volume.minimum(), volume.maximum(), volume.lattice().spacing_m);
}

}  // namespace palpate
