// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/gpu.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/gpu/validation.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

constexpr std::uint64_t kWaitLimit_ns = 60'000'000'000;

}  // namespace

Gpu::State::State(std::shared_ptr<OpenDevice> shared)
    : opened(std::move(shared)),
      info(opened->info),
      physical(opened->physical),
      device(opened->device),
      queue_family(opened->queue_family),
      named(opened->named) {
  command_pool = {device, vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                                    .queueFamilyIndex = queue_family}};
  const vk::SemaphoreTypeCreateInfo type{.semaphoreType = vk::SemaphoreType::eTimeline, .initialValue = 0};
  timeline = {device, vk::SemaphoreCreateInfo{.pNext = &type}};
  name(timeline, "submission timeline");
}

void Gpu::State::submit(const vk::SubmitInfo& work) {
  const std::lock_guard lock(opened->one_at_a_time);
  opened->queue.submit(work);
}

void Gpu::State::wait(std::uint64_t value) {
  const vk::SemaphoreWaitInfo until{.semaphoreCount = 1, .pSemaphores = &*timeline, .pValues = &value};
  if (device.waitSemaphores(until, kWaitLimit_ns) != vk::Result::eSuccess) {
    failed.store(true);
    throw Error(Error::Code::kDevice, info.name, "a kernel did not finish within 60 s",
                "check the driver's log; try another device with --gpu");
  }
}

std::shared_ptr<const void> openAhead(const GpuRequest& request) {
  return openDevice(request.name, request.validation || validationWanted());
}

Gpu::Gpu(const GpuRequest& request) {
  const std::shared_ptr<OpenDevice> opened = openDevice(request.name, request.validation || validationWanted());
  try {
    state_ = std::make_unique<State>(opened);
  } catch (const vk::SystemError& error) {
    throw Error(Error::Code::kDevice, opened->info.name,
                fmt::format("the driver has nothing left for another use of the device ({})", error.what()),
                "end other programs that use it, or choose another device with --gpu");
  }
  if (!request.tuned_as.empty()) state_->info.tuned_as = request.tuned_as;
}

Gpu::~Gpu() {
  // Buffers are destroyed by their owners before; only what was submitted may still run.
  try {
    state_->wait(state_->submitted);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): a lost device has nothing left to wait for
  }
}

bool Gpu::failed() const noexcept {
  return state_->failed.load();
}

const GpuInfo& Gpu::info() const noexcept {
  return state_->info;
}
GpuUse Gpu::use() const {
  GpuUse use{.submissions = state_->submitted, .peak_bytes = state_->peak_bytes};
  for (const auto& kernel : state_->kernels) {
    const auto made = state_->made_s.find(kernel.get());
    const auto dispatched = state_->dispatches.find(kernel.get());
    use.kernels.push_back({.name = kernel->name,
                           .constants = kernel->constants,
                           .made_s = made == state_->made_s.end() ? 0 : made->second,
                           .dispatches = dispatched == state_->dispatches.end() ? 0 : dispatched->second});
  }
  for (const auto& [name, buffer] : state_->buffers) use.buffers.push_back(buffer);
  return use;
}
std::uint64_t Gpu::bytesInUse() const noexcept {
  return state_->bytes_in_use.load();
}

}  // namespace palpate::gpu
