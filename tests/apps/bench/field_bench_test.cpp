// SPDX-License-Identifier: Apache-2.0
// Short runs of bench filters and bench gradient: what they are made of, and that what is timed is the whole work. No
// time is asserted.
#include "apps/bench/field_bench.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include <gmock/gmock.h>

#include "apps/bench/copy_speed.hpp"
#include "apps/bench/head_volume.hpp"
#include "apps/bench/resident_chain.hpp"
#include "apps/rivals/scratch_folder.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/filter/filter_spec.hpp"
#include "engine/gradient/gradient_operator.hpp"

namespace palpate {
namespace field_bench_test {

using testing::HasSubstr;

constexpr int kSize = 24;
constexpr double kVoxels = kSize * kSize * kSize;

FieldBenchRequest shortRun() {
  FieldBenchRequest request = FieldBenchRequest::quick();
  request.sizes = {kSize};
  request.turns.most_rounds = 1;
  request.copy_bytes = 1U << 20U;
  request.python = {"/nowhere/python3"};
  return request;
}

std::vector<BenchRow> rowsOf(const BenchResult& result, const std::string& part, const std::string& job,
                             const std::string& library) {
  std::vector<BenchRow> rows;
  for (const BenchRow* row : rowsOf(result, part, {{"job", job}, {"library", library}})) rows.push_back(*row);
  return rows;
}

std::string notesOf(const BenchResult& result) {
  std::string notes;
  for (const BenchRow& row : result.rows) notes += textOf(row, "note") + "\n";
  return notes;
}

void expectFigures(const BenchRow& row, double moved_bytes) {
  EXPECT_EQ(figureOf(row, "voxels"), kVoxels);
  EXPECT_EQ(figureOf(row, "rounds"), 1);
  EXPECT_GT(figureOf(row, "median_ms"), 0);
  EXPECT_LE(figureOf(row, "min_ms"), figureOf(row, "median_ms"));
  EXPECT_DOUBLE_EQ(figureOf(row, "ns_per_voxel"), 1e6 * figureOf(row, "median_ms") / kVoxels);
  EXPECT_DOUBLE_EQ(figureOf(row, "moved_MB"), 1e-6 * moved_bytes);
  EXPECT_GT(figureOf(row, "share_of_copy"), 0);
}

TEST(FilterBench, HasEveryFilterOfTheTable) {
  Progress progress;
  const BenchResult result = runFilterBench(shortRun(), progress);
  EXPECT_EQ(result.bench, "filters");
  EXPECT_NE(result.vulkan_device, "none");
  ASSERT_EQ(filterJobs().size(), filterTable().size());
  for (std::size_t n = 0; n < filterTable().size(); ++n) {
    const std::string job = filterJobs()[n];
    EXPECT_EQ(job.substr(0, job.find(':')), filterTable()[n].name);
    ASSERT_EQ(rowsOf(result, "run", job, "Palpate").size(), 1U) << job;
    EXPECT_EQ(rowsOf(result, "run", job, "copy").size(), 1U) << job;
  }
  // Floats read and written once by each pass, all bricks being stored.
  expectFigures(rowsOf(result, "run", "gaussian:1.5", "Palpate")[0], 3 * 8 * kVoxels);
  expectFigures(rowsOf(result, "run", "median:1", "Palpate")[0], 8 * kVoxels);
  expectFigures(rowsOf(result, "run", "close:1", "Palpate")[0], 6 * 8 * kVoxels);
  expectFigures(rowsOf(result, "run", "diffuse:5:kappa=200", "Palpate")[0], 5 * 8 * kVoxels);
  // seed, three spreads, and an end that reads the densities too
  expectFigures(rowsOf(result, "run", "distance:3", "Palpate")[0], (4 * 8 + 12) * kVoxels);
  EXPECT_EQ(rowsOf(result, "run", "close:1", "ITK").size(), 3U);
  EXPECT_EQ(rowsOf(result, "run", "median:1", "OpenVDB").size(), 1U);
  EXPECT_TRUE(rowsOf(result, "run", "median:1", "VTK").empty());
  const BenchRow itk = rowsOf(result, "run", "median:1", "ITK").at(0);
  EXPECT_DOUBLE_EQ(figureOf(itk, "palpate_over_this"),
                   figureOf(rowsOf(result, "run", "median:1", "Palpate")[0], "median_ms") / figureOf(itk, "median_ms"));
  EXPECT_TRUE(result.targets.empty());
  EXPECT_THAT(notesOf(result), HasSubstr("no targets: 256^3 was left out"));
  EXPECT_THAT(notesOf(result), HasSubstr("no comparison with VTK: /nowhere/python3 did not start: apt-get install"));
  EXPECT_THAT(notesOf(result), HasSubstr("no comparison with SciPy"));
  EXPECT_THAT(fieldTable(result), HasSubstr("close:1, 24^3\n"));
  EXPECT_THAT(fieldTable(result), HasSubstr("GrayscaleMorphologicalClosingImageFilter, box, VHGW"));
  EXPECT_THAT(logChartSvg(filterCharts(result)), HasSubstr("median:1"));
}

TEST(GradientBench, HasEveryOperatorOfTheTable) {
  Progress progress;
  const BenchResult result = runGradientBench(shortRun(), progress);
  EXPECT_EQ(result.bench, "gradient");
  for (const GradientKind& kind : gradientKinds()) {
    const std::string job = "gradient " + std::string(kind.name) + (kind.parameter.empty() ? "" : ":1.5");
    ASSERT_EQ(rowsOf(result, "run", job, "Palpate").size(), 2U) << job;  // floats, halves
  }
  const auto central = rowsOf(result, "run", "gradient central", "Palpate");
  expectFigures(central[0], (4 + 16) * kVoxels);
  expectFigures(central[1], (4 + 8) * kVoxels);
  // three passes of smoothing; then smoothed field and densities are read
  expectFigures(rowsOf(result, "run", "gradient gaussian:1.5", "Palpate")[0], (3 * 8 + 8 + 16) * kVoxels);
  EXPECT_EQ(rowsOf(result, "run", "gradient central", "ITK").size(), 1U);
  EXPECT_EQ(rowsOf(result, "run", "gradient central", "OpenVDB").size(), 1U);
  EXPECT_TRUE(result.targets.empty());
  EXPECT_THAT(logChartSvg(gradientCharts(result)), HasSubstr("gradient sobel"));
}

TEST(FieldBench, PromisesAgainstTheFastestOfALibrary) {
  Progress progress;
  FieldBench bench("test", shortRun(), progress);
  ASSERT_TRUE(bench.tryOpenNoisy(kSize));
  EXPECT_EQ(bench.pool().storedBricks(), bench.pool().brickCount());  // dense, noise being everywhere
  bench.measure("close:1", "close:1", {{"fake", 1e6, [] { return RunCost{10, 20}; }}});
  bench.promise("close:1", noisyName(kSize), "ITK", 0.7);
  bench.promise("close:1", noisyName(kSize), "VTK", 0.7);
  double fastest_ms = 1e30;
  for (const BenchRow& row : rowsOf(bench.result(), "run", "close:1", "ITK")) {
    fastest_ms = std::min(fastest_ms, figureOf(row, "median_ms"));
  }
  ASSERT_EQ(bench.result().targets.size(), 1U);
  EXPECT_EQ(bench.result().targets[0].value, 10 / fastest_ms);
  EXPECT_EQ(bench.result().targets[0].bound, 0.7);
  EXPECT_THAT(notesOf(bench.result()), HasSubstr("no target 'close:1, 24^3: Palpate / VTK [-]'"));
}

// Five rounds of times chosen by hand, in no order: 10 to 50 ms on three processors. The second way takes 60 ms each
// time, on six. The copy's own times are measured; what moves 4e6 bytes is compared with them.
TEST(FieldBench, EveryColumnIsAsByHand) {
  Progress progress;
  FieldBenchRequest request = shortRun();
  request.turns = {.most_rounds = 5, .budget_s = 100};
  request.seed = 9;
  FieldBench bench("test", request, progress);
  ASSERT_TRUE(bench.tryOpenNoisy(kSize));
  constexpr double kWall_ms[] = {999, 30, 10, 50, 20, 40};  // the first run only warms up
  int run = 0;
  const auto varying = [&] {
    const double wall_ms = kWall_ms[run++ % 6];
    return RunCost{wall_ms, 3 * wall_ms};
  };
  const auto steady = [] { return RunCost{60, 360}; };
  const auto idle = [] { return RunCost{15, 0}; };
  bench.measure("close:1", "close:1", {{"varying", 4e6, varying}, {"steady", 8e6, steady}, {"idle", 0, idle}});
  const auto own = rowsOf(bench.result(), "run", "close:1", "Palpate");
  ASSERT_EQ(own.size(), 3U);
  const BenchRow copy = rowsOf(bench.result(), "run", "close:1", "copy").at(0);
  const double copied_bytes = 2.0 * (1U << 20U);  // read and written
  const double copy_bytes_per_ms = copied_bytes / figureOf(copy, "median_ms");
  const auto threads = std::int64_t{std::max(1U, std::thread::hardware_concurrency())};
  const auto expectRow = [](const BenchRow& row, const BenchRow& expected) {
    ASSERT_EQ(row.size(), expected.size());
    for (std::size_t n = 0; n < row.size(); ++n) {
      const auto& [key, figure] = expected[n];
      EXPECT_EQ(row[n].first, key);
      if (std::holds_alternative<double>(figure)) {
        EXPECT_DOUBLE_EQ(figureOf(row, key), std::get<double>(figure)) << key;
      } else {
        EXPECT_EQ(row[n].second, figure) << key;
      }
    }
  };
  expectRow(own[0], {{"part", "run"},
                     {"job", "close:1"},
                     {"volume", "24^3"},
                     {"voxels", std::int64_t{13824}},
                     {"library", "Palpate"},
                     {"way", "varying"},
                     {"threads_allowed", threads},
                     {"rounds", std::int64_t{5}},
                     {"median_ms", 30.0},
                     {"min_ms", 10.0},
                     {"lower_quartile_ms", 20.0},
                     {"upper_quartile_ms", 40.0},
                     {"cpu_median_ms", 90.0},
                     {"processors_busy", 3.0},
                     {"moved_MB", 4.0},
                     {"moved_GB_per_s", 4e6 / 1e9 / 0.03},
                     {"share_of_copy", 4e6 / 30 / copy_bytes_per_ms},
                     {"ns_per_voxel", 30e6 / 13824},
                     {"palpate_over_this", 1.0},
                     {"palpate_over_this_cpu", 1.0},
                     {"seed", std::int64_t{9}}});
  EXPECT_DOUBLE_EQ(figureOf(own[1], "palpate_over_this"), 30.0 / 60);
  EXPECT_DOUBLE_EQ(figureOf(own[1], "palpate_over_this_cpu"), 90.0 / 360);
  EXPECT_DOUBLE_EQ(figureOf(own[1], "processors_busy"), 6);
  EXPECT_DOUBLE_EQ(figureOf(own[1], "share_of_copy"), 8e6 / 60 / copy_bytes_per_ms);
  EXPECT_DOUBLE_EQ(figureOf(own[2], "palpate_over_this"), 30.0 / 15);
  EXPECT_TRUE(std::isnan(figureOf(own[2], "palpate_over_this_cpu")));  // no processor time was seen
  EXPECT_EQ(findFigure(own[2], "moved_MB"), nullptr);                  // nothing is said of it
  // The copy is what the share is of: no time a voxel, and no ratio.
  EXPECT_DOUBLE_EQ(figureOf(copy, "moved_MB"), 2.097152);
  EXPECT_DOUBLE_EQ(figureOf(copy, "share_of_copy"), 1);
  EXPECT_EQ(findFigure(copy, "ns_per_voxel"), nullptr);
  EXPECT_EQ(findFigure(copy, "palpate_over_this"), nullptr);
  // 4e6 bytes are 3.8 MiB.
  EXPECT_THAT(fieldTable(bench.result()),
              testing::ContainsRegex("Palpate +varying +5 +30\\.0 +20\\.0 +40\\.0 +90\\.0 +2170\\.14 +3\\.8 "));
}

// Run again and again, it leaves what a chain of its own makes, bit for bit.
TEST(ResidentChain, DoesTheWholeWork) {
  Progress progress;
  FieldBench bench("test", shortRun(), progress);
  ASSERT_TRUE(bench.tryOpenNoisy(20));  // no multiple of a brick's edge
  for (const char* text : {"gaussian:1.5", "close:1", "distance:3"}) {
    const auto steps = lowerFilters(filterChain(text), bench.pool().lattice().spacing_m, 0.0F);
    FilterChain truth(bench.gpu(), bench.transfer(), bench.pool(), steps);
    truth.run();
    ResidentChain chain(bench.gpu(), bench.transfer(), bench.pool(), steps);
    for (int run = 0; run < 3; ++run) EXPECT_GT(chain.run().wall_ms, 0);
    std::vector<float> expected(kBrickVoxels), found(kBrickVoxels);
    std::size_t different = 0;
    for (std::size_t brick = 0; brick < bench.pool().brickCount(); ++brick) {
      const bool constant = truth.result().readBrick(bench.transfer(), brick, expected.data());
      if (constant) std::fill(expected.begin() + 1, expected.end(), expected[0]);
      if (chain.result().readBrick(bench.transfer(), brick, found.data())) {
        std::fill(found.begin() + 1, found.end(), found[0]);
      }
      different += expected == found ? 0 : 1;
    }
    EXPECT_EQ(different, 0U) << text;
  }
}

// A promise is about the size at which its bound was reasoned; without any such size a note says which they are.
TEST(FieldBench, PromisesWhatIsSaidOfTheSizesThatAreMeasured) {
  Progress progress;
  FieldBench bench("test", shortRun(), progress);
  ASSERT_TRUE(bench.tryOpenNoisy(kSize));
  bench.measure("close:1", "close:1", {{"fake", 1e6, [] { return RunCost{10, 20}; }}});
  bench.promise({{"close:1", "ITK", 256, 0.7}, {"close:1", "ITK", kSize, 0.9}}, "no targets");
  ASSERT_EQ(bench.result().targets.size(), 1U);
  EXPECT_EQ(bench.result().targets[0].name, "close:1, 24^3: Palpate / ITK [-]");
  EXPECT_EQ(bench.result().targets[0].bound, 0.9);
  EXPECT_THAT(notesOf(bench.result()), testing::Not(HasSubstr("no targets")));
  bench.promise({{"close:1", "ITK", 256, 0.7}}, "no targets");
  EXPECT_THAT(notesOf(bench.result()), HasSubstr("no targets: 256^3 was left out"));
}

// What fails is told, and what was measured before it and can be measured after it is there.
TEST(FieldBench, GoesOnAfterWhatFails) {
  Progress progress;
  FieldBench bench("test", shortRun(), progress);
  EXPECT_FALSE(bench.tryOpen("too large", []() -> Volume { throw std::bad_alloc(); }));
  EXPECT_FALSE(bench.tryOpen("nowhere", [] { return loadVolume("/nowhere.nrrd"); }));
  ASSERT_TRUE(bench.tryOpenNoisy(kSize));
  bench.attempt("first", [&] { bench.measure("first", "close:1", {{"fake", 1e6, [] { return RunCost{10, 20}; }}}); });
  bench.attempt("second", [] { throw Error(Error::Code::kOutOfMemory, "GPU memory", "there is none left", "..."); });
  bench.attempt("third", [] { throw std::runtime_error("words of a library"); });
  EXPECT_EQ(rowsOf(bench.result(), "run", "first", "Palpate").size(), 1U);
  for (const char* note :
       {"too large was left out: there was not enough memory", "nowhere was left out: /nowhere.nrrd",
        "second, 24^3 was left out: GPU memory: there is none left", "third, 24^3 was left out: words of a library"}) {
    EXPECT_THAT(notesOf(bench.result()), HasSubstr(note));
  }
  EXPECT_THROW(bench.attempt("x", [] { throw Error(Error::Code::kCancelled, "x", "y", "z"); }), Error);
}

// A child that offers a job and dies of the volume, as one without enough memory for it does.
TEST(FieldBench, LosesOnlyTheRivalsWhoseChildDied) {
  Progress progress;
  FieldBenchRequest request = shortRun();
  request.python = {"/bin/sh", "-c", "read a; printf 'rival\\tSciPy\\tclose:1\\tway\\nready\\n'; read b; exit 1"};
  FieldBench bench("test", request, progress);
  ASSERT_TRUE(bench.tryOpenNoisy(kSize));
  EXPECT_THAT(notesOf(bench.result()), HasSubstr("no comparison with SciPy and VTK from 24^3 on: "
                                                 "the Python child: it ended"));
  bench.measure("close:1", "close:1", {{"fake", 1e6, [] { return RunCost{10, 20}; }}});
  EXPECT_TRUE(rowsOf(bench.result(), "run", "close:1", "SciPy").empty());
  EXPECT_EQ(rowsOf(bench.result(), "run", "close:1", "ITK").size(), 3U);
}

// A variable of the environment, as long as this object lives; without a value: not set.
class Variable {
 public:
  Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::optional<std::string>& value) { value ? setenv(name_, value->c_str(), 1) : unsetenv(name_); }
  const char* name_;
  std::optional<std::string> before_;
};

// The demo's scan, in the cache or at home, before that of PALPATE_DATA, before a phantom.
TEST(HeadVolume, IsTheFirstScanThatIsThere) {
  namespace fs = std::filesystem;
  const ScratchFolder folder;
  const fs::path cache = folder.path() / "cache", home = folder.path() / "home", data = folder.path() / "data";
  const auto make = [](const fs::path& file) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "x";
    return file.string();
  };
  const Variable in_home("HOME", home.string()), in_data("PALPATE_DATA", data.string());
  std::optional<Variable> in_cache;
  in_cache.emplace("XDG_CACHE_HOME", cache.string());
  EXPECT_EQ(headVolume(), "phantom:head?size=256");
  const std::string scan = make(data / "ct_head_invesalius.nrrd");
  EXPECT_EQ(headVolume(), scan);
  const std::string at_home = make(home / ".cache/palpate/Cranium.inv3");
  EXPECT_EQ(headVolume(), scan);  // the cache is elsewhere
  const std::string cached = make(cache / "palpate/Cranium.inv3");
  EXPECT_EQ(headVolume(), cached);
  in_cache.reset();
  const Variable no_cache("XDG_CACHE_HOME", std::nullopt);
  EXPECT_EQ(headVolume(), at_home);
}

// With a volume of 64^3 comes a head. This one is a slope along i with some unevenness, so all its 27 bricks are
// stored. Its isosurface lies in the middle layer of bricks; the cells that it crosses have their corners in that layer
// and the next: 18 bricks are needed.
TEST(GradientBench, MeasuresTheHeadBesideALargeVolume) {
  const ScratchFolder folder;
  const Variable no_demo("XDG_CACHE_HOME", folder.path().string()), data("PALPATE_DATA", folder.path().string());
  std::vector<float> values;
  for (int n = 0; n < kSize * kSize * kSize; ++n) {
    const int i = n % kSize, j = n / kSize % kSize, k = n / kSize / kSize;
    values.push_back(100.0F * (static_cast<float>(i) - 11.5F) + static_cast<float>((7 * j + 3 * k) % 5));
  }
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(1e-3);
  saveVolume(Volume::fromDense(Vec3i::Constant(kSize), lattice, values, {}),
             (folder.path() / "ct_head_invesalius.nrrd").string());
  FieldBenchRequest request = shortRun();
  request.sizes = {64};
  Progress progress;
  const BenchResult result = runGradientBench(request, progress);
  const auto rows = rowsOf(result, "run", "gradient central, needed bricks only", "Palpate");
  ASSERT_EQ(rows.size(), 2U);
  // Floats of all bricks for their bounds; of the needed ones floats and samples of 16 bytes.
  expectFigures(rows[0], 27 * 512 * 4 + 18 * 512 * (4 + 16));
  expectFigures(rows[1], 18 * 512 * (4 + 16));
  EXPECT_EQ(textOf(rows[0], "volume"), "ct_head_invesalius.nrrd");
  EXPECT_THAT(notesOf(result), HasSubstr("ct_head_invesalius.nrrd: 24 x 24 x 24 voxels, isovalue "));
  EXPECT_THAT(notesOf(result), HasSubstr("which needs 18 of 27 bricks"));
  EXPECT_THAT(notesOf(result), HasSubstr("no target 'gradient central, needed bricks only, ct_head_invesalius.nrrd: "
                                         "Palpate / VTK [-]'"));
  ASSERT_EQ(result.targets.size(), 1U);
  EXPECT_EQ(result.targets[0].name, "gradient central, 64^3: Palpate / ITK [-]");
  EXPECT_EQ(result.targets[0].bound, 0.6);
}

TEST(CopySpeed, CopiesEveryByte) {
  gpu::Gpu gpu({});
  for (const bool on_host : {true, false}) {
    CopySpeed copy(gpu, 1000004, 3, on_host);  // shared out unevenly
    EXPECT_EQ(copy.movedBytes(), 2000008);
    EXPECT_FALSE(copy.isDone());
    EXPECT_GT(copy.run().wall_ms, 0);
    EXPECT_TRUE(copy.isDone());
    // 1000004 bytes over 2^20
    EXPECT_EQ(copy.way(),
              on_host ? "memcpy of 0.953678 MiB by 3 threads" : "the device's copy of a buffer of 0.953678 MiB");
  }
}

TEST(FieldBench, RefusesADeviceThatIsNotThere) {
  Progress progress;
  FieldBenchRequest request = shortRun();
  request.gpu = "Voodoo";
  EXPECT_THROW(static_cast<void>(runFilterBench(request, progress)), Error);
}

}  // namespace field_bench_test
}  // namespace palpate
