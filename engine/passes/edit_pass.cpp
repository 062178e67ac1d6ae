// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/edit_pass.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.hpp"
#include "shaders/kernels.hpp"

namespace palpate {
namespace {

gpu::Kernel plainKernel(gpu::Gpu& gpu, const std::string& name, std::uint32_t bindings, std::size_t push_bytes,
                        std::vector<std::uint32_t> constants) {
  return {gpu, gpu::KernelSpec{.name = name,
                               .spirv = kernelSpirv(name),
                               .bindings = bindings,
                               .push_bytes = static_cast<std::uint32_t>(push_bytes),
                               .specialisation = std::move(constants)}};
}

std::size_t taskCount(std::span<const EditPhase> phases) {
  std::size_t count = 0;
  for (const EditPhase& phase : phases) count += phase.tasks.size();
  return count;
}

// What a storage buffer binding is guaranteed to hold.
constexpr std::size_t kMaxTasks = (std::size_t{128} << 20U) / sizeof(layout::EditTask);

Error tooMany(std::size_t bricks, std::size_t most) {
  return {Error::Code::kOutOfMemory, "edit",
          fmt::format("it changes {} bricks at once and {} are the most; nothing was changed", bricks, most),
          "use a smaller brush, or several edits"};
}

// Tasks that only write a page may go with any slab.
std::size_t slabOf(const layout::EditTask& task) {
  return task.slot == NO_SLOT ? 0 : BrickPool::place(task.slot).slab;
}

}  // namespace

EditPass::EditPass(gpu::Gpu& gpu, const BrickPool& pool)
    : gpu_(gpu),
      pool_(pool),
      scale_(editScale(pool.lattice().spacing_m)),
      commit_(plainKernel(gpu, "brick_commit", COMMIT_BINDINGS, sizeof(layout::CommitPush), {})),
      tasks_(gpu, "edit tasks", 1024),
      commands_(gpu, "edit commands", 16),
      stamps_(gpu, "stamps", 16),
      given_(gpu, "given bricks", kBrickVoxels) {}

void EditPass::fit(std::span<const EditPhase> phases, const LoweredEdits& edits, std::size_t more_tasks) {
  std::size_t aside = 0;
  for (const EditPhase& phase : phases) {
    if (phase.stencil()) aside = std::max(aside, phase.tasks.size());
  }
  const std::size_t tasks = taskCount(phases) + more_tasks;
  if (aside > BRICKS_PER_DENSITY_SLAB) throw tooMany(aside, BRICKS_PER_DENSITY_SLAB);
  if (tasks > kMaxTasks) throw tooMany(tasks, kMaxTasks);
  tasks_.fit(tasks);
  commands_.fit(edits.commands.size());
  stamps_.fit(edits.stamps.size());
  if (aside > 0 && (!aside_ || aside_->bytes() < aside * kBrickBytes)) {
    const std::size_t bricks = std::min<std::size_t>(std::max<std::size_t>(2 * aside, 64), BRICKS_PER_DENSITY_SLAB);
    aside_ = gpu::Buffer(gpu_, "edited bricks", bricks * kBrickBytes, gpu::MemoryKind::kDevice);
  }
}

void EditPass::fitGiven(std::size_t bricks) {
  if (bricks > BRICKS_PER_DENSITY_SLAB) throw tooMany(bricks, BRICKS_PER_DENSITY_SLAB);
  given_.fit(bricks * kBrickVoxels);
}

void EditPass::write(std::vector<EditPhase>& phases, const LoweredEdits& edits) {
  std::vector<layout::EditTask> all;
  for (EditPhase& phase : phases) {
    std::stable_sort(phase.tasks.begin(), phase.tasks.end(),
                     [](const auto& a, const auto& b) { return slabOf(a) < slabOf(b); });
    all.insert(all.end(), phase.tasks.begin(), phase.tasks.end());
  }
  tasks_.write(all);
  commands_.write(edits.commands);
  stamps_.write(edits.stamps);
}

const gpu::Kernel& EditPass::pointwiseKernel(layout::uint kind) {
  if (kind == EDIT_KINDS) kind = EDIT_REMOVE;  // no commands: any kernel writes pages
  std::optional<gpu::Kernel>& kernel = pointwise_[kind];
  if (!kernel) kernel = plainKernel(gpu_, "edit", EDIT_BINDINGS, sizeof(layout::EditPush), {kind});
  return *kernel;
}

const gpu::Kernel& EditPass::stencilKernel(layout::uint kind) {
  std::optional<PoolKernel>& kernel = stencil_[kind];
  if (!kernel) {
    kernel.emplace(gpu_, "edit_stencil", pool_, STENCIL_BINDINGS, sizeof(layout::EditPush),
                   std::vector<std::uint32_t>{kind});
  }
  return kernel->get();
}

void EditPass::makeKernels(std::span<const EditPhase> phases) {
  static_cast<void>(pointwiseKernel(EDIT_KINDS));  // for pages
  for (const EditPhase& phase : phases)
    static_cast<void>(phase.stencil() ? stencilKernel(phase.kind) : pointwiseKernel(phase.kind));
}

std::vector<EditPass::SlabRange> EditPass::slabRanges(const EditPhase& phase, std::uint32_t first_task) {
  std::vector<SlabRange> ranges;
  for (std::size_t i = 0; i < phase.tasks.size(); ++i) {
    const std::size_t slab = slabOf(phase.tasks[i]);
    if (ranges.empty() || ranges.back().slab != slab)
      ranges.push_back({slab, first_task + static_cast<std::uint32_t>(i), 0});
    ++ranges.back().count;
  }
  return ranges;
}

std::uint32_t EditPass::dispatches(std::span<const EditPhase> phases) const noexcept {
  const auto slabs = static_cast<std::uint32_t>(pool_.slabCount());
  return static_cast<std::uint32_t>(phases.size()) * (slabs + 1);
}

layout::EditPush EditPass::pushFor(const EditPhase& phase, std::uint32_t first, std::uint32_t count) const {
  return {pool_.domain(), first, count, phase.first_command, phase.command_count, scale_};
}

void EditPass::recordPointwise(gpu::Commands& commands, const EditPhase& phase, std::uint32_t first_task) {
  for (const SlabRange& range : slabRanges(phase, first_task)) {
    const layout::EditPush push = pushFor(phase, range.first, range.count);
    const gpu::Buffer* buffers[EDIT_BINDINGS] = {&pool_.pages(), &pool_.slab(range.slab), &tasks_.buffer(),
                                                 &commands_.buffer(), &stamps_.buffer()};
    commands.dispatch(pointwiseKernel(phase.kind), buffers, gpu::pushBytes(push),
                      gpu::Groups::folded(range.count, GROUPS_PER_ROW));
  }
}

void EditPass::recordStencil(gpu::Commands& commands, const EditPhase& phase, std::uint32_t first_task) {
  const auto count = static_cast<std::uint32_t>(phase.tasks.size());
  commands.dispatch(stencilKernel(phase.kind), poolBindings(pool_, {&tasks_.buffer(), &commands_.buffer(), &*aside_}),
                    gpu::pushBytes(pushFor(phase, first_task, count)), gpu::Groups::folded(count, GROUPS_PER_ROW));
  commands.barrier();
  recordCommit(commands, phase, first_task, *aside_);
}

void EditPass::recordCommit(gpu::Commands& commands, const EditPhase& phase, std::uint32_t first_task,
                            const gpu::Buffer& aside) {
  for (const SlabRange& range : slabRanges(phase, first_task)) {
    const layout::CommitPush push{range.first, range.count, range.first - first_task};
    const gpu::Buffer* buffers[COMMIT_BINDINGS] = {&pool_.pages(), &pool_.slab(range.slab), &tasks_.buffer(), &aside};
    commands.dispatch(commit_, buffers, gpu::pushBytes(push), gpu::Groups::folded(range.count, GROUPS_PER_ROW));
  }
}

void EditPass::recordIdle(gpu::Commands& commands, layout::uint kind) {
  EditPhase phase;
  phase.kind = kind;
  if (!aside_) aside_ = gpu::Buffer(gpu_, "edited bricks", 64 * kBrickBytes, gpu::MemoryKind::kDevice);
  const layout::EditPush push = pushFor(phase, 0, 0);
  if (phase.stencil()) {
    commands.dispatch(stencilKernel(kind), poolBindings(pool_, {&tasks_.buffer(), &commands_.buffer(), &*aside_}),
                      gpu::pushBytes(push), {});
  } else {
    const gpu::Buffer* buffers[EDIT_BINDINGS] = {&pool_.pages(), &pool_.slab(0), &tasks_.buffer(), &commands_.buffer(),
                                                 &stamps_.buffer()};
    commands.dispatch(pointwiseKernel(kind), buffers, gpu::pushBytes(push), {});
  }
  commands.barrier();
  const gpu::Buffer* buffers[COMMIT_BINDINGS] = {&pool_.pages(), &pool_.slab(0), &tasks_.buffer(), &*aside_};
  commands.dispatch(commit_, buffers, gpu::pushBytes(layout::CommitPush{}), {});
  commands.barrier();
}

void EditPass::record(gpu::Commands& commands, std::span<const EditPhase> phases) {
  std::uint32_t first_task = 0;
  for (const EditPhase& phase : phases) {
    if (phase.tasks.empty()) continue;
    if (phase.given) {
      recordCommit(commands, phase, first_task, given_.buffer());
    } else if (phase.stencil()) {
      recordStencil(commands, phase, first_task);
    } else {
      recordPointwise(commands, phase, first_task);
    }
    commands.barrier();
    first_task += static_cast<std::uint32_t>(phase.tasks.size());
  }
}

}  // namespace palpate
