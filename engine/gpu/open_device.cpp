// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/open_device.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

// To whose multiples the driver takes memory of the host (VK_EXT_external_memory_host); 0: it takes none.
std::size_t importBytes(const vk::raii::PhysicalDevice& physical) {
  const auto extensions = physical.enumerateDeviceExtensionProperties();
  const bool offered = std::any_of(extensions.begin(), extensions.end(), [](const auto& extension) {
    return std::strcmp(extension.extensionName, VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME) == 0;
  });
  if (!offered) return 0;
  const auto chain =
      physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceExternalMemoryHostPropertiesEXT>();
  return chain.get<vk::PhysicalDeviceExternalMemoryHostPropertiesEXT>().minImportedHostPointerAlignment;
}

void open(OpenDevice& opened, const std::string& name, bool validation) {
  opened.context = openLoader();
  opened.instance = makeInstance(opened.context, validation);
  if (validation) opened.messenger = makeMessenger(opened.instance);
  opened.physical = choose(opened.instance, name);
  opened.info = describe(opened.physical);
  opened.named = validation;
  opened.queue_family = computeQueueFamily(opened.physical).value();
  const float priority = 1.0F;
  const vk::DeviceQueueCreateInfo queue{
      .queueFamilyIndex = opened.queue_family, .queueCount = 1, .pQueuePriorities = &priority};
  const vk::PhysicalDeviceTimelineSemaphoreFeatures timeline{.timelineSemaphore = VK_TRUE};
  opened.import_bytes = importBytes(opened.physical);
  const char* const imports = VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME;
  opened.device = {opened.physical, vk::DeviceCreateInfo{.pNext = &timeline,
                                                         .queueCreateInfoCount = 1,
                                                         .pQueueCreateInfos = &queue,
                                                         .enabledExtensionCount = opened.import_bytes > 0 ? 1U : 0U,
                                                         .ppEnabledExtensionNames = &imports}};
  opened.queue = {opened.device, opened.queue_family, 0};
}

}  // namespace

std::shared_ptr<OpenDevice> openDevice(const std::string& name, bool validation) {
  static std::mutex one_at_a_time;
  static std::map<std::pair<std::string, bool>, std::weak_ptr<OpenDevice>> devices;
  const std::lock_guard lock(one_at_a_time);
  std::weak_ptr<OpenDevice>& known = devices[{name, validation}];
  if (std::shared_ptr<OpenDevice> opened = known.lock()) return opened;
  auto opened = std::make_shared<OpenDevice>();
  try {
    open(*opened, name, validation);
  } catch (const vk::SystemError& error) {
    throw Error(Error::Code::kDevice, opened->info.name.empty() ? "Vulkan" : opened->info.name,
                fmt::format("the driver refused to open the device ({})", error.what()),
                "try another one with --gpu; 'palpate devices' lists them");
  }
  known = opened;
  return opened;
}

}  // namespace palpate::gpu
