// SPDX-License-Identifier: Apache-2.0
#include "apps/filter/filter_job.hpp"

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/convert/convert_job.hpp"
#include "apps/load/load_and_tell.hpp"
#include "base/atomic_file.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/field/few_values.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/pool_volume.hpp"

namespace palpate {
void checkIsovalueIsUsed(std::span<const FilterSpec> chain, const std::string& text) {
  if (hasDistance(chain)) return;
  throw Error(Error::Code::kBadInput, "--iso", fmt::format("no filter of \"{}\" has a use for an isovalue", text),
              "leave it out, or add a distance");
}

namespace {

// Where the surface is before the filters, if that is a fact of the volume: told by its file or phantom, or the one
// that `palpate touch` takes of a mask. A filter blurs its two values, and the result would be given another one.
std::optional<double> knownSurface(const Volume& volume) {
  const VolumeFacts& facts = volume.facts();
  if (facts.kept_isovalue) return facts.kept_isovalue;
  if (facts.declared_isovalue) return facts.declared_isovalue;
  if (!(volume.minimum() < volume.maximum())) return {};
  const auto few = fewValuesOf(volume, 0.5 * (double{volume.minimum()} + double{volume.maximum()}));
  return few && few->values.size() == 2 ? std::optional(defaultIsovalue(volume)) : std::nullopt;
}

}  // namespace

FilterResult filterFile(const FilterRequest& request, Progress& progress) {
  const Stopwatch watch;
  const std::vector<FilterSpec> chain = filterChain(request.filter);
  if (!isVolumeFileName(request.out)) {
    throw Error(Error::Code::kBadInput, request.out, "its suffix names no format that can be written",
                fmt::format("use {}", volumeFileSuffixes()));
  }
  if (request.isovalue) checkIsovalueIsUsed(chain, request.filter);
  checkNotInput(request.in, request.out);
  AtomicFile file(
      request.out,
      Rights::kPrivate);  // opened before the long work, so that a folder without write permission is refused at once
  progress.stage("loading " + request.in);
  const Volume volume = loadAndTell(request.in, progress);
  std::optional<float> isovalue;
  if (hasDistance(chain)) {
    if (request.isovalue) checkIsovalue(volume, *request.isovalue);
    isovalue = static_cast<float>(request.isovalue ? *request.isovalue : defaultIsovalue(volume));
  }
  std::vector<FilterStep> steps = lowerFilters(chain, volume.lattice().spacing_m, isovalue);
  throwIfInterrupted("palpate filter");

  FilterResult result;
  result.size = volume.size();
  result.steps = steps.size();
  result.reach = totalReach(steps);
  progress.stage("filtering on Vulkan");
  gpu::Gpu gpu({.name = request.gpu});
  result.device = gpu.info().name;
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  result.bricks = pool.brickCount();
  result.stored_before = result.stored_after = pool.storedBricks();
  const Stopwatch filtering;
  const auto filters = filteredBy(gpu, transfer, pool, std::move(steps), [&](double done) {
    progress.fraction(done);
    throwIfInterrupted("palpate filter");
  });
  if (filters) result.stored_after = filters->result().storedBricks();
  result.filter_s = filtering.seconds();
  progress.stage("bringing the result back");
  VolumeFacts facts = volume.facts();
  const std::optional<double> known = knownSurface(volume);
  if (known || isovalue) facts.kept_isovalue = isovalueAfter(chain, known ? static_cast<float>(*known) : *isovalue);
  result.surface = facts.kept_isovalue;
  const Volume filtered = volumeOf(filters ? filters->result() : pool, transfer, facts);
  result.lowest = filtered.minimum();
  result.highest = filtered.maximum();
  progress.stage("writing " + request.out);
  writeVolume(filtered, request.out, std::nullopt, [&](std::string_view bytes) {
    throwIfInterrupted("palpate filter");
    result.bytes += bytes.size();
    file.write(bytes);
  });
  file.commit();
  progress.done();
  result.seconds = watch.seconds();
  return result;
}

std::string filterWords(const FilterRequest& request, const FilterResult& result) {
  const std::string passes =
      result.steps == 0
          ? "no pass, since no size reaches a neighbouring voxel: densities are as they were"
          : fmt::format("{} pass{} reaching {} x {} x {} voxels", result.steps, result.steps == 1 ? "" : "es",
                        result.reach.x(), result.reach.y(), result.reach.z());
  const std::string surface = result.surface ? surfaceWords(request.out, *result.surface) : "";
  return fmt::format(
      "{}: {} x {} x {} voxels, densities {:g} to {:g}, {}\n"
      "{}: {}, {} of {} bricks stored before and {} after; {:.3f} s filtering, {:.2f} s in all\n{}",
      request.out, result.size.x(), result.size.y(), result.size.z(), result.lowest, result.highest,
      bytesInWords(result.bytes), result.device, passes, result.stored_before, result.bricks, result.stored_after,
      result.filter_s, result.seconds, surface);
}

}  // namespace palpate
