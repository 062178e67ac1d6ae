// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/gpu.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/gpu/validation.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

constexpr std::uint64_t kWaitLimit_ns = 60'000'000'000;

void openDevice(Gpu::State& state) {
  state.queue_family = computeQueueFamily(state.physical).value();
  const float priority = 1.0F;
  const vk::DeviceQueueCreateInfo queue{
      .queueFamilyIndex = state.queue_family, .queueCount = 1, .pQueuePriorities = &priority};
  const vk::PhysicalDeviceTimelineSemaphoreFeatures timeline{.timelineSemaphore = VK_TRUE};
  state.device = {state.physical,
                  vk::DeviceCreateInfo{.pNext = &timeline, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue}};
  state.queue = {state.device, state.queue_family, 0};
  state.command_pool = {state.device,
                        vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                                  .queueFamilyIndex = state.queue_family}};
  const vk::SemaphoreTypeCreateInfo type{.semaphoreType = vk::SemaphoreType::eTimeline, .initialValue = 0};
  state.timeline = {state.device, vk::SemaphoreCreateInfo{.pNext = &type}};
}

}  // namespace

void Gpu::State::wait(std::uint64_t value) {
  const vk::SemaphoreWaitInfo until{.semaphoreCount = 1, .pSemaphores = &*timeline, .pValues = &value};
  if (device.waitSemaphores(until, kWaitLimit_ns) != vk::Result::eSuccess) {
    throw Error(Error::Code::kDevice, info.name, "a kernel did not finish within 60 s",
                "check the driver's log; try another device with --gpu");
  }
}

Gpu::Gpu(const GpuRequest& request) : state_(std::make_unique<State>()) {
  const bool validation = request.validation || validationWanted();
  try {
    state_->context = openLoader();
    state_->instance = makeInstance(state_->context, validation);
    if (validation) state_->messenger = makeMessenger(state_->instance);
    state_->physical = choose(state_->instance, request.name);
    state_->info = describe(state_->physical);
    if (!request.tuned_as.empty()) state_->info.tuned_as = request.tuned_as;
    state_->named = validation;
    openDevice(*state_);
    state_->name(state_->timeline, "submission timeline");
  } catch (const vk::SystemError& error) {
    throw Error(Error::Code::kDevice, state_->info.name.empty() ? "Vulkan" : state_->info.name,
                fmt::format("the driver refused to open the device ({})", error.what()),
                "try another one with --gpu; 'palpate devices' lists them");
  }
}

Gpu::~Gpu() {
  // Buffers and kernels are destroyed by their owners before; only the queue may still be busy.
  if (*state_->device) {
    try {
      state_->device.waitIdle();
    } catch (const vk::SystemError&) {  // NOLINT(bugprone-empty-catch): a lost device has nothing left to wait for
    }
  }
}

const GpuInfo& Gpu::info() const noexcept {
  return state_->info;
}
std::uint64_t Gpu::bytesInUse() const noexcept {
  return state_->bytes_in_use.load();
}

}  // namespace palpate::gpu
