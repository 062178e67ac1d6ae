// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/load_bench.hpp"

#include <cstdlib>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "apps/bench/log_chart.hpp"
#include "apps/bench/random.hpp"
#include "apps/bench/scratch_folder.hpp"
#include "apps/console/interrupt.hpp"
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

void addFormat(const LoadBenchRequest& request, const std::string& file, const std::string& suffix, Progress& progress,
               BenchResult& result) {
  std::vector<double> library_s, load_s;
  const auto library = [&] { library_s.push_back(secondsOf([&] { static_cast<void>(readWithLibraryAlone(file)); })); };
  const auto load = [&] {
    std::optional<Volume> volume;  // given back outside the measurement
    load_s.push_back(secondsOf([&] { volume = loadVolume(file); }));
  };
  library();  // into the system's cache
  library_s.clear();
  for (int n = 0; n < request.repetitions; ++n) {
    progress.fraction(static_cast<double>(n) / request.repetitions);
    n % 2 == 0 ? library() : load();
    n % 2 == 0 ? load() : library();
  }
  const double first_load_s = load_s.front();
  const Percentiles library_p = percentiles(library_s), load_p = percentiles(load_s);
  const double ratio = load_p.p50 / library_p.p50;
  result.rows.push_back({{"part", "load"},
                         {"format", suffix},
                         {"volume_voxel", std::int64_t{request.size}},
                         {"file_bytes", static_cast<std::int64_t>(std::filesystem::file_size(file))},
                         {"repetitions", std::int64_t{request.repetitions}},
                         {"library_median_s", library_p.p50},
                         {"library_max_s", library_p.max},
                         {"load_median_s", load_p.p50},
                         {"load_max_s", load_p.max},
                         {"load_first_s", first_load_s},
                         {"load_over_library", ratio},
                         {"seed", static_cast<std::int64_t>(request.seed)}});
  result.targets.push_back(
      {fmt::format("load / library alone, {}^3 {} [-]", request.size, suffix), ratio, kMostOverLibrary});
}

}  // namespace

LoadBenchRequest LoadBenchRequest::quick() {
  LoadBenchRequest request;
  request.size = 256;
  request.repetitions = 5;
  return request;
}

BenchResult runLoadBench(const LoadBenchRequest& request, Progress& progress) {
  BenchResult result;
  result.bench = "load";
  result.machine = machineInWords();
  for (const std::string& suffix : request.suffixes) {
    const ScratchFolder folder;
    const std::string file = (folder.path() / ("a" + suffix)).string();
    progress.stage("writing " + file);
    {
      AtomicFile out(file);
      writeVolume(randomVolume(request.size, request.seed), file, {}, [&](std::string_view bytes) {
        throwIfInterrupted(kLoadBench);
        out.write(bytes);
      });
      out.commit();
    }
    progress.stage("loading " + file);
    addFormat(request, file, suffix, progress, result);
  }
  return result;
}

std::string loadIntroduction() {
  return "A file of random floats read from the system's cache: by its format's library alone (ITK into plain memory, "
         "OpenVDB into its grid), and by Palpate into its bricks. Both in turns, in one process; medians. `first` is "
         "the first load, which meets memory that the process never had. Values that lie in a file as they lie in "
         "memory go from the file into the bricks; what is packed is unpacked first.";
}

std::string loadTable(const BenchResult& result) {
  std::string text = fmt::format("{:<8} {:>6}  {:>9} {:>9} {:>9}  {:>7}\n", "format", "voxels", "library s", "load s",
                                 "first s", "ratio");
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "load") continue;
    text +=
        fmt::format("{:<8} {:>4g}^3  {:>9.3f} {:>9.3f} {:>9.3f}  {:>7.2f}\n", textOf(row, "format"),
                    figureOf(row, "volume_voxel"), figureOf(row, "library_median_s"), figureOf(row, "load_median_s"),
                    figureOf(row, "load_first_s"), figureOf(row, "load_over_library"));
  }
  return text;
}

std::string loadChart(const BenchResult& result) {
  ChartPanel panel{"median times", "library alone [s]", "load [s]", {}};
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "load") continue;
    panel.series.push_back(
        {textOf(row, "format"), {{figureOf(row, "library_median_s"), figureOf(row, "load_median_s")}}});
  }
  return logChartSvg("Loading", {panel}, ChartMarks::kPoints);
}

}  // namespace palpate
