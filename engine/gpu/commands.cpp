// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/commands.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

constexpr std::uint32_t kMaxMarks = 32;

vk::raii::DescriptorPool makePool(const vk::raii::Device& device, std::uint32_t sets) {
  const vk::DescriptorPoolSize size{.type = vk::DescriptorType::eStorageBuffer, .descriptorCount = sets * kMaxBindings};
  return {device, vk::DescriptorPoolCreateInfo{.maxSets = sets, .poolSizeCount = 1, .pPoolSizes = &size}};
}

// What the driver throws becomes an Error that names the device and the work.
template <typename Work>
void guarded(Gpu::State& gpu, const std::string& name, Work work) {
  try {
    work();
  } catch (const vk::SystemError& error) {
    if (error.code() == vk::Result::eErrorDeviceLost) gpu.failed.store(true);
    throw Error(Error::Code::kDevice, gpu.info.name, fmt::format("the driver failed in '{}' ({})", name, error.what()),
                "try again, use a smaller volume, or choose another device with --gpu");
  }
}

}  // namespace

Groups Groups::folded(std::uint32_t count, std::uint32_t row) {
  return count <= row ? Groups{count, 1} : Groups{row, (count + row - 1) / row};
}

struct Commands::State {
  Gpu::State* gpu = nullptr;
  std::string name;
  vk::raii::DescriptorPool pool = nullptr;
  vk::raii::CommandBuffer buffer = nullptr;
  std::uint64_t ticket = 0;  // timeline value of the newest submission
  vk::raii::QueryPool clock = nullptr;
  double tick_s = 0;  // of the device's clock [s]
  bool is_timed = false;
  std::vector<std::string> marks;  // names by query; the first one is where the clock starts

  vk::DescriptorSet bind(const Kernel::State& kernel, std::span<const Buffer* const> buffers) const;
};

Commands::Commands(Gpu& gpu, std::string name, std::uint32_t max_dispatches) : state_(std::make_unique<State>()) {
  Gpu::State& vulkan = gpu.state();
  state_->gpu = &vulkan;
  state_->name = std::move(name);
  state_->pool = makePool(vulkan.device, max_dispatches);
  vk::raii::CommandBuffers buffers(
      vulkan.device,
      vk::CommandBufferAllocateInfo{
          .commandPool = *vulkan.command_pool, .level = vk::CommandBufferLevel::ePrimary, .commandBufferCount = 1});
  state_->buffer = std::move(buffers.front());
  vulkan.name(state_->buffer, state_->name);
}

Commands::~Commands() {
  if (!state_ || state_->ticket == 0) return;
  try {
    state_->gpu->wait(state_->ticket);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): a lost device has nothing left to wait for
  }
}
Commands::Commands(Commands&&) noexcept = default;
Commands& Commands::operator=(Commands&&) noexcept = default;

void Commands::begin() {
  wait();
  guarded(*state_->gpu, state_->name, [&] {
    state_->pool.reset();
    state_->buffer.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    state_->marks.clear();
    if (state_->is_timed) state_->buffer.resetQueryPool(*state_->clock, 0, kMaxMarks);
    barrier();  // what earlier submissions wrote is seen by this one
    mark("start");
  });
}

vk::DescriptorSet Commands::State::bind(const Kernel::State& kernel, std::span<const Buffer* const> buffers) const {
  if (buffers.size() != kernel.bindings) {
    throw Error(Error::Code::kDevice, "kernel " + kernel.name,
                fmt::format("it has {} bindings but got {} buffers", kernel.bindings, buffers.size()),
                "this is a fault of Palpate: please report it");
  }
  const vk::DescriptorSetAllocateInfo allocate{
      .descriptorPool = *pool, .descriptorSetCount = 1, .pSetLayouts = &*kernel.set_layout};
  // The pool frees its sets in reset(); a raii set would free itself a second time.
  const vk::DescriptorSet set = (*gpu->device).allocateDescriptorSets(allocate, *gpu->device.getDispatcher()).front();
  std::vector<vk::DescriptorBufferInfo> infos(buffers.size());
  std::vector<vk::WriteDescriptorSet> writes(buffers.size());
  for (std::uint32_t i = 0; i < buffers.size(); ++i) {
    infos[i] = vk::DescriptorBufferInfo{.buffer = *buffers[i]->state().buffer, .offset = 0, .range = VK_WHOLE_SIZE};
    writes[i] = vk::WriteDescriptorSet{.dstSet = set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = vk::DescriptorType::eStorageBuffer,
                                       .pBufferInfo = &infos[i]};
  }
  gpu->device.updateDescriptorSets(writes, {});
  return set;
}

void Commands::dispatch(const Kernel& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> push,
                        Groups groups) {
  const Kernel::State& pipeline = kernel.state();
  vk::DescriptorSet set;
  guarded(*state_->gpu, state_->name, [&] { set = state_->bind(pipeline, buffers); });
  const vk::raii::CommandBuffer& commands = state_->buffer;
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline.pipeline);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline.layout, 0, set, {});
  if (!push.empty()) {
    commands.pushConstants<std::byte>(
        *pipeline.layout, vk::ShaderStageFlagBits::eCompute, 0,
        vk::ArrayProxy<const std::byte>(static_cast<std::uint32_t>(push.size()), push.data()));
  }
  commands.dispatch(groups.x, groups.y, 1);
  ++state_->gpu->dispatches[&pipeline];
}

void Commands::copy(const Buffer& from, std::size_t from_offset, const Buffer& to, std::size_t to_offset,
                    std::size_t bytes) {
  state_->buffer.copyBuffer(*from.state().buffer, *to.state().buffer,
                            vk::BufferCopy{.srcOffset = from_offset, .dstOffset = to_offset, .size = bytes});
}

void Commands::barrier() {
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const auto stages = Stage::eComputeShader | Stage::eTransfer;
  const vk::MemoryBarrier memory{
      .srcAccessMask = Access::eShaderWrite | Access::eTransferWrite,
      .dstAccessMask = Access::eShaderRead | Access::eShaderWrite | Access::eTransferRead | Access::eTransferWrite};
  state_->buffer.pipelineBarrier(stages, stages, {}, memory, {}, {});
}

void Commands::hostBarrier() {
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const vk::MemoryBarrier memory{.srcAccessMask = Access::eShaderWrite | Access::eTransferWrite,
                                 .dstAccessMask = Access::eHostRead};
  state_->buffer.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eHost, {}, memory, {}, {});
}

void Commands::timed(bool on) {
  Gpu::State& vulkan = *state_->gpu;
  const auto families = vulkan.physical.getQueueFamilyProperties();
  state_->is_timed = on && families[vulkan.queue_family].timestampValidBits != 0;
  if (!state_->is_timed || *state_->clock) return;
  state_->tick_s = 1e-9 * static_cast<double>(vulkan.physical.getProperties().limits.timestampPeriod);
  guarded(vulkan, state_->name, [&] {
    state_->clock = {vulkan.device,
                     vk::QueryPoolCreateInfo{.queryType = vk::QueryType::eTimestamp, .queryCount = kMaxMarks}};
  });
}

void Commands::mark(std::string name) {
  if (!state_->is_timed || state_->marks.size() == kMaxMarks) return;
  state_->buffer.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *state_->clock,
                                static_cast<std::uint32_t>(state_->marks.size()));
  state_->marks.push_back(std::move(name));
}

std::vector<StageTime> Commands::marks() const {
  std::vector<StageTime> stages;
  if (state_->marks.size() < 2) return stages;
  const auto count = static_cast<std::uint32_t>(state_->marks.size());
  std::vector<std::uint64_t> ticks;
  guarded(*state_->gpu, state_->name, [&] {  // waits for the results
    ticks = state_->clock
                .getResults<std::uint64_t>(0, count, count * sizeof(std::uint64_t), sizeof(std::uint64_t),
                                           vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait)
                .second;
  });
  for (std::uint32_t i = 1; i < count; ++i)
    stages.push_back({state_->marks[i], static_cast<double>(ticks[i] - ticks[i - 1]) * state_->tick_s});
  return stages;
}

void Commands::submit() {
  guarded(*state_->gpu, state_->name, [&] {
    state_->buffer.end();
    const std::uint64_t value = state_->gpu->submitted + 1;
    const vk::TimelineSemaphoreSubmitInfo timeline{.signalSemaphoreValueCount = 1, .pSignalSemaphoreValues = &value};
    const vk::SubmitInfo submit{.pNext = &timeline,
                                .commandBufferCount = 1,
                                .pCommandBuffers = &*state_->buffer,
                                .signalSemaphoreCount = 1,
                                .pSignalSemaphores = &*state_->gpu->timeline};
    state_->gpu->submit(submit);
    state_->gpu->submitted = state_->ticket = value;  // what was refused will never be done, and nobody waits for it
  });
}

bool Commands::done() const {
  bool ended = true;
  if (state_->ticket != 0)
    guarded(*state_->gpu, state_->name, [&] { ended = state_->gpu->timeline.getCounterValue() >= state_->ticket; });
  return ended;
}

void Commands::wait() {
  if (state_->ticket == 0) return;
  guarded(*state_->gpu, state_->name, [&] { state_->gpu->wait(state_->ticket); });
}

void Commands::run() {
  hostBarrier();
  submit();
  wait();
}

}  // namespace palpate::gpu
