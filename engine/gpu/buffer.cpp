// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/buffer.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/large_pages.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

using Property = vk::MemoryPropertyFlagBits;

// The first memory type that the buffer allows and that has the wanted properties. Properties are in order of
// preference.
std::optional<std::uint32_t> findMemoryType(const vk::raii::PhysicalDevice& physical, std::uint32_t allowed,
                                            MemoryKind kind) {
  const std::array<vk::MemoryPropertyFlags, 2> device = {Property::eDeviceLocal, vk::MemoryPropertyFlags{}};
  const std::array<vk::MemoryPropertyFlags, 2> host = {
      Property::eHostVisible | Property::eHostCoherent | Property::eHostCached,
      Property::eHostVisible | Property::eHostCoherent};
  const vk::PhysicalDeviceMemoryProperties memory = physical.getMemoryProperties();
  for (const auto wanted : kind == MemoryKind::kDevice ? device : host) {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      if ((allowed >> i & 1U) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    }
  }
  return std::nullopt;
}

std::uint32_t memoryType(const vk::raii::PhysicalDevice& physical, std::uint32_t allowed, MemoryKind kind) {
  if (const auto type = findMemoryType(physical, allowed, kind)) return *type;
  throw Error(Error::Code::kDevice, "Vulkan", "the device has no memory that the host can read",
              "choose another one with --gpu");
}

bool hostReachable(const vk::raii::PhysicalDevice& physical, std::uint32_t type) {
  const auto flags = physical.getMemoryProperties().memoryTypes[type].propertyFlags;
  const vk::MemoryPropertyFlags wanted = Property::eHostVisible | Property::eHostCoherent;
  return (flags & wanted) == wanted;
}

constexpr auto kUsage = vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eTransferSrc |
                        vk::BufferUsageFlagBits::eTransferDst;

}  // namespace

Buffer::Buffer(Gpu& gpu, std::string name, std::size_t bytes, MemoryKind kind) : state_(std::make_unique<State>()) {
  Gpu::State& vulkan = gpu.state();
  state_->name = std::move(name);
  try {
    state_->buffer = {vulkan.device, vk::BufferCreateInfo{.size = bytes, .usage = kUsage}};
    const vk::MemoryRequirements need = state_->buffer.getMemoryRequirements();
    const std::uint32_t type = memoryType(vulkan.physical, need.memoryTypeBits, kind);
    state_->memory = {vulkan.device, vk::MemoryAllocateInfo{.allocationSize = need.size, .memoryTypeIndex = type}};
    state_->buffer.bindMemory(*state_->memory, 0);
    if (hostReachable(vulkan.physical, type)) state_->mapped = state_->memory.mapMemory(0, VK_WHOLE_SIZE);
    if (vulkan.info.isCpu() && state_->mapped != nullptr) wishLargePages(state_->mapped, need.size);
    vulkan.name(state_->buffer, state_->name);
    vulkan.name(state_->memory, state_->name + " memory");
  } catch (const vk::DeviceLostError& error) {
    vulkan.failed.store(true);
    throw Error(Error::Code::kDevice, vulkan.info.name,
                fmt::format("the device is lost ({}), and has no {} any more", error.what(), state_->name),
                "start again; if it fails again, try another device with --gpu");
  } catch (const vk::SystemError& error) {
    throw Error(Error::Code::kOutOfMemory, state_->name,
                fmt::format("{} has no {} left for it ({})", vulkan.info.name, inMiB(bytes), error.what()),
                "close other programs, use a smaller volume, or choose another device with --gpu");
  }
  state_->bytes = bytes;
  state_->count(vulkan);
}

std::optional<Buffer> Buffer::over(Gpu& gpu, std::string name, void* memory, std::size_t bytes) {
  Gpu::State& vulkan = gpu.state();
  const std::size_t whole = vulkan.opened->import_bytes;
  if (whole == 0 || reinterpret_cast<std::uintptr_t>(memory) % whole != 0 || bytes % whole != 0) return std::nullopt;
  constexpr auto kHandle = vk::ExternalMemoryHandleTypeFlagBits::eHostAllocationEXT;
  auto state = std::make_unique<State>();
  state->name = std::move(name);
  try {
    const vk::ExternalMemoryBufferCreateInfo external{.handleTypes = kHandle};
    state->buffer = {vulkan.device, vk::BufferCreateInfo{.pNext = &external, .size = bytes, .usage = kUsage}};
    const vk::MemoryRequirements need = state->buffer.getMemoryRequirements();
    const std::uint32_t takes = vulkan.device.getMemoryHostPointerPropertiesEXT(kHandle, memory).memoryTypeBits;
    const auto type = findMemoryType(vulkan.physical, need.memoryTypeBits & takes, MemoryKind::kHost);
    if (!type || need.size > bytes) return std::nullopt;
    const vk::ImportMemoryHostPointerInfoEXT import{.handleType = kHandle, .pHostPointer = memory};
    state->memory = {vulkan.device,
                     vk::MemoryAllocateInfo{.pNext = &import, .allocationSize = bytes, .memoryTypeIndex = *type}};
    state->buffer.bindMemory(*state->memory, 0);
    vulkan.name(state->buffer, state->name);
    vulkan.name(state->memory, state->name + " memory");
  } catch (const vk::SystemError&) {  // some drivers take memory of their own process alone
    return std::nullopt;
  }
  state->mapped = memory;
  state->bytes = bytes;
  state->count(vulkan);
  return Buffer(std::move(state));
}

void Buffer::State::count(Gpu::State& by) {
  BufferUse& use = by.buffers.try_emplace(name, BufferUse{.name = name}).first->second;
  ++use.count;
  use.bytes += bytes;
  by.bytes_in_use += bytes;
  by.peak_bytes = std::max(by.peak_bytes, by.bytes_in_use.load());
  gpu = &by;
}

Buffer::State::~State() {
  if (gpu == nullptr) return;
  gpu->bytes_in_use -= bytes;
  const auto use = gpu->buffers.find(name);
  use->second.bytes -= bytes;
  if (--use->second.count == 0) gpu->buffers.erase(use);
}

Buffer::Buffer(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Buffer::~Buffer() = default;
Buffer::Buffer(Buffer&&) noexcept = default;
Buffer& Buffer::operator=(Buffer&&) noexcept = default;

std::size_t Buffer::bytes() const noexcept {
  return state_->bytes;
}
void* Buffer::mapped() const noexcept {
  return state_->mapped;
}

}  // namespace palpate::gpu
