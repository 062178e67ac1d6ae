// SPDX-License-Identifier: Apache-2.0
// Which Vulkan device: loader, instance, enumeration, choice.
#include <algorithm>
#include <cctype>
#include <cstring>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr const char* kDriverRemedy =
    "install one: 'apt-get install mesa-vulkan-drivers' brings lavapipe, which runs on the CPU; "
    "for a GPU install its vendor's driver";

Error noDriver(const std::string& reason) {
  return {Error::Code::kNotFound, "Vulkan", reason, kDriverRemedy};
}

int rank(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return 0;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return 1;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return 2;
    case vk::PhysicalDeviceType::eCpu:
      return 3;
    default:
      return 4;
  }
}

std::string typeName(vk::PhysicalDeviceType type) {
  static constexpr const char* kNames[] = {"discrete", "integrated", "virtual", "cpu", "other"};
  return kNames[rank(type)];
}

std::string versionText(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// Best first; devices of one kind stay in the driver's order.
std::vector<vk::raii::PhysicalDevice> rankedDevices(const vk::raii::Instance& instance) {
  std::vector<vk::raii::PhysicalDevice> devices;
  try {
    for (auto& device : vk::raii::PhysicalDevices(instance)) devices.push_back(std::move(device));
  } catch (const vk::SystemError& error) {
    throw noDriver(fmt::format("no device could be listed ({})", error.what()));
  }
  if (devices.empty()) throw noDriver("no driver was found");
  std::stable_sort(devices.begin(), devices.end(), [](const auto& a, const auto& b) {
    return rank(a.getProperties().deviceType) < rank(b.getProperties().deviceType);
  });
  return devices;
}

std::string whyUnusable(const vk::raii::PhysicalDevice& physical, const vk::PhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) {
    return "it offers Vulkan " + versionText(properties.apiVersion) + ", Palpate needs 1.2";
  }
  const auto features =
      physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceTimelineSemaphoreFeatures>();
  if (!features.get<vk::PhysicalDeviceTimelineSemaphoreFeatures>().timelineSemaphore)
    return "it lacks timeline semaphores";
  if (!computeQueueFamily(physical)) return "it has no compute queue";
  if (properties.limits.maxPerStageDescriptorStorageBuffers < kMaxBindings) {
    return fmt::format("a shader may bind only {} storage buffers, Palpate needs {}",
                       properties.limits.maxPerStageDescriptorStorageBuffers, kMaxBindings);
  }
  return {};
}

}  // namespace

vk::raii::Context openLoader() {
  try {
    return vk::raii::Context();
  } catch (const std::exception&) {
    throw noDriver("the Vulkan loader libvulkan.so.1 was not found");
  }
}

vk::raii::Instance makeInstance(const vk::raii::Context& context, bool validation) {
  const vk::ApplicationInfo application{.pApplicationName = "palpate", .apiVersion = VK_API_VERSION_1_2};
  std::vector<const char*> layers, extensions;
  if (validation) {
    const auto available = context.enumerateInstanceLayerProperties();
    if (std::none_of(available.begin(), available.end(),
                     [](const auto& layer) { return std::strcmp(layer.layerName, kValidationLayer) == 0; })) {
      throw Error(Error::Code::kNotFound, kValidationLayer, "the validation layer is not installed",
                  "apt-get install vulkan-validationlayers, or run without PALPATE_VALIDATION");
    }
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }
  const vk::ValidationFeatureEnableEXT synchronization = vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  const vk::ValidationFeaturesEXT features{.enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = &synchronization};
  try {
    return {context, vk::InstanceCreateInfo{.pNext = validation ? &features : nullptr,
                                            .pApplicationInfo = &application,
                                            .enabledLayerCount = static_cast<std::uint32_t>(layers.size()),
                                            .ppEnabledLayerNames = layers.data(),
                                            .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                            .ppEnabledExtensionNames = extensions.data()}};
  } catch (const vk::SystemError& error) {
    throw noDriver(fmt::format("no usable driver was found ({})", error.what()));
  }
}

GpuInfo describe(const vk::raii::PhysicalDevice& physical) {
  const auto chain = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
  const vk::PhysicalDeviceProperties& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  GpuInfo info;
  info.name = properties.deviceName.data();
  info.type = typeName(properties.deviceType);
  info.tuned_as = info.type;
  info.driver = fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data());
  info.api_version = versionText(properties.apiVersion);
  info.max_binding_bytes = properties.limits.maxStorageBufferRange;
  const vk::PhysicalDeviceMemoryProperties memory = physical.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal) {
      info.memory_bytes = std::max<std::uint64_t>(info.memory_bytes, memory.memoryHeaps[i].size);
    }
  }
  info.unusable = whyUnusable(physical, properties);
  return info;
}

std::optional<std::uint32_t> computeQueueFamily(const vk::raii::PhysicalDevice& physical) {
  const auto families = physical.getQueueFamilyProperties();
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    if (families[i].queueFlags & vk::QueueFlagBits::eCompute) return i;
  }
  return std::nullopt;
}

vk::raii::PhysicalDevice choose(const vk::raii::Instance& instance, const std::string& name) {
  std::string seen;
  for (auto& physical : rankedDevices(instance)) {
    const GpuInfo info = describe(physical);
    const bool fits = name.empty() || lower(info.name).find(lower(name)) != std::string::npos;
    if (fits && info.unusable.empty()) return std::move(physical);
    seen += (seen.empty() ? "" : ", ") + info.name + (info.unusable.empty() ? "" : " (" + info.unusable + ")");
  }
  throw Error(Error::Code::kNotFound, name.empty() ? "Vulkan" : "--gpu " + name,
              "no usable device of this name; this machine has: " + seen,
              "choose one with --gpu; 'palpate devices' lists them");
}

std::vector<GpuInfo> listGpus() {
  const vk::raii::Context context = openLoader();
  const vk::raii::Instance instance = makeInstance(context, false);
  std::vector<GpuInfo> infos;
  for (const auto& physical : rankedDevices(instance)) infos.push_back(describe(physical));
  return infos;
}

}  // namespace palpate::gpu
