// SPDX-License-Identifier: Apache-2.0
#include "apps/check/filter_check.hpp"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "apps/check/distance_bounds.hpp"
#include "apps/check/rounding_bound.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"
#include "engine/field/statistics.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/pool_volume.hpp"
#include "engine/reference/filter.hpp"

namespace palpate {
namespace {

using reference::DenseField;

DenseField downloaded(const BrickPool& pool, gpu::Transfer& transfer, const DenseField& like) {
  return {like.size, like.lattice, densitiesOf(pool, transfer)};
}

// Compares all voxels. `step`: the step that gives the bound; none if equal bits are promised.
void compareFields(Check& check, const DenseField& gpu, const DenseField& cpu, const DenseField& before,
                   const FilterStep* step, const std::function<void(double)>& progress) {
  for (int k = 0; k < cpu.size.z(); ++k) {
    for (int j = 0; j < cpu.size.y(); ++j) {
      for (int i = 0; i < cpu.size.x(); ++i) {
        const float got = gpu.at(i, j, k);
        const float wanted = cpu.at(i, j, k);
        if (step == nullptr) {
          check.compare({i, j, k}, "density", got, wanted);
        } else {
          check.compareWithin({i, j, k}, "density", got, wanted, roundingBound(before, {i, j, k}, *step, wanted));
        }
      }
    }
    progress(static_cast<double>(k + 1) / cpu.size.z());
  }
}

// The steps that one check compares: one step, or all steps of a distance.
std::vector<std::vector<FilterStep>> grouped(const std::vector<FilterStep>& steps) {
  std::vector<std::vector<FilterStep>> groups;
  for (auto step = steps.begin(); step != steps.end();) {
    const std::ptrdiff_t count = step->kind == StepKind::kDistanceSeed ? kDistanceSteps : 1;
    groups.emplace_back(step, step + count);
    step += count;
  }
  return groups;
}

bool isDistance(const std::vector<FilterStep>& group) {
  return group[0].kind == StepKind::kDistanceSeed;
}

// The number of checks of a chain: one for each group, another for each distance (against brute force), and one for the
// whole chain.
std::size_t checksOf(const std::vector<std::vector<FilterStep>>& groups) {
  const auto distances = static_cast<std::size_t>(std::count_if(groups.begin(), groups.end(), isDistance));
  return groups.size() + distances + (groups.size() < 2 ? 0 : 1);
}

class Checker {
 public:
  Checker(const Volume& volume, const DenseField& field, const FilterCheckRequest& request)
      : gpu_({.name = request.gpu}),
        transfer_(gpu_),
        pool_(gpu_, transfer_, volume),
        source_(volume.facts().source),
        field_(field) {}

  // `progress` gets the number of checks done, with the fraction of the current one.
  [[nodiscard]] std::vector<Check> check(const std::string& chain, const std::vector<FilterStep>& steps,
                                         const std::function<void(double)>& progress) {
    std::vector<Check> checks;
    // Of a check the GPU, the twin and the comparison; the twin takes longest, or a bound that is derived by voxel.
    const auto part = [&](double first, double last) {
      return [&progress, first = static_cast<double>(checks.size()) + first, length = last - first](double done) {
        progress(first + length * done);
      };
    };
    const auto groups = grouped(steps);
    DenseField before = field_;
    DenseField stepwise = field_;
    std::unique_ptr<FilterChain> last;  // holds what the next step reads
    for (std::size_t g = 0; g < groups.size(); ++g) {
      progress(static_cast<double>(checks.size()));
      const FilterStep& step = groups[g][0];
      Check check = named(chain, groups.size() == 1 ? "" : fmt::format("step {} of {}", g + 1, groups.size()));
      auto next = std::make_unique<FilterChain>(gpu_, transfer_, last ? last->result() : pool_, groups[g]);
      const Stopwatch gpu_watch;
      next->run(part(0, 0.1));
      check.gpu_seconds = gpu_watch.seconds();
      const Stopwatch cpu_watch;
      const DenseField cpu = reference::applyFilters(before, groups[g], part(0.1, 0.7));
      check.cpu_seconds = cpu_watch.seconds();
      stepwise = downloaded(next->result(), transfer_, field_);
      if (hasExponential(step)) check.reason = boundReason(step);
      compareFields(check, stepwise, cpu, before, hasExponential(step) ? &step : nullptr, part(0.7, 1));
      checks.push_back(std::move(check));
      if (isDistance(groups[g])) {
        checks.push_back(heldToVoxelsAcross(chain, stepwise, before, groups[g], part(0, 1)));
      }
      before = stepwise;
      last = std::move(next);
    }
    if (groups.size() < 2) return checks;
    // The chain goes back and forth between scratch pools; each step alone did not.
    Check whole = named(chain, "chain against its steps");
    FilterChain all(gpu_, transfer_, pool_, steps);
    const Stopwatch gpu_watch;
    all.run(part(0, 0.7));
    whole.gpu_seconds = gpu_watch.seconds();
    compareFields(whole, downloaded(all.result(), transfer_, field_), stepwise, field_, nullptr, part(0.7, 1));
    checks.push_back(std::move(whole));
    return checks;
  }

 private:
  [[nodiscard]] Check heldToVoxelsAcross(const std::string& chain, const DenseField& distance,
                                         const DenseField& densities, const std::vector<FilterStep>& steps,
                                         const std::function<void(double)>& progress) const {
    Check check = named(chain, "");
    check.name = "distance";
    check.reason =
        "distance: "
        "on its voxel's side, no farther than the nearest voxel across, and no nearer than that less a diagonal";
    const Stopwatch watch;
    compareWithNearestAcross(check, distance, densities, steps, progress);
    check.cpu_seconds = watch.seconds();
    return check;
  }

  [[nodiscard]] Check named(const std::string& what, const std::string& part) const {
    Check check;
    check.name = "filter";
    check.what = what;
    check.part = part;
    check.volume = source_;
    check.finite = true;
    check.device = gpu_.info().name;
    return check;
  }

  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickPool pool_;
  std::string source_;
  const DenseField& field_;
};

}  // namespace

std::vector<std::string> checkedFilters(const Volume& volume, bool short_list) {
  const double contrast = static_cast<double>(volume.maximum()) - volume.minimum();
  const double height = std::clamp(contrast, 1e-20, 1e30);
  const double smallest_mm = volume.lattice().spacing_m.minCoeff() * kMillimetresPerMetre;
  std::vector<std::string> chains = {"gaussian:1.5",
                                     fmt::format("bilateral:1:range={:.3g}", height / 10),
                                     fmt::format("diffuse:2:kappa={:.3g}", height / 10 / smallest_mm),
                                     "distance:3",
                                     "median:1",
                                     "dilate:2",
                                     "erode:1.5:shape=ball",
                                     "open:1",
                                     "close:2:shape=ball"};
  if (short_list) return chains;
  chains.insert(chains.end(),
                {fmt::format("gaussian:{:.6g}mm:truncate=2:border=mirror", 1.7 * smallest_mm),
                 fmt::format("bilateral:{:.6g}mm:range={:.3g}:border=mirror", 1.2 * smallest_mm, height / 3),
                 fmt::format("diffuse:2:kappa={:.3g}:g=exp", height / 20 / smallest_mm), "distance:6",
                 "median:2:border=mirror", "dilate:2.2:shape=ball:border=mirror", "erode:3:border=mirror",
                 fmt::format("open:{:.6g}mm:shape=ball:border=mirror", 2.1 * smallest_mm), "close:2:border=mirror",
                 "median:1 close:1 gaussian:0.8"});
  return chains;
}

std::vector<Check> checkFilters(const Volume& volume, const FilterCheckRequest& request,
                                const std::function<void(double)>& progress) {
  return checkFilters(volume, reference::denseField(volume), request, progress);
}

void dropDistances(std::vector<std::string>& chains) {
  std::erase_if(chains, [](const std::string& chain) { return hasDistance(filterChain(chain)); });
}

std::vector<Check> checkFilters(const Volume& volume, const DenseField& field, const FilterCheckRequest& request,
                                const std::function<void(double)>& progress) {
  const std::vector<std::string> chains = request.chains.empty() ? checkedFilters(volume) : request.chains;
  std::vector<std::vector<FilterStep>> lowered;
  std::size_t parts = 0;
  for (const std::string& chain : chains) {
    const std::vector<FilterSpec> filters = filterChain(chain);
    std::optional<float> isovalue = request.isovalue;
    if (hasDistance(filters) && !isovalue) isovalue = static_cast<float>(defaultIsovalue(volume));
    lowered.push_back(lowerFilters(filters, volume.lattice().spacing_m, isovalue));
    parts += checksOf(grouped(lowered.back()));
  }
  Checker checker(volume, field, request);
  std::vector<Check> checks;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const auto before = static_cast<double>(checks.size());
    const auto tell = [&](double done) { progress((before + done) / static_cast<double>(parts)); };
    for (Check& check : checker.check(chains[c], lowered[c], tell)) checks.push_back(std::move(check));
  }
  progress(1);
  return checks;
}

}  // namespace palpate
