// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_dispatch.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "engine/passes/pool_kernel.hpp"
#include "shaders/kernels.hpp"

namespace palpate {

FilterDispatch::FilterDispatch(gpu::Gpu& gpu, gpu::Transfer& transfer, std::vector<FilterStep> steps)
    : gpu_(gpu), steps_(std::move(steps)) {
  std::map<std::vector<float>, std::size_t> known;
  for (const FilterStep& step : steps_) {
    kinds_.push_back(filterKernel(step));
    const std::vector<float> taps = kernelTaps(step);
    const auto [found, is_new] = known.emplace(taps, tap_buffers_.size());
    taps_.push_back(found->second);
    if (!is_new) continue;
    tap_buffers_.emplace_back(gpu, "filter taps", taps.size() * sizeof(float), gpu::MemoryKind::kDevice);
    transfer.upload(std::as_bytes(std::span(taps)), tap_buffers_.back());
  }
}

void FilterDispatch::record(gpu::Commands& commands, std::size_t step, const BrickPool& from, const BrickPool& to,
                            const gpu::Buffer& tasks, std::span<const FilterRange> ranges) {
  const std::uint32_t bricks_a_group = kinds_[step].bricks_a_group;
  for (const FilterRange& range : ranges) {
    const layout::FilterPush push{from.domain(), range.first, range.count};
    const std::uint32_t groups = std::max(1U, (range.count + bricks_a_group - 1) / bricks_a_group);
    commands.dispatch(kernel(step, from, range.edge),
                      poolBindings(from, {&tasks, &to.slab(range.slab), &tap_buffers_[taps_[step]]}),
                      gpu::pushBytes(push), gpu::Groups::folded(groups, GROUPS_PER_ROW));
  }
}

const gpu::Kernel& FilterDispatch::kernel(std::size_t step, const BrickPool& from, bool edge) {
  const FilterKernel& kind = kinds_[step];
  const auto slabs = static_cast<std::uint32_t>(from.slabCount());
  std::vector<std::uint32_t> constants = {slabs, edge ? 1U : 0U,
                                          steps_[step].border == Border::kMirror ? BORDER_MIRROR : BORDER_NEAREST};
  constants.insert(constants.end(), kind.constants.begin(), kind.constants.end());
  const std::string key = fmt::format("{} {}", kind.name, fmt::join(constants, " "));
  auto found = kernels_.find(key);
  if (found == kernels_.end()) {
    gpu::Kernel made(gpu_, {.name = kind.name,
                            .spirv = poolKernelSpirv(kind.name, slabs),
                            .bindings = FILTER_BINDINGS,
                            .push_bytes = sizeof(layout::FilterPush),
                            .specialisation = constants});
    found = kernels_.emplace(key, std::move(made)).first;
  }
  return found->second;
}

}  // namespace palpate
