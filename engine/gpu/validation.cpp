// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/validation.hpp"

#include <cstdlib>
#include <mutex>
#include <string_view>

#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

std::mutex messages_mutex;
std::vector<std::string>& messages() {
  static std::vector<std::string> list;
  return list;
}

VKAPI_ATTR VkBool32 VKAPI_CALL note(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                    const VkDebugUtilsMessengerCallbackDataEXT* data, void*) {
  const std::lock_guard lock(messages_mutex);
  messages().emplace_back(data->pMessage);
  return VK_FALSE;
}

}  // namespace

bool validationWanted() {
  const char* value = std::getenv("PALPATE_VALIDATION");
  return value != nullptr && std::string_view(value) != "0";
}

std::vector<std::string> validationMessages() {
  const std::lock_guard lock(messages_mutex);
  return messages();
}

void clearValidationMessages() {
  const std::lock_guard lock(messages_mutex);
  messages().clear();
}

vk::raii::DebugUtilsMessengerEXT makeMessenger(const vk::raii::Instance& instance) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  return {instance,
          vk::DebugUtilsMessengerCreateInfoEXT{.messageSeverity = Severity::eWarning | Severity::eError,
                                               .messageType = Type::eGeneral | Type::eValidation | Type::ePerformance,
                                               .pfnUserCallback = &note}};
}

}  // namespace palpate::gpu
