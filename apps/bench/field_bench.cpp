// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/field_bench.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "apps/bench/failure.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/rivals/itk_rivals.hpp"
#include "base/quantile.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace {

constexpr const char* kOwn = "Palpate";
constexpr const char* kCopy = "copy";
constexpr double kNoise = 0.05;  // standard deviation, as a share of the phantom's contrast

}  // namespace

FieldBenchRequest FieldBenchRequest::quick() {
  FieldBenchRequest request;
  request.sizes = {64};
  request.turns.most_rounds = 1;
  request.copy_bytes = std::size_t{64} << 20U;
  return request;
}

std::string noisyName(int size) {
  return fmt::format("{}^3", size);
}

FieldBench::FieldBench(const std::string& bench, const FieldBenchRequest& request, Progress& progress)
    : request_(request),
      progress_(progress),
      threads_(std::max(1U, std::thread::hardware_concurrency())),
      gpu_(gpu::GpuRequest{.name = request.gpu}),
      transfer_(gpu_),
      copy_(gpu_, request.copy_bytes, threads_),
      python_(threads_, request.python),
      turns_(request.turns) {
  result_.bench = bench;
  result_.machine = machineInWords();
  result_.vulkan_device = fmt::format("{}, {}", gpu_.info().name, gpu_.info().driver);
  for (const MissingRival& missing : python_.missing()) {
    result_.note(fmt::format("no comparison with {}: {}", missing.library, missing.why));
  }
}

void FieldBench::open(const std::string& name, Volume volume) {
  name_ = name;
  pool_.reset();
  openvdb_.reset();
  volume_.emplace(std::move(volume));
  throwIfInterrupted("palpate bench " + result_.bench);
  pool_.emplace(gpu_, transfer_, *volume_);
  dense_ = volume_->toDense();
  field_ = {volume_->size(), volume_->lattice().spacing_m, dense_};
  if (const std::optional<std::string> why = python_.load(field_)) {
    result_.note(fmt::format("no comparison with SciPy and VTK from {} on: {}", name_, *why));
  }
}

bool FieldBench::tryOpen(const std::string& name, const std::function<Volume()>& make) {
  const std::string failure = failureOf([&] { open(name, make()); });
  if (failure.empty()) return true;
  pool_.reset();
  volume_.reset();
  result_.note(fmt::format("{} was left out: {}", name, failure));
  return false;
}

bool FieldBench::tryOpenNoisy(int size) {
  progress_.stage(fmt::format("preparing {0} x {0} x {0} voxels", size));
  return tryOpen(noisyName(size), [&] {
    return loadVolume(fmt::format("phantom:knot?size={}&spacing=1mm&noise={}&seed={}", size, kNoise, request_.seed));
  });
}

void FieldBench::attempt(const std::string& what, const std::function<void()>& work) {
  const std::string failure = failureOf(work);
  if (!failure.empty()) result_.note(fmt::format("{}, {} was left out: {}", what, name_, failure));
}

std::vector<Rival> FieldBench::rivalsOf(const std::string& job) {
  std::vector<Rival> rivals;
  const auto append = [&](const char* library, const std::function<std::vector<Rival>()>& offered) {
    std::vector<Rival> more;
    const std::string failure = failureOf([&] { more = offered(); });
    if (!failure.empty()) result_.note(fmt::format("{}, {}: no comparison with {}: {}", job, name_, library, failure));
    rivals.insert(rivals.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  append("ITK", [&] { return itkRivals(job, field_, threads_); });
  append("SciPy and VTK", [&] { return python_.rivalsOf(job); });
  append("OpenVDB", [&] {
    if (!OpenVdbRivals::hasAny(job)) return std::vector<Rival>();
    if (!openvdb_) openvdb_ = std::make_unique<OpenVdbRivals>(field_, threads_);
    return openvdb_->rivalsOf(job);
  });
  return rivals;
}

void FieldBench::measure(const std::string& job, const std::string& rivals_job, const std::vector<OwnEntrant>& own) {
  progress_.stage(fmt::format("{}, {}", job, name_));
  std::vector<Contender> entrants;
  for (const OwnEntrant& one : own) entrants.push_back({kOwn, one.way, one.run, true});
  for (const Rival& rival : rivalsOf(rivals_job)) {
    entrants.push_back({rival.library, rival.way, [run = rival.run] { return run(nullptr); }, false});
  }
  entrants.push_back({kCopy, copy_.way(), [this] { return copy_.run(); }, true});
  const std::vector<TurnsOutcome> outcomes = turns_.take(job, static_cast<double>(field_.densities.size()), entrants);
  const double copy_ms = median(outcomes.back().wall_ms);
  const double copy_bytes_per_ms = copy_ms > 0 ? copy_.movedBytes() / copy_ms : std::nan("");
  for (std::size_t n = 0; n < outcomes.size(); ++n) {
    const double moved = n < own.size() ? own[n].moved_bytes : n + 1 == outcomes.size() ? copy_.movedBytes() : 0;
    addRow(job, outcomes[n], outcomes[0], moved, copy_bytes_per_ms);
  }
}

void FieldBench::addRow(const std::string& job, const TurnsOutcome& outcome, const TurnsOutcome& own,
                        double moved_bytes, double copy_bytes_per_ms) {
  const auto voxels = static_cast<double>(field_.densities.size());
  BenchRow row = {{"part", outcome.wall_ms.empty() ? "left out" : "run"},
                  {"job", job},
                  {"volume", name_},
                  {"voxels", static_cast<std::int64_t>(field_.densities.size())},
                  {"library", outcome.library},
                  {"way", outcome.way}};
  if (outcome.wall_ms.empty()) {
    row.push_back({"why", outcome.left_out});
    result_.rows.push_back(std::move(row));
    return;
  }
  std::vector<double> sorted = outcome.wall_ms;
  std::sort(sorted.begin(), sorted.end());
  const double median_ms = quantile(sorted, 0.5), cpu_ms = median(outcome.cpu_ms);
  row.push_back({"threads_allowed", std::int64_t{threads_}});
  row.push_back({"rounds", static_cast<std::int64_t>(sorted.size())});
  row.push_back({"median_ms", median_ms});
  row.push_back({"min_ms", sorted.front()});
  row.push_back({"lower_quartile_ms", quantile(sorted, 0.25)});
  row.push_back({"upper_quartile_ms", quantile(sorted, 0.75)});
  row.push_back({"cpu_median_ms", cpu_ms});
  row.push_back({"processors_busy", cpu_ms / median_ms});
  if (moved_bytes > 0) {
    row.push_back({"moved_MB", moved_bytes * 1e-6});
    row.push_back({"moved_GB_per_s", moved_bytes / median_ms * 1e-6});
    row.push_back({"share_of_copy", moved_bytes / median_ms / copy_bytes_per_ms});
  }
  if (outcome.library != kCopy) {
    row.push_back({"ns_per_voxel", 1e6 * median_ms / voxels});
    if (!own.wall_ms.empty()) {
      row.push_back({"palpate_over_this", median(own.wall_ms) / median_ms});
      row.push_back({"palpate_over_this_cpu", cpu_ms > 0 ? median(own.cpu_ms) / cpu_ms : std::nan("")});
    }
  }
  row.push_back({"seed", static_cast<std::int64_t>(request_.seed)});
  result_.rows.push_back(std::move(row));
}

void FieldBench::promise(const std::string& job, const std::string& name, const std::string& library, double bound) {
  double ratio = 0;  // to the fastest of the library
  for (const BenchRow& row : result_.rows) {
    if (textOf(row, "part") != "run" || textOf(row, "job") != job || textOf(row, "volume") != name) continue;
    if (textOf(row, "library") == library) ratio = std::max(ratio, figureOf(row, "palpate_over_this"));
  }
  const std::string words = fmt::format("{}, {}: Palpate / {} [-]", job, name, library);
  if (ratio > 0) {
    result_.targets.push_back({words, ratio, bound});
  } else {
    result_.note(fmt::format("no target '{}': one of the two was not measured", words));
  }
}

}  // namespace palpate
