// SPDX-License-Identifier: Apache-2.0
// engine/passes/edit_pass.hpp: runs edit commands on bricks of the pool (shaders/edit.comp, edit_stencil.comp). Twin:
// engine/reference/edit.hpp. Thread: the Gpu's.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/edit/lower_edit.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/host_list.hpp"
#include "engine/passes/pool_kernel.hpp"

namespace palpate {

// Commands that one dispatch can run: any number of one kind that reads no neighbours, or one command that reads them.
struct EditPhase {
  layout::uint kind = EDIT_KINDS;  // EDIT_KINDS: no commands, only pages to write
  bool given = false;              // no commands; the densities of the bricks come from EditPass::given()
  std::uint32_t first_command = 0;
  std::uint32_t command_count = 0;
  std::vector<layout::EditTask> tasks;  // one for each brick

  [[nodiscard]] bool stencil() const noexcept { return EDIT_READS_NEIGHBOURS(kind); }
};

class EditPass {
 public:
  EditPass(gpu::Gpu& gpu, const BrickPool& pool);

  // Makes room for write() of these arguments, and for `more_tasks` more tasks. Throws Error(kOutOfMemory); then
  // nothing has changed.
  void fit(std::span<const EditPhase> phases, const LoweredEdits& edits, std::size_t more_tasks);
  // Writes phases and commands for the kernels, and sorts the tasks of each phase by slab. Not while work is submitted.
  void write(std::vector<EditPhase>& phases, const LoweredEdits& edits);
  // Builds the kernels that record() will need; after the pool's reserve(). Throws Error(kDevice).
  void makeKernels(std::span<const EditPhase> phases);
  // Makes room in given() for the densities of so many bricks. After write() the caller fills it in the order of the
  // phase's tasks. Throws Error(kOutOfMemory) for more than one binding holds, 65536 bricks.
  void fitGiven(std::size_t bricks);
  [[nodiscard]] HostList<float>& given() noexcept { return given_; }
  // Records runs of a kind's kernel and of the commit kernel on no brick at all. A driver compiles a kernel when it
  // first runs, which takes some 50 ms; so the first edit does not wait for that.
  void recordIdle(gpu::Commands& commands, layout::uint kind);
  // Records the phases of the last write(), each followed by a barrier.
  void record(gpu::Commands& commands, std::span<const EditPhase> phases);
  [[nodiscard]] std::uint32_t dispatches(std::span<const EditPhase> phases) const noexcept;  // at most

 private:
  struct SlabRange {
    std::size_t slab = 0;
    std::uint32_t first = 0;  // index among all tasks
    std::uint32_t count = 0;
  };
  void recordPointwise(gpu::Commands& commands, const EditPhase& phase, std::uint32_t first_task);
  void recordCommit(gpu::Commands& commands, const EditPhase& phase, std::uint32_t first_task,
                    const gpu::Buffer& aside);
  void recordStencil(gpu::Commands& commands, const EditPhase& phase, std::uint32_t first_task);
  [[nodiscard]] layout::EditPush pushFor(const EditPhase& phase, std::uint32_t first, std::uint32_t count) const;
  [[nodiscard]] const gpu::Kernel& pointwiseKernel(layout::uint kind);
  [[nodiscard]] const gpu::Kernel& stencilKernel(layout::uint kind);
  [[nodiscard]] static std::vector<SlabRange> slabRanges(const EditPhase& phase, std::uint32_t first_task);

  gpu::Gpu& gpu_;
  const BrickPool& pool_;
  layout::EditScale scale_;
  // By kind, built when first used: a new kernel costs some 50 ms of the driver's compiler.
  std::array<std::optional<gpu::Kernel>, EDIT_KINDS> pointwise_;
  std::array<std::optional<PoolKernel>, EDIT_KINDS> stencil_;
  gpu::Kernel commit_;
  HostList<layout::EditTask> tasks_;
  HostList<layout::EditCommand> commands_;
  HostList<float> stamps_;
  HostList<float> given_;
  std::optional<gpu::Buffer> aside_;  // results of a stencil kernel, before the commit kernel copies them into the pool
};

}  // namespace palpate
