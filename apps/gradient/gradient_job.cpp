// SPDX-License-Identifier: Apache-2.0
#include "apps/gradient/gradient_job.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/load/load_and_tell.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/bricks/brick_reach.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/vector_file.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace {

constexpr const char* kWork = "palpate gradient";

void checkRequest(const GradientRequest& request) {
  if (!request.out.ends_with(".vdb")) {
    throw Error(Error::Code::kBadInput, request.out, "vectors are written as OpenVDB only",
                "give a name like gradient.vdb");
  }
  if (request.all && request.isovalue) {
    throw Error(Error::Code::kBadInput, "--iso", "all bricks are written, whatever the isosurface",
                "leave one of --iso and --all out");
  }
  checkNotInput(request.in, request.out);
}

// The volume on the device, and the gradients of some of its bricks, which are copied into the file brick by brick.
class Computed {
 public:
  Computed(const Volume& volume, const GradientRequest& request, GradientResult& result, Progress& progress)
      : gpu_(gpu::GpuRequest{.name = request.gpu}), transfer_(gpu_), pool_(gpu_, transfer_, volume) {
    result.device = gpu_.info().name;
    result.bricks = pool_.brickCount();
    const Stopwatch watch;
    const GradientOperator gradient_operator = gradientOperator(request.gradient);
    const auto tell = [&](double done) {
      progress.fraction(done);
      throwIfInterrupted(kWork);
    };
    if (!gradient_operator.smoothing.empty()) progress.stage("smoothing");
    const auto smoothing =
        filteredBy(gpu_, transfer_, pool_, lowerFilters(gradient_operator.smoothing, pool_.lattice().spacing_m), tell);
    progress.stage("gradients");
    store_.emplace(gpu_, pool_.brickCount(), chosenBricks(volume, request, result), pool_.budget());
    throwIfInterrupted(kWork);
    GradientPass(gpu_, transfer_, pool_, *store_, gradient_operator, smoothing ? &smoothing->result() : nullptr)
        .run(tell);
    result.written = store_->brickCount();
    result.gradient_s = watch.seconds();
  }

  void copyTo(VectorFile& file, Progress& progress) {
    progress.stage("copying");
    const BrickGrid grid = pool_.grid();
    std::vector<Sample> samples;
    std::vector<Eigen::Vector3f> gradients(kBrickVoxels);
    std::size_t done = 0;
    std::size_t loaded_slab = store_->slabCount();
    for (const std::uint32_t brick : store_->bricks()) {  // slots were given in this order, so slabs come one by one
      const SampleStore::Place place = store_->place(brick);
      if (place.slab != loaded_slab) {
        loaded_slab = place.slab;
        samples.resize(store_->slab(place.slab).bytes() / sizeof(Sample));
        transfer_.download(store_->slab(place.slab), std::as_writable_bytes(std::span(samples)));
      }
      const Sample* from = samples.data() + std::size_t{place.slot} * kBrickVoxels;
      std::transform(from, from + kBrickVoxels, gradients.begin(),
                     [](const Sample& s) { return Eigen::Vector3f(s.gradient_i, s.gradient_j, s.gradient_k); });
      file.setBrick(grid.brick(brick), gradients);
      if (++done % 256 != 0) continue;
      progress.fraction(static_cast<double>(done) / static_cast<double>(store_->brickCount()));
      throwIfInterrupted(kWork);
    }
  }

 private:
  std::vector<std::uint32_t> chosenBricks(const Volume& volume, const GradientRequest& request,
                                          GradientResult& result) {
    if (request.all) return allBricks(pool_.grid());
    result.isovalue = request.isovalue ? *request.isovalue : defaultIsovalue(volume);
    checkIsovalue(volume, result.isovalue);
    BrickBoundsPass bounds(gpu_, pool_);
    bounds.run();
    return activeBricks(bounds.read(transfer_), pool_.grid(), static_cast<float>(result.isovalue));
  }

  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickPool pool_;
  std::optional<SampleStore> store_;
};

}  // namespace

GradientResult gradientFile(const GradientRequest& request, Progress& progress) {
  const Stopwatch watch;
  checkRequest(request);
  (void)gradientOperator(request.gradient);        // refuses an invalid operator before the long work
  AtomicFile file(request.out, Rights::kPrivate);  // and a folder without write permission
  progress.stage("loading " + request.in);
  const Volume volume = loadAndTell(request.in, progress);
  throwIfInterrupted(kWork);
  GradientResult result;
  const std::unique_ptr<VectorFile> vectors = makeVectorFile(volume.size(), volume.lattice(), request.out);
  Computed(volume, request, result, progress).copyTo(*vectors, progress);
  progress.stage("writing " + request.out);
  vectors->write([&](std::string_view bytes) {
    throwIfInterrupted(kWork);
    result.bytes += bytes.size();
    file.write(bytes);
  });
  file.commit();
  progress.done();
  result.seconds = watch.seconds();
  return result;
}

std::string gradientWords(const GradientRequest& request, const GradientResult& result) {
  const std::string which = request.all ? std::string() : fmt::format(", isovalue {:g}", result.isovalue);
  return fmt::format("{}: {} gradient of {} of {} bricks{}, {}; {:.3f} s on {}, {:.2f} s in all", request.out,
                     request.gradient, result.written, result.bricks, which, bytesInWords(result.bytes),
                     result.gradient_s, result.device, result.seconds);
}

}  // namespace palpate
