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

// Commands that can run in one go: any number of one kind that reads no neighbours, or one command that does.
struct EditPhase {
  layout::uint kind = EDIT_KINDS;  // EDIT_KINDS: no commands, only pages to write
  bool given = false;              // no commands: the densities of the tasks' bricks are handed over
  std::uint32_t first_command = 0;
  std::uint32_t command_count = 0;
  std::vector<layout::EditTask> tasks;  // each brick once

  [[nodiscard]] bool stencil() const noexcept { return kind >= EDIT_SMOOTH && kind < EDIT_KINDS; }
};

class EditPass {
 public:
  EditPass(gpu::Gpu& gpu, const BrickPool& pool);

  // Makes sure that write() finds room for so much, and for `more_tasks`. Throws Error(kOutOfMemory) and changes
  // nothing then.
  void fit(std::span<const EditPhase> phases, const LoweredEdits& edits, std::size_t more_tasks);
  // Hands phases and commands to the kernels; tasks are put in the order of their slabs. Not while work is submitted.
  void write(std::vector<EditPhase>& phases, const LoweredEdits& edits);
  // The kernels that record() will want, once room is made in the pool. Throws Error(kDevice).
  void makeKernels(std::span<const EditPhase> phases);
  // Room for the densities of a given phase's bricks, which the caller fills after write(), in the order of its tasks.
  // Throws Error(kOutOfMemory) for more than fit into one binding, 65536.
  void fitGiven(std::size_t bricks);
  [[nodiscard]] HostList<float>& given() noexcept { return given_; }
  // Runs the kernel of a kind, and the one that puts bricks in place, on no brick at all: drivers compile a kernel when
  // it first runs, which takes some 50 ms that an edit should not wait for.
  void recordIdle(gpu::Commands& commands, layout::uint kind);
  // What write() got last; every phase is followed by a barrier.
  void record(gpu::Commands& commands, std::span<const EditPhase> phases);
  [[nodiscard]] std::uint32_t dispatches(std::span<const EditPhase> phases) const noexcept;  // at most

 private:
  struct SlabRange {
    std::size_t slab = 0;
    std::uint32_t first = 0;  // of all tasks
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
  EditScale scale_;
  // By kind, made when first used: the driver's compiler takes some 50 ms for each that it has not seen before.
  std::array<std::optional<gpu::Kernel>, EDIT_SMOOTH> pointwise_;
  std::array<std::optional<PoolKernel>, EDIT_KINDS - EDIT_SMOOTH> stencil_;
  gpu::Kernel commit_;
  HostList<layout::EditTask> tasks_;
  HostList<layout::EditCommand> commands_;
  HostList<float> stamps_;
  HostList<float> given_;
  std::optional<gpu::Buffer> aside_;  // bricks that a stencil wrote
};

}  // namespace palpate
