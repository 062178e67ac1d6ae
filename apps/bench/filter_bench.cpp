// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/bench/field_bench.hpp"
#include "apps/bench/resident_chain.hpp"

namespace palpate {
namespace {

// The jobs of filters that need more parameters than a size, or a typical size.
constexpr const char* kJobs[] = {"gaussian:1.5", "bilateral:1:range=200", "diffuse:5:kappa=200", "distance:3"};

// At 64^3 fixed costs (planning, submitting) are a noticeable part of a run. Volume and results fit into the
// processor's caches, so passes over memory cost VTK nothing. Its Gaussian computes least in a pass: Palpate takes 1.04
// of its time at 128^3 already. The other bounds leave room for that.
const std::vector<FieldPromise> kPromises = {{"gaussian:1.5", "ITK", 256, 0.4}, {"gaussian:1.5", "VTK", 256, 0.85},
                                             {"median:1", "ITK", 256, 0.5},     {"median:1", "VTK", 256, 0.5},
                                             {"close:1", "ITK", 256, 0.7},      {"gaussian:1.5", "ITK", 64, 0.4},
                                             {"gaussian:1.5", "VTK", 64, 1.25}, {"median:1", "ITK", 64, 0.5},
                                             {"median:1", "VTK", 64, 0.5},      {"close:1", "ITK", 64, 0.7}};

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
  bench.promise(kPromises, "no targets");
  return std::move(bench.result());
}

}  // namespace palpate
