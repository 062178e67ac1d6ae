// SPDX-License-Identifier: Apache-2.0
// A Vulkan layer that loses surfaces and devices, and has no memory left. Whenever the file that PALPATE_VULKAN_FAULT
// names is there, the next call that its first line names fails as it says: "acquire -1000000000"
// (VK_ERROR_SURFACE_LOST_KHR), "allocate -2" (VK_ERROR_OUT_OF_DEVICE_MEMORY). A third word, a number, lets so many of
// these calls pass before: "submit -4 50" (VK_ERROR_DEVICE_LOST). The file then has its other lines, or is removed.
// A surface that is lost stays so until it is destroyed, and devices are lost until another one is made.
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <string>

#include <unistd.h>
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

namespace {

struct Next {
  VkInstance instance = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr of_instance = nullptr;
  PFN_vkGetDeviceProcAddr of_device = nullptr;
};

std::atomic<bool> surface_is_lost = false, device_is_lost = false;
std::atomic<int> passed = 0;  // calls of the kind that the file names
std::mutex next_mutex;
// Of each instance, looked up while it is made: later the loader gives the chain's first function, not the next one.
std::map<VkInstance, PFN_vkDestroySurfaceKHR> next_destroy_surface;
std::map<void*, Next> next_of;  // by the loader's table, which an object and its children share

template <typename Handle>
Next& nextOf(Handle handle) {
  const std::lock_guard lock(next_mutex);
  return next_of[*reinterpret_cast<void**>(handle)];
}

// Of a device or its queue.
template <typename Function, typename Handle>
Function functionOf(Handle handle, const char* name) {
  const Next& next = nextOf(handle);
  return reinterpret_cast<Function>(next.of_device(next.device, name));
}

// What is to become of this call.
VkResult faultOf(const std::string& call) {
  const char* name = std::getenv("PALPATE_VULKAN_FAULT");
  if (name == nullptr) return VK_SUCCESS;
  std::ifstream file(name);
  std::string which;
  int result = VK_SUCCESS;
  if (!(file >> which >> result) || which != call) return VK_SUCCESS;
  int may_pass = 0;
  if (file >> may_pass && passed++ < may_pass) return VK_SUCCESS;
  file.clear();
  const std::string others{std::istreambuf_iterator<char>(file), {}};
  const std::size_t next = others.find_first_not_of(" \n");
  next == std::string::npos ? static_cast<void>(unlink(name))
                            : static_cast<void>(std::ofstream(name) << others.substr(next));
  if (call == "submit") device_is_lost = true;
  if (result == VK_ERROR_SURFACE_LOST_KHR) surface_is_lost = true;
  return static_cast<VkResult>(result);
}

template <typename Info>
VkLayerInstanceCreateInfo* link(const Info* info, VkStructureType type) {
  auto* one = const_cast<VkBaseOutStructure*>(static_cast<const VkBaseOutStructure*>(info->pNext));
  for (; one != nullptr; one = one->pNext) {
    auto* candidate = reinterpret_cast<VkLayerInstanceCreateInfo*>(one);
    if (one->sType == type && candidate->function == VK_LAYER_LINK_INFO) return candidate;
  }
  return nullptr;
}

VkResult createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator, VkInstance* made) {
  auto* chain = link(info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  const PFN_vkGetInstanceProcAddr next = chain->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  chain->u.pLayerInfo = chain->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, made);
  if (result != VK_SUCCESS) return result;
  nextOf(*made) = {*made, VK_NULL_HANDLE, next, nullptr};
  const std::lock_guard lock(next_mutex);
  next_destroy_surface[*made] = reinterpret_cast<PFN_vkDestroySurfaceKHR>(next(*made, "vkDestroySurfaceKHR"));
  return result;
}

VkResult createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info, const VkAllocationCallbacks* allocator,
                      VkDevice* made) {
  auto* chain = reinterpret_cast<VkLayerDeviceCreateInfo*>(link(info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO));
  const auto [instance_next, device_next] =
      std::pair(chain->u.pLayerInfo->pfnNextGetInstanceProcAddr, chain->u.pLayerInfo->pfnNextGetDeviceProcAddr);
  chain->u.pLayerInfo = chain->u.pLayerInfo->pNext;
  const VkInstance instance = nextOf(physical).instance;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(instance_next(instance, "vkCreateDevice"));
  const VkResult result = create(physical, info, allocator, made);
  if (result == VK_SUCCESS) nextOf(*made) = {instance, *made, nullptr, device_next};
  device_is_lost = false;
  return result;
}

VkResult acquire(VkDevice device, VkSwapchainKHR swapchain, std::uint64_t timeout, VkSemaphore semaphore, VkFence fence,
                 std::uint32_t* image) {
  if (const VkResult fault = faultOf("acquire"); fault != VK_SUCCESS) return fault;
  if (surface_is_lost) return VK_ERROR_SURFACE_LOST_KHR;
  const auto call = functionOf<PFN_vkAcquireNextImageKHR>(device, "vkAcquireNextImageKHR");
  return call(device, swapchain, timeout, semaphore, fence, image);
}

// A frame that fails to show has still waited for its semaphores.
VkResult present(VkQueue queue, const VkPresentInfoKHR* info) {
  const VkResult result = functionOf<PFN_vkQueuePresentKHR>(queue, "vkQueuePresentKHR")(queue, info);
  const VkResult fault = faultOf("present");
  return fault == VK_SUCCESS ? result : fault;
}

VkResult submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* infos, VkFence fence) {
  if (const VkResult fault = faultOf("submit"); fault != VK_SUCCESS) return fault;
  if (device_is_lost) return VK_ERROR_DEVICE_LOST;
  return functionOf<PFN_vkQueueSubmit>(queue, "vkQueueSubmit")(queue, count, infos, fence);
}

VkResult allocate(VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* allocator,
                  VkDeviceMemory* memory) {
  if (const VkResult fault = faultOf("allocate"); fault != VK_SUCCESS) return fault;
  return functionOf<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, info, allocator, memory);
}

// "wait 2" (VK_TIMEOUT): a kernel that does not end.
VkResult waitSemaphores(VkDevice device, const VkSemaphoreWaitInfo* until, std::uint64_t timeout) {
  if (const VkResult fault = faultOf("wait"); fault != VK_SUCCESS) return fault;
  return functionOf<PFN_vkWaitSemaphores>(device, "vkWaitSemaphores")(device, until, timeout);
}

VkResult createSwapchain(VkDevice device, const VkSwapchainCreateInfoKHR* info, const VkAllocationCallbacks* allocator,
                         VkSwapchainKHR* made) {
  if (surface_is_lost) return VK_ERROR_SURFACE_LOST_KHR;
  return functionOf<PFN_vkCreateSwapchainKHR>(device, "vkCreateSwapchainKHR")(device, info, allocator, made);
}

void destroySurface(VkInstance instance, VkSurfaceKHR surface, const VkAllocationCallbacks* allocator) {
  surface_is_lost = false;
  const std::lock_guard lock(next_mutex);
  next_destroy_surface.at(instance)(instance, surface, allocator);
}

PFN_vkVoidFunction ours(const char* name) {
  const auto is = [&](const char* one) { return std::strcmp(name, one) == 0; };
  if (is("vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (is("vkCreateDevice")) return reinterpret_cast<PFN_vkVoidFunction>(createDevice);
  if (is("vkAcquireNextImageKHR")) return reinterpret_cast<PFN_vkVoidFunction>(acquire);
  if (is("vkCreateSwapchainKHR")) return reinterpret_cast<PFN_vkVoidFunction>(createSwapchain);
  if (is("vkDestroySurfaceKHR")) return reinterpret_cast<PFN_vkVoidFunction>(destroySurface);
  if (is("vkWaitSemaphores")) return reinterpret_cast<PFN_vkVoidFunction>(waitSemaphores);
  if (is("vkAllocateMemory")) return reinterpret_cast<PFN_vkVoidFunction>(allocate);
  if (is("vkQueueSubmit")) return reinterpret_cast<PFN_vkVoidFunction>(submit);
  if (is("vkQueuePresentKHR")) return reinterpret_cast<PFN_vkVoidFunction>(present);
  return nullptr;
}

PFN_vkVoidFunction deviceFunction(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(deviceFunction);
  if (const PFN_vkVoidFunction one = ours(name)) return one;
  return nextOf(device).of_device(device, name);
}

PFN_vkVoidFunction instanceFunction(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetInstanceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(instanceFunction);
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(deviceFunction);
  if (const PFN_vkVoidFunction one = ours(name)) return one;
  return instance == VK_NULL_HANDLE ? nullptr : nextOf(instance).of_instance(instance, name);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult vkNegotiateLoaderLayerInterfaceVersion(
    VkNegotiateLayerInterface* wanted) {
  wanted->loaderLayerInterfaceVersion = 2;
  wanted->pfnGetInstanceProcAddr = instanceFunction;
  wanted->pfnGetDeviceProcAddr = deviceFunction;
  wanted->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
