// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/field_bench.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/interrupt.hpp"
#include "base/quantile.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace {

constexpr const char* kOwn = "Palpate";
constexpr const char* kCopy = "copy";
constexpr double kNoise = 0.05;  // standard deviation, as a share of the phantom's contrast

// The result of one entrant's turns at a job, for a row.
struct FieldRow {
  std::string job, volume;
  std::int64_t voxels, threads, seed;
  const TurnsOutcome* of;
  const TurnsOutcome* own;  // Palpate's
  double moved_bytes, copy_bytes_per_ms;

  [[nodiscard]] double wall_ms(double q) const {
    std::vector<double> sorted = of->wall_ms;
    std::sort(sorted.begin(), sorted.end());
    return quantile(sorted, q);
  }
  [[nodiscard]] double cpu_ms() const { return median(of->cpu_ms); }
};

const Columns<FieldRow> kWhoColumns = {{"job", &FieldRow::job},
                                       {"volume", &FieldRow::volume},
                                       {"voxels", &FieldRow::voxels},
                                       {"library", [](const FieldRow& row) { return row.of->library; }},
                                       {"way", [](const FieldRow& row) { return row.of->way; }}};
const Columns<FieldRow> kTimesColumns = {
    {"threads_allowed", &FieldRow::threads},
    {"rounds", [](const FieldRow& row) { return static_cast<std::int64_t>(row.of->wall_ms.size()); }, {"runs", ""}},
    {"median_ms", [](const FieldRow& row) { return row.wall_ms(0.5); }, {"median ms", "", 1}},
    {"min_ms", [](const FieldRow& row) { return row.wall_ms(0); }},
    {"lower_quartile_ms", [](const FieldRow& row) { return row.wall_ms(0.25); }, {"1st quart", "", 1}},
    {"upper_quartile_ms", [](const FieldRow& row) { return row.wall_ms(0.75); }, {"3rd quart", "", 1}},
    {"cpu_median_ms", [](const FieldRow& row) { return row.cpu_ms(); }, {"cpu ms", "", 1}},
    {"processors_busy", [](const FieldRow& row) { return row.cpu_ms() / row.wall_ms(0.5); }}};
const Columns<FieldRow> kMovedColumns = {
    {"moved_MB", [](const FieldRow& row) { return row.moved_bytes * 1e-6; }},
    {"moved_GB_per_s", [](const FieldRow& row) { return row.moved_bytes / row.wall_ms(0.5) * 1e-6; }},
    {"share_of_copy",
     [](const FieldRow& row) { return row.moved_bytes / row.wall_ms(0.5) / row.copy_bytes_per_ms; },
     {"of copy", "", 3}}};
const Columns<FieldRow> kPaceColumns = {
    {"ns_per_voxel",
     [](const FieldRow& row) { return 1e6 * row.wall_ms(0.5) / static_cast<double>(row.voxels); },
     {"ns/voxel", "", 2}}};
const Columns<FieldRow> kAgainstColumns = {
    {"palpate_over_this",
     [](const FieldRow& row) { return median(row.own->wall_ms) / row.wall_ms(0.5); },
     {"Palpate/this", "", 2}},
    {"palpate_over_this_cpu",
     [](const FieldRow& row) { return row.cpu_ms() > 0 ? median(row.own->cpu_ms) / row.cpu_ms() : std::nan(""); },
     {"by cpu", "", 2}}};

void addRow(BenchResult& result, const FieldRow& of) {
  const bool measured = !of.of->wall_ms.empty();
  BenchRow& row = result.rows.emplace_back(BenchRow{{"part", measured ? "run" : "left out"}});
  addFigures(row, kWhoColumns, of);
  if (!measured) {
    row.emplace_back("why", of.of->left_out);
    return;
  }
  addFigures(row, kTimesColumns, of);
  if (of.moved_bytes > 0) addFigures(row, kMovedColumns, of);
  if (of.of->library != kCopy) addFigures(row, kPaceColumns, of);
  if (of.of->library != kCopy && !of.own->wall_ms.empty()) addFigures(row, kAgainstColumns, of);
  row.emplace_back("seed", of.seed);
}

// Library and way, and for a row without figures the reason.
BenchFigure whoInTable(const BenchRow& row) {
  const std::string who = fmt::format("{:<8} {}", textOf(row, "library"), textOf(row, "way"));
  return textOf(row, "part") == "run" ? who : fmt::format("{:<73} left out: {}", who, textOf(row, "why"));
}

BenchFigure movedInTable(const BenchRow& row) {
  constexpr double kMiBPerMB = 1e6 / (1 << 20);
  if (findFigure(row, "moved_MB") == nullptr) return "";
  return kMiBPerMB * figureOf(row, "moved_MB");
}

LogCharts fieldCharts(const BenchResult& result, const std::string& title, const std::vector<std::string>& jobs) {
  std::vector<ChartPanel> panels;
  for (const std::string& job : jobs) {
    for (const BenchRow* row : rowsOf(result, "run", {{"job", job}})) {
      if (findFigure(*row, "ns_per_voxel") == nullptr) continue;
      const double voxels = figureOf(*row, "voxels"), ns = figureOf(*row, "ns_per_voxel");
      const std::string library = textOf(*row, "library");
      const BenchRows ways = rowsOf(result, "run", {{"job", job}, {"library", library}, {"voxels", voxels}});
      const auto faster = [&](const BenchRow* way) { return figureOf(*way, "ns_per_voxel") < ns; };
      if (std::any_of(ways.begin(), ways.end(), faster)) continue;
      addPoint(panels, {job, "edge [voxel]", "time [ns a voxel]", {}}, library, {std::cbrt(voxels), ns});
    }
  }
  return {{title, panels, ChartMarks::kPoints}};
}

}  // namespace

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
  result_ = beginBench(bench, fmt::format("{}, {}", gpu_.info().name, gpu_.info().driver));
  for (const MissingRival& missing : python_.missing()) {
    if (!missing.job.empty()) continue;  // pictures
    result_.note(fmt::format("no comparison with {}: {}", missing.library, missing.why));
  }
}

void FieldBench::open(const std::string& name, Volume volume) {
  name_ = name;
  pool_.reset();
  openvdb_.reset();  // its grid is as large as the volume
  volume_.emplace(std::move(volume));
  throwIfInterrupted("palpate bench " + result_.bench);
  pool_.emplace(gpu_, transfer_, *volume_);
  dense_ = volume_->toDense();
  field_ = {volume_->size(), volume_->lattice().spacing_m, dense_};
  openvdb_.emplace(field_, threads_);
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
  append("OpenVDB", [&] { return openvdb_->rivalsOf(job); });
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
    addRow(result_, {job, name_, static_cast<std::int64_t>(field_.densities.size()), std::int64_t{threads_},
                     static_cast<std::int64_t>(request_.seed), &outcomes[n], &outcomes[0], moved, copy_bytes_per_ms});
  }
}

void FieldBench::promise(const std::string& job, const std::string& name, const std::string& library, double bound) {
  const std::string words = fmt::format("{}, {}: Palpate / {} [-]", job, name, library);
  const BenchRow like = {{"job", job}, {"volume", name}, {"library", library}};
  const BenchRows rows = rowsOf(result_, "run", like);
  const auto compared = [](const BenchRow* row) { return findFigure(*row, "palpate_over_this") != nullptr; };
  if (rows.empty() || !std::all_of(rows.begin(), rows.end(), compared)) {
    result_.note(fmt::format("no target '{}': one of the two was not measured", words));
  } else {  // the largest ratio is that to the library's fastest way
    palpate::promise(result_, {words, bound, "run", like, {"palpate_over_this"}, largestOf});
  }
}

void FieldBench::promise(const std::vector<FieldPromise>& promises, const std::string& words) {
  bool any = false;
  for (const auto& [job, library, size, bound] : promises) {
    if (std::find(request_.sizes.begin(), request_.sizes.end(), size) == request_.sizes.end()) continue;
    promise(job, noisyName(size), library, bound);
    any = true;
  }
  if (!any) result_.note(fmt::format("{}: {} was left out", words, noisyName(promises.front().size)));
}

std::string fieldTable(const BenchResult& result) {
  const auto title = [](const BenchRow& row) {
    return fmt::format("{}, {}", textOf(row, "job"), textOf(row, "volume"));
  };
  return tableText(result, {{"run", "left out"},
                            joined(TableColumns{{"", whoInTable, {"", ""}}}, shown(kTimesColumns), shown(kPaceColumns),
                                   TableColumns{{"", movedInTable, {"moved MiB", "", 1}}}, shown(kMovedColumns),
                                   shown(kAgainstColumns)),
                            title});
}

LogCharts filterCharts(const BenchResult& result) {
  return fieldCharts(result, "Filters", {"gaussian:1.5", "median:1", "close:1", "diffuse:5:kappa=200"});
}

LogCharts gradientCharts(const BenchResult& result) {
  return fieldCharts(result, "Gradients",
                     {"gradient central", "gradient sobel", "gradient central4", "gradient gaussian:1.5"});
}

}  // namespace palpate
