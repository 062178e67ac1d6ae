// SPDX-License-Identifier: Apache-2.0
// apps/bench/field_bench.hpp: `palpate bench filters` and `palpate bench gradient`: filters and gradient operators
// beside those of ITK, VTK, SciPy and OpenVDB, and beside a copy of memory.
//
// Every filter (engine/filter/filter_spec.hpp) and every operator (engine/gradient/gradient_operator.hpp) runs on every
// brick of a dense volume. On a CT head, gradients are computed only for the bricks that the isosurface needs, which
// the other libraries cannot do. Each job and the copy of memory run in turns.
//
// Rows by "part": "run" (one for each job, volume and library), "left out" (likewise, with "why"), "note". Bytes moved:
// each pass reads its field once and writes its result once. What a kernel reads again from neighbours is not counted.
//
// One thread. Throws Error as FilterChain and GradientPass do, and Error(kCancelled) on Ctrl-C. Memory for 512^3: some
// 6 GiB for filters, 9 GiB for gradients.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/copy_speed.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/bench/turns.hpp"
#include "apps/console/progress.hpp"
#include "apps/rivals/rivals.hpp"
#include "engine/field/volume.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

struct FieldBenchRequest {
  std::vector<int> sizes = {};  // along every edge [voxel]
  TurnsPlan turns = {};
  std::size_t copy_bytes = std::size_t{256} << 20U;
  std::uint64_t seed = 1;
  std::string gpu = {};                                    // part of the Vulkan device's name
  std::vector<std::string> python = {"/usr/bin/python3"};  // interpreter with VTK and SciPy, and its options

  // Up to three rounds: a target from a single round could be about other load on the machine.
  [[nodiscard]] static FieldBenchRequest quick() {
    return {.turns = {.most_rounds = 3, .budget_s = 0.4}, .copy_bytes = std::size_t{64} << 20U};
  }
};

// A promise: Palpate's median time over that of the library's fastest way, on the noisy volume of this size, is at most
// the bound.
struct FieldPromise {
  const char* job;
  const char* library;
  int size;  // along every edge [voxel]
  double bound;
};

// One of Palpate's own ways to do a job.
struct OwnEntrant {
  std::string way;
  double moved_bytes = 0;
  std::function<RunCost()> run;
};

class FieldBench {
 public:
  FieldBench(const std::string& bench, const FieldBenchRequest& request, Progress& progress);

  [[nodiscard]] BenchResult& result() noexcept { return result_; }
  [[nodiscard]] gpu::Gpu& gpu() noexcept { return gpu_; }
  [[nodiscard]] gpu::Transfer& transfer() noexcept { return transfer_; }
  [[nodiscard]] const BrickPool& pool() const noexcept { return *pool_; }
  [[nodiscard]] const Volume& volume() const noexcept { return *volume_; }

  // Makes a volume for the jobs that follow. `name`: the volume's name in rows. Returns false, with a note, if the
  // volume cannot be made or does not fit into the device. Then nothing may be measured.
  [[nodiscard]] bool tryOpen(const std::string& name, const std::function<Volume()>& make);
  // The same with the knot phantom: `size` voxels of 1 mm along every edge, with noise. No two bricks are equal, and
  // none is constant.
  [[nodiscard]] bool tryOpenNoisy(int size);
  // Runs one part of the bench. If it fails, the reason becomes a note, and the bench goes on.
  void attempt(const std::string& what, const std::function<void()>& work);

  // Lets everyone take turns at a job, and adds the rows. `rivals_job`: the job's name for the rivals. The others are
  // compared with the first of `own`.
  void measure(const std::string& job, const std::string& rivals_job, const std::vector<OwnEntrant>& own);

  // Adds a target for a job on the volume `name`: Palpate against the library. A note instead if one of them was not
  // measured.
  void promise(const std::string& job, const std::string& name, const std::string& library, double bound);
  // Adds the targets whose size was requested. If there are none, adds a note that begins with `words` and names the
  // size that has targets.
  void promise(const std::vector<FieldPromise>& promises, const std::string& words);

 private:
  void open(const std::string& name, Volume volume);
  std::vector<Rival> rivalsOf(const std::string& job);

  FieldBenchRequest request_;
  Progress& progress_;
  unsigned threads_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  CopySpeed copy_;
  PythonRivals python_;
  Turns turns_;
  BenchResult result_;
  std::string name_;
  std::optional<Volume> volume_;
  std::optional<BrickPool> pool_;
  std::vector<float> dense_;
  RivalField field_;
  std::optional<OpenVdbRivals> openvdb_;
};

[[nodiscard]] std::string noisyName(int size);  // "256^3"

[[nodiscard]] BenchResult runFilterBench(const FieldBenchRequest& request, Progress& progress);
// The jobs of the filter bench: one for each filter of the table, with parameters where a size of 1 is not enough.
[[nodiscard]] std::vector<std::string> filterJobs();

// Leaves the head out if all sizes are below 64^3, as in tests.
[[nodiscard]] BenchResult runGradientBench(const FieldBenchRequest& request, Progress& progress);

[[nodiscard]] std::string fieldTable(const BenchResult& result);
// Time per voxel [ns] against size: a panel for each of some jobs, a series for each library, with its fastest way.
[[nodiscard]] LogCharts filterCharts(const BenchResult& result);
[[nodiscard]] LogCharts gradientCharts(const BenchResult& result);

}  // namespace palpate
