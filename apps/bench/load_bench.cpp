// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/load_bench.hpp"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/bench/random.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "engine/files/library_read.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace {

constexpr const char* kLoadBench = "palpate bench load";
constexpr double kMostOverLibrary = 1.5;

Volume randomVolume(int size, std::uint64_t seed) {
  Random random(seed);
  VolumeFacts facts;
  facts.source = "random numbers";
  return Volume::fromBricks(Vec3i::Constant(size), Lattice{}, std::move(facts), [&](const Vec3i&, float* values) {
    for (int n = 0; n < kBrickVoxels; ++n) values[n] = static_cast<float>(random.uniform());
    return false;
  });
}

template <class Work>
double secondsOf(const Work& work) {
  throwIfInterrupted(kLoadBench);
  const Stopwatch watch;
  work();
  return watch.seconds();
}

struct LoadRow {
  std::string format;
  std::int64_t size, file_bytes, repetitions;
  Percentiles library_s, load_s;
  double first_load_s;
  std::int64_t seed;
};

const Columns<LoadRow>& loadColumns() {
  static const Columns<LoadRow> kColumns = {
      {"format", &LoadRow::format, {"format", ""}},
      {"volume_voxel", &LoadRow::size, {"edge", "voxel"}},
      {"file_bytes", &LoadRow::file_bytes},
      {"repetitions", &LoadRow::repetitions},
      {"library_median_s", [](const LoadRow& row) { return row.library_s.p50; }, {"library", "s", 3}},
      {"library_max_s", [](const LoadRow& row) { return row.library_s.max; }},
      {"load_median_s", [](const LoadRow& row) { return row.load_s.p50; }, {"load", "s", 3}},
      {"load_max_s", [](const LoadRow& row) { return row.load_s.max; }},
      {"load_first_s", &LoadRow::first_load_s, {"first", "s", 3}},
      {"load_over_library", [](const LoadRow& row) { return row.load_s.p50 / row.library_s.p50; }, {"ratio", "", 2}},
      {"seed", &LoadRow::seed}};
  return kColumns;
}

void addFormat(const LoadBenchRequest& request, int size, const std::string& file, const std::string& suffix,
               Progress& progress, BenchResult& result) {
  std::vector<double> library_s, load_s;
  const auto library = [&] { library_s.push_back(secondsOf([&] { static_cast<void>(readWithLibraryAlone(file)); })); };
  const auto load = [&] {
    std::optional<Volume> volume;  // freed outside the measurement
    load_s.push_back(secondsOf([&] { volume = loadVolume(file); }));
  };
  library();  // brings the file into the system's cache
  library_s.clear();
  for (int n = 0; n < request.repetitions; ++n) {
    progress.fraction(static_cast<double>(n) / request.repetitions);
    n % 2 == 0 ? library() : load();
    n % 2 == 0 ? load() : library();
  }
  BenchRow& row = result.rows.emplace_back(BenchRow{{"part", "load"}});
  addFigures(row, loadColumns(),
             {suffix, size, static_cast<std::int64_t>(std::filesystem::file_size(file)), request.repetitions,
              percentiles(library_s), percentiles(load_s), load_s.front(), static_cast<std::int64_t>(request.seed)});
  result.targets.push_back({fmt::format("load / library alone, {}^3 {} [-]", size, suffix),
                            figureOf(row, "load_over_library"), kMostOverLibrary});
}

}  // namespace

BenchResult runLoadBench(const LoadBenchRequest& request, Progress& progress) {
  BenchResult result = beginBench("load");
  for (const int size : request.sizes) {
    for (const std::string& suffix : request.suffixes) {
      const ScratchFolder folder;
      const std::string file = (folder.path() / ("a" + suffix)).string();
      progress.stage("writing " + file);
      {
        AtomicFile out(file);
        writeVolume(randomVolume(size, request.seed), file, {}, [&](std::string_view bytes) {
          throwIfInterrupted(kLoadBench);
          out.write(bytes);
        });
        out.commit();
      }
      progress.stage("loading " + file);
      addFormat(request, size, file, suffix, progress, result);
    }
  }
  return result;
}

std::string loadTable(const BenchResult& result) {
  return tableText(result, {{"load"}, shown(loadColumns())});
}

LogCharts loadCharts(const BenchResult& result) {
  ChartPanel panel{"median times", "library alone [s]", "load [s]", {}};
  for (const BenchRow* row : rowsOf(result, "load")) {
    panel.series.push_back(
        {textOf(*row, "format"), {{figureOf(*row, "library_median_s"), figureOf(*row, "load_median_s")}}});
  }
  return {{"Loading", {panel}, ChartMarks::kPoints}};
}

}  // namespace palpate
