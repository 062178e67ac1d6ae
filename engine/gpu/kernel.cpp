// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/kernel.hpp"

#include <algorithm>
#include <functional>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/gpu/spirv_names.hpp"
#include "engine/gpu/vulkan_state.hpp"

namespace palpate::gpu {
namespace {

vk::raii::DescriptorSetLayout makeSetLayout(const vk::raii::Device& device, std::uint32_t count) {
  std::vector<vk::DescriptorSetLayoutBinding> bindings(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    bindings[i] = vk::DescriptorSetLayoutBinding{.binding = i,
                                                 .descriptorType = vk::DescriptorType::eStorageBuffer,
                                                 .descriptorCount = 1,
                                                 .stageFlags = vk::ShaderStageFlagBits::eCompute};
  }
  return {device, vk::DescriptorSetLayoutCreateInfo{.bindingCount = count, .pBindings = bindings.data()}};
}

vk::raii::PipelineLayout makeLayout(const vk::raii::Device& device, const vk::raii::DescriptorSetLayout& set_layout,
                                    std::uint32_t push_bytes) {
  const vk::PushConstantRange push{.stageFlags = vk::ShaderStageFlagBits::eCompute, .offset = 0, .size = push_bytes};
  return {device, vk::PipelineLayoutCreateInfo{.setLayoutCount = 1,
                                               .pSetLayouts = &*set_layout,
                                               .pushConstantRangeCount = push_bytes > 0 ? 1U : 0U,
                                               .pPushConstantRanges = &push}};
}

vk::raii::Pipeline makePipeline(const vk::raii::Device& device, const KernelSpec& spec,
                                const vk::raii::PipelineLayout& layout) {
  const vk::raii::ShaderModule shader(
      device, vk::ShaderModuleCreateInfo{.codeSize = spec.spirv.size_bytes(), .pCode = spec.spirv.data()});
  std::vector<vk::SpecializationMapEntry> entries(spec.specialisation.size());
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    entries[i] = vk::SpecializationMapEntry{.constantID = i, .offset = 4 * i, .size = 4};
  }
  const vk::SpecializationInfo constants{.mapEntryCount = static_cast<std::uint32_t>(entries.size()),
                                         .pMapEntries = entries.data(),
                                         .dataSize = std::span(spec.specialisation).size_bytes(),
                                         .pData = spec.specialisation.data()};
  const vk::PipelineShaderStageCreateInfo stage{.stage = vk::ShaderStageFlagBits::eCompute,
                                                .module = *shader,
                                                .pName = "main",
                                                .pSpecializationInfo = &constants};
  return {device, nullptr, vk::ComputePipelineCreateInfo{.stage = stage, .layout = *layout}};
}

std::vector<std::pair<std::string, std::uint32_t>> constantsOf(const KernelSpec& spec) {
  std::vector<std::pair<std::string, std::uint32_t>> constants;
  for (const auto& [id, name] : constantNames(spec.spirv)) {
    if (id < spec.specialisation.size()) constants.emplace_back(name, spec.specialisation[id]);
  }
  return constants;
}

OpenDevice::KernelKey keyOf(const KernelSpec& spec) {
  const std::string_view bytes(reinterpret_cast<const char*>(spec.spirv.data()), spec.spirv.size_bytes());
  return {spec.name,           spec.bindings, spec.push_bytes,
          spec.specialisation, bytes.size(),  std::hash<std::string_view>()(bytes)};
}

}  // namespace

Kernel::Kernel(Gpu& gpu, const KernelSpec& spec) {
  Gpu::State& vulkan = gpu.state();
  const std::lock_guard lock(vulkan.opened->one_at_a_time);
  std::shared_ptr<const State>& known = vulkan.opened->kernels[keyOf(spec)];
  if (!known) {
    auto made = std::make_shared<State>();
    made->name = spec.name;
    made->bindings = spec.bindings;
    made->push_bytes = spec.push_bytes;
    made->constants = constantsOf(spec);
    const Stopwatch watch;
    try {
      made->set_layout = makeSetLayout(vulkan.device, spec.bindings);
      made->layout = makeLayout(vulkan.device, made->set_layout, spec.push_bytes);
      made->pipeline = makePipeline(vulkan.device, spec, made->layout);
    } catch (const vk::SystemError& error) {
      throw Error(Error::Code::kDevice, "kernel " + spec.name,
                  fmt::format("{} refused it ({})", vulkan.info.name, error.what()),
                  "choose another device with --gpu");
    }
    vulkan.name(made->pipeline, spec.name);
    vulkan.made_s[made.get()] = watch.seconds();
    known = std::move(made);
  }
  state_ = known;
  if (std::ranges::find(vulkan.kernels, state_) == vulkan.kernels.end()) vulkan.kernels.push_back(state_);
}

Kernel::~Kernel() = default;
Kernel::Kernel(Kernel&&) noexcept = default;
Kernel& Kernel::operator=(Kernel&&) noexcept = default;

}  // namespace palpate::gpu
