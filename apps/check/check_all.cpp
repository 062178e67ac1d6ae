// SPDX-License-Identifier: Apache-2.0
#include "apps/check/check_all.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "apps/check/edit_check.hpp"
#include "apps/check/filter_check.hpp"
#include "apps/check/gradient_check.hpp"
#include "base/error.hpp"
#include "engine/field/statistics.hpp"
#include "engine/phantoms/phantom_spec.hpp"

namespace palpate {
namespace {

// The volume's default isovalue; empty if it has no surface.
std::optional<double> isovalueOf(const Volume& volume) {
  if (volume.minimum() == volume.maximum()) return std::nullopt;
  const double isovalue = defaultIsovalue(volume);
  return partsVolume(volume, isovalue) ? isovalue : 0.5 * volume.minimum() + 0.5 * volume.maximum();
}

// The progress of one part as progress of the whole.
std::function<void(double)> partOf(const std::function<void(double)>& progress, double first, double last) {
  return [&progress, first, last](double done) { progress(first + (last - first) * done); };
}

std::vector<std::string> scans() {
  std::vector<std::string> names;
  const char* folder = std::getenv("PALPATE_DATA");
  std::error_code failed;
  if (folder == nullptr) return names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    const std::string name = entry.path().string();
    if (name.ends_with(".nrrd") || name.ends_with(".nii.gz")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void append(std::vector<Check>& to, std::vector<Check> from) {
  for (Check& check : from) to.push_back(std::move(check));
}

void checkVolume(const Volume& volume, const CheckAllRequest& request, const std::function<void(double)>& progress,
                 CheckAll& all) {
  const std::optional<double> isovalue = isovalueOf(volume);
  append(all.checks, checkGradients(volume, request.gpu, partOf(progress, 0, 0.3)));
  FilterCheckRequest filters{request.gpu, checkedFilters(volume, request.quick), std::nullopt};
  if (isovalue) {
    filters.isovalue = static_cast<float>(*isovalue);
  } else {
    dropDistances(filters.chains);
    all.left_out.push_back(volume.facts().source + ": distances and edits, since it has no surface");
  }
  const bool is_thin = volume.size().minCoeff() < 2;
  if (isovalue && is_thin) {
    all.left_out.push_back(volume.facts().source + ": edits, since a volume one voxel thick is not touched");
  }
  const bool with_edits = isovalue && !is_thin;
  append(all.checks, checkFilters(volume, filters, partOf(progress, 0.3, with_edits ? 0.8 : 1)));
  if (!with_edits) return;
  all.checks.push_back(
      checkEdits(volume, {request.gpu, request.quick ? 20 : 100, request.seed, isovalue}, partOf(progress, 0.8, 1)));
}

}  // namespace

std::vector<std::string> checkedVolumes(bool quick) {
  std::vector<std::string> volumes = {"phantom:random?size=19x17x21"};
  if (quick) {
    volumes.emplace_back("phantom:knot?size=21x19x26&spacing=0.3x0.7x1.1mm&noise=0.05");
    volumes.emplace_back("phantom:random?size=1x17x9&seed=2");
    return volumes;
  }
  for (const char* size : {"1x19x11", "17x1x9", "9x18x1", "1", "2", "8x16x24"}) {
    volumes.push_back(fmt::format("phantom:random?size={}&seed={}", size, volumes.size() + 1));
  }
  for (const PhantomKind& kind : phantomKinds()) {
    if (kind.name == "random") continue;
    volumes.push_back(fmt::format("phantom:{}?size=29x25x34&spacing=0.3x0.7x1.1mm&noise=0.05", kind.name));
  }
  for (const std::string& scan : scans()) volumes.push_back(scan);
  return volumes;
}

Volume cropped(Volume volume, int most) {
  const Vec3i size = volume.size().cwiseMin(std::max(most, 2));
  if (size == volume.size()) return volume;
  const Vec3i first = (volume.size() - size) / 2;
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(size.prod()));
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) values.push_back(volume.value(first + Vec3i(i, j, k)));
    }
  }
  Lattice lattice = volume.lattice();
  lattice.origin_W = lattice.toWorld(first.cast<double>());
  VolumeFacts facts = volume.facts();
  facts.source = fmt::format("{} (its middle {} x {} x {} voxels)", facts.source, size.x(), size.y(), size.z());
  return Volume::fromDense(size, lattice, values, facts);
}

std::vector<Check> checkGradients(const Volume& volume, const std::string& gpu,
                                  const std::function<void(double)>& progress) {
  std::vector<std::string> operators;
  for (const GradientKind& kind : gradientKinds()) {
    operators.push_back(kind.parameter.empty() ? std::string(kind.name) : std::string(kind.name) + ":1.2");
  }
  const std::optional<double> isovalue = isovalueOf(volume);
  std::vector<Check> checks;
  for (const bool half : {false, true}) {
    if (half && !isovalue) continue;
    for (const std::string& name : operators) {
      const double parts = 2 * static_cast<double>(operators.size());
      const auto done = static_cast<double>(checks.size());
      GradientCheckRequest request{gpu, gradientOperator(name), {}};
      if (half) {
        request.format =
            halfSamples(static_cast<float>(*isovalue), volume.minimum(), volume.maximum(), volume.lattice().spacing_m);
      }
      checks.push_back(checkGradient(volume, request, partOf(progress, done / parts, (done + 1) / parts)));
      checks.back().what = name + (half ? ", halves" : ", floats");
    }
  }
  return checks;
}

CheckAll checkAll(const CheckAllRequest& request, const std::function<void(const std::string&)>& stage,
                  const std::function<void(double)>& progress, const std::function<Volume(const std::string&)>& load) {
  CheckAll all;
  if (!request.volume.empty()) {
    stage("checking " + request.volume);
    Volume volume = load(request.volume);
    checkVolume(request.crop > 0 ? cropped(std::move(volume), request.crop) : std::move(volume), request, progress,
                all);
    return all;
  }
  for (const std::string& name : checkedVolumes(request.quick)) {
    stage("checking " + name);
    checkVolume(cropped(load(name), request.crop > 0 ? request.crop : kScanCrop), request, progress, all);
  }
  if (!request.quick && scans().empty()) {
    all.left_out.emplace_back("scans, since the environment's PALPATE_DATA names no folder that holds any");
  }
  return all;
}

}  // namespace palpate
