// SPDX-License-Identifier: Apache-2.0
// apps/bench/field_bench.hpp: `palpate bench filters` and `bench gradient`: every filter of the table
// (engine/filter/filter_spec.hpp) and every operator (engine/gradient/gradient_operator.hpp) on every brick of a dense
// volume, and gradients of the bricks that the isosurface of a CT head needs, beside ITK, VTK, SciPy and OpenVDB, which
// know no such bricks, and beside a copy of memory.
//
// Rows by "part": "run" (a job, a volume and a library each), "left out" (the same with "why"), "note". Bytes moved are
// those that a pass must move: each pass reads its field once and writes its result once; what a kernel reads again
// from neighbours is not counted. The copy takes turns with each job. One thread. Throws Error as FilterChain and
// GradientPass do, and Error(kCancelled) on Ctrl-C. Memory: 512^3 takes some 6 GiB for filters, 9 GiB for gradients.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/copy_speed.hpp"
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
  std::vector<std::string> python = {"/usr/bin/python3"};  // that VTK and SciPy belong to

  // Short runs are tried three times: a target that rests on one is about what else the machine did.
  [[nodiscard]] static FieldBenchRequest quick() {
    return {.turns = {.most_rounds = 3, .budget_s = 0.4}, .copy_bytes = std::size_t{64} << 20U};
  }
};

// Palpate's median over the smallest of a library's, on the noisy volume of a size, shall be at most the bound.
struct FieldPromise {
  const char* job;
  const char* library;
  int size;  // along every edge [voxel]
  double bound;
};

// One of Palpate's own.
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

  // From here on the volume that `make` gives is worked on, by all. `name`: as rows have it. False: it could not be
  // had, or not be held by the device, and a note says why; nothing may be measured then.
  [[nodiscard]] bool tryOpen(const std::string& name, const std::function<Volume()>& make);
  // The knot with noise, of `size` along every edge, 1 mm voxels: no two bricks are alike and none is constant.
  [[nodiscard]] bool tryOpenNoisy(int size);
  // Part of the bench: what it fails with becomes a note, and the next part has its turn.
  void attempt(const std::string& what, const std::function<void()>& work);

  // Everybody's turns at a job; adds the rows. `rivals_job`: what rivals are asked for. The first of `own` is the one
  // that others are compared with.
  void measure(const std::string& job, const std::string& rivals_job, const std::vector<OwnEntrant>& own);

  // On the volume `name`. Where one of the two is not there, a note says so instead.
  void promise(const std::string& job, const std::string& name, const std::string& library, double bound);
  // Those whose size was asked for; without any a note begins with `words` and says which size has them.
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
// What it measures: one job for each filter of the table, with parameters where a size of 1 is not enough.
[[nodiscard]] std::vector<std::string> filterJobs();

// The head: the demo's scan or one of PALPATE_DATA where either is, else a phantom. Left out where sizes are small
// (below 64^3), for tests.
[[nodiscard]] BenchResult runGradientBench(const FieldBenchRequest& request, Progress& progress);
[[nodiscard]] std::string headVolume();  // its name, as loadVolume takes it

[[nodiscard]] std::string fieldTable(const BenchResult& result);
// Nanoseconds a voxel against size, a panel a job of some, a line a library.
[[nodiscard]] std::string filterChart(const BenchResult& result);
[[nodiscard]] std::string gradientChart(const BenchResult& result);

}  // namespace palpate
