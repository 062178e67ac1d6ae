// SPDX-License-Identifier: Apache-2.0
// engine/gpu/vulkan_state.hpp: the Vulkan objects behind Gpu, Buffer, Kernel and Commands. Private to engine/gpu.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/open_device.hpp"

namespace palpate::gpu {

inline constexpr std::uint32_t kMaxBindings = 16;  // storage buffers of one kernel; every usable device allows as many

struct Gpu::State {
  explicit State(std::shared_ptr<OpenDevice> device);  // throws vk::SystemError

  // Parent before child: members are destroyed in the opposite order.
  std::shared_ptr<OpenDevice> opened;
  GpuInfo info;
  const vk::raii::PhysicalDevice& physical;
  const vk::raii::Device& device;
  std::uint32_t queue_family;
  bool named;  // debug names are wanted
  vk::raii::CommandPool command_pool = nullptr;
  vk::raii::Semaphore timeline = nullptr;  // counts submissions
  std::uint64_t submitted = 0;             // the value of the newest submission
  std::atomic<bool> failed{false};         // Gpu::failed()
  std::atomic<std::uint64_t> bytes_in_use = 0;

  // What gpu_use.hpp shows. Kernels are shared by all Gpus of a device, and each Gpu counts its own dispatches.
  std::vector<std::shared_ptr<const Kernel::State>> kernels;  // that this Gpu was given, in that order
  std::map<const Kernel::State*, std::uint64_t> dispatches;
  std::map<const Kernel::State*, double> made_s;  // of the pipelines that were made for this Gpu
  std::map<std::string, BufferUse> buffers;
  std::uint64_t peak_bytes = 0;

  void submit(const vk::SubmitInfo& work);  // to the device's queue, which all its Gpus share
  void wait(std::uint64_t value);           // until submission `value` is done; throws Error(kDevice) after 60 s

  template <typename Handle>
  void name(const Handle& handle, const std::string& text) {
    if (!named) return;
    using Native = typename Handle::CType;
    device.setDebugUtilsObjectNameEXT({.objectType = Handle::objectType,
                                       .objectHandle = reinterpret_cast<std::uint64_t>(static_cast<Native>(*handle)),
                                       .pObjectName = text.c_str()});
  }
};

struct Buffer::State {
  Gpu::State* gpu = nullptr;
  std::string name;
  std::size_t bytes = 0;
  vk::raii::DeviceMemory memory = nullptr;  // declared first, so freed last: after the buffer bound to it
  vk::raii::Buffer buffer = nullptr;
  void* mapped = nullptr;

  void count(Gpu::State& by);  // from now on, until it is destroyed
  ~State();
};

struct Kernel::State {
  std::string name;
  std::vector<std::pair<std::string, std::uint32_t>> constants;  // names and values of its specialisation
  std::uint32_t bindings = 0;
  std::uint32_t push_bytes = 0;
  vk::raii::DescriptorSetLayout set_layout = nullptr;
  vk::raii::PipelineLayout layout = nullptr;
  vk::raii::Pipeline pipeline = nullptr;
};

// selection.cpp
[[nodiscard]] vk::raii::Context openLoader();
[[nodiscard]] vk::raii::Instance makeInstance(const vk::raii::Context& context, bool validation);
[[nodiscard]] GpuInfo describe(const vk::raii::PhysicalDevice& physical);
[[nodiscard]] vk::raii::PhysicalDevice choose(const vk::raii::Instance& instance, const std::string& name);
[[nodiscard]] std::optional<std::uint32_t> computeQueueFamily(const vk::raii::PhysicalDevice& physical);

// validation.cpp
[[nodiscard]] vk::raii::DebugUtilsMessengerEXT makeMessenger(const vk::raii::Instance& instance);

}  // namespace palpate::gpu
