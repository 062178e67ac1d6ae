// SPDX-License-Identifier: Apache-2.0
// apps/bench/field_bench.hpp: what `palpate bench filters` and `bench gradient` share: volumes, rivals, the copy that
// both are held against, and the form of their rows.
//
// Rows by "part": "run" (a job, a volume and a library each), "left out" (the same with "why"), "note". Bytes moved are
// those that a pass must move: each pass reads its field once and writes its result once; what a kernel reads again
// from neighbours is not counted. The copy takes turns with each job. One thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/copy_speed.hpp"
#include "apps/bench/turns.hpp"
#include "apps/console/progress.hpp"
#include "apps/rivals/openvdb_rivals.hpp"
#include "apps/rivals/python_rivals.hpp"
#include "engine/field/volume.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

struct FieldBenchRequest {
  std::vector<int> sizes = {128, 256, 512};  // along every edge [voxel]
  TurnsPlan turns;
  std::size_t copy_bytes = std::size_t{256} << 20U;
  std::uint64_t seed = 1;
  std::string gpu;                                         // part of the Vulkan device's name
  std::vector<std::string> python = {"/usr/bin/python3"};  // that VTK and SciPy belong to

  [[nodiscard]] static FieldBenchRequest quick();
};

inline constexpr int kTargetSize_voxel = 256;

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

  // Palpate's median over the smallest of `library`'s, at the volume `name`, shall be at most `bound`. Where one of the
  // two is not there, a note says so instead.
  void promise(const std::string& job, const std::string& name, const std::string& library, double bound);

 private:
  void open(const std::string& name, Volume volume);
  std::vector<Rival> rivalsOf(const std::string& job);
  void addRow(const std::string& job, const TurnsOutcome& outcome, const TurnsOutcome& own, double moved_bytes,
              double copy_bytes_per_ms);

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
  std::unique_ptr<OpenVdbRivals> openvdb_;  // made when it is first asked for
};

[[nodiscard]] std::string noisyName(int size);  // "256^3"

[[nodiscard]] std::string fieldTable(const BenchResult& result);  // for the terminal
// Nanoseconds a voxel against size, a panel a job of `jobs`, a line a library.
[[nodiscard]] std::string fieldChart(const BenchResult& result, const std::string& title,
                                     const std::vector<std::string>& jobs);
[[nodiscard]] std::string fieldIntroduction();

}  // namespace palpate
