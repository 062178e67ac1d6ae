// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/filter_bench.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "apps/bench/resident_chain.hpp"

namespace palpate {
namespace {

// Filters that need more than a size, or a size that is usual for them.
constexpr const char* kJobs[] = {"gaussian:1.5", "bilateral:1:range=200", "diffuse:5:kappa=200", "distance:3"};

std::string jobOf(std::string_view filter) {
  for (const std::string_view job : kJobs) {
    if (job.substr(0, job.find(':')) == filter) return std::string(job);
  }
  return fmt::format("{}:1", filter);
}

std::string passes(std::size_t count) {
  return count == 1 ? "1 pass" : fmt::format("{} passes", count);
}

void measureFilter(FieldBench& bench, const std::string& job) {
  const auto isovalue = static_cast<float>(bench.volume().facts().declared_isovalue.value_or(0));
  std::vector<FilterStep> steps = lowerFilters(filterChain(job), bench.volume().lattice().spacing_m, isovalue);
  ResidentChain chain(bench.gpu(), bench.transfer(), bench.pool(), std::move(steps));
  bench.measure(job, job, {{passes(chain.passes()), chain.movedBytes(), [&] { return chain.run(); }}});
}

}  // namespace

std::vector<std::string> filterJobs() {
  std::vector<std::string> jobs;
  for (const FilterWords& filter : filterTable()) jobs.push_back(jobOf(filter.name));
  return jobs;
}

BenchResult runFilterBench(const FieldBenchRequest& request, Progress& progress) {
  FieldBench bench("filters", request, progress);
  for (const int size : request.sizes) {
    if (!bench.tryOpenNoisy(size)) continue;
    for (const std::string& job : filterJobs()) bench.attempt(job, [&] { measureFilter(bench, job); });
  }
  if (std::find(request.sizes.begin(), request.sizes.end(), kTargetSize_voxel) == request.sizes.end()) {
    bench.result().note(fmt::format("no targets: {}^3 was left out", kTargetSize_voxel));
  } else {
    const std::string name = noisyName(kTargetSize_voxel);
    bench.promise("gaussian:1.5", name, "ITK", 0.4);
    bench.promise("gaussian:1.5", name, "VTK", 0.85);
    bench.promise("median:1", name, "ITK", 0.5);
    bench.promise("median:1", name, "VTK", 0.5);
    bench.promise("close:1", name, "ITK", 0.7);
  }
  return std::move(bench.result());
}

std::string filterChart(const BenchResult& result) {
  return fieldChart(result, "Filters", {"gaussian:1.5", "median:1", "close:1", "diffuse:5:kappa=200"});
}

}  // namespace palpate
