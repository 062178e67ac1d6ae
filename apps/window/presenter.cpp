// SPDX-License-Identifier: Apache-2.0
#include "apps/window/presenter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <backends/imgui_impl_vulkan.h>
#include <fmt/format.h>
#include <vulkan/vulkan_raii.hpp>

// After Vulkan's headers, so that it declares the surface.
#include <GLFW/glfw3.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t kSlots = 2;  // frames that the processor may be ahead of the display
constexpr std::uint64_t kLongest_ns = 10'000'000'000;
constexpr std::uint64_t kMoment_ns = 100'000'000;  // a display may hand out no image while the window is hidden
constexpr int kTries = 3;                          // to get an image of a window that changes
constexpr vk::Format kFormats[] = {vk::Format::eB8G8R8A8Unorm, vk::Format::eR8G8B8A8Unorm};
// Copies into the window's image come between its hand-over and the panels.
constexpr vk::ImageUsageFlags kUsage = vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferDst |
                                       vk::ImageUsageFlagBits::eTransferSrc;

[[noreturn]] void fail(const std::string& what, const std::string& why) {
  throw Error(Error::Code::kDevice, "the window", fmt::format("{} ({})", what, why),
              "try another Vulkan device with --gpu, or update its driver");
}

// The queue family of a device that can draw and show; empty: it cannot.
std::optional<std::uint32_t> familyFor(const vk::raii::PhysicalDevice& device, const vk::raii::SurfaceKHR& surface) {
  bool has_swapchain = false;
  for (const vk::ExtensionProperties& extension : device.enumerateDeviceExtensionProperties())
    has_swapchain |= std::string(extension.extensionName.data()) == VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  if (!has_swapchain) return std::nullopt;
  const auto families = device.getQueueFamilyProperties();
  for (std::uint32_t family = 0; family < families.size(); ++family) {
    const bool draws = static_cast<bool>(families[family].queueFlags & vk::QueueFlagBits::eGraphics);
    if (draws && device.getSurfaceSupportKHR(family, *surface) == VK_TRUE) return family;
  }
  return std::nullopt;
}

struct HostBuffer {
  vk::raii::DeviceMemory memory = nullptr;
  vk::raii::Buffer buffer = nullptr;
  std::size_t bytes = 0;
  void* mapped = nullptr;
};

// What belongs to one frame until the display has it.
struct Slot {
  vk::raii::CommandPool pool = nullptr;
  vk::raii::CommandBuffer commands = nullptr;
  vk::raii::Fence done = nullptr;
  vk::raii::Semaphore acquired = nullptr;
  HostBuffer picture;
};

struct Shown {
  vk::Image image;
  vk::raii::ImageView view = nullptr;
  vk::raii::Framebuffer framebuffer = nullptr;
  vk::raii::Semaphore drawn = nullptr;
};

}  // namespace

struct Presenter::State {
  State(GLFWwindow* of, const std::string& gpu);
  ~State();

  void makeSurface();
  void makeRenderPass();
  void makeSwapchain();
  void startImGui();
  void uploadFonts();
  HostBuffer makeBuffer(std::size_t bytes) const;
  void fill(HostBuffer& buffer, const PlacedPicture& picture, const float (&background)[3]);
  std::optional<std::uint32_t> acquire(Slot& slot);
  void record(Slot& slot, const Shown& shown, const float (&background)[3], const PlacedPicture& picture,
              ImDrawData* panels, const HostBuffer* captured);
  bool present(const float (&background)[3], const PlacedPicture& picture, ImDrawData* panels, HostBuffer* captured);
  RenderedImage imageOf(const HostBuffer& captured) const;

  GLFWwindow* window;
  vk::raii::Context context;
  vk::raii::Instance instance = nullptr;
  vk::raii::SurfaceKHR surface = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  std::string name;
  std::uint32_t family = 0;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  vk::raii::DescriptorPool descriptors = nullptr;
  vk::SurfaceFormatKHR format{};
  vk::raii::RenderPass pass = nullptr;
  vk::raii::SwapchainKHR swapchain = nullptr;
  vk::Extent2D extent{};
  std::vector<Shown> shown;
  std::array<Slot, kSlots> slots;
  std::size_t next_slot = 0;
  bool stale = true;  // the swapchain does not fit the window any more
  bool lost = false;  // nor does the surface
  int surfaces = 0;   // made so far
  bool has_imgui = false;
};

Presenter::State::State(GLFWwindow* of, const std::string& gpu) : window(of) {
  std::uint32_t count = 0;
  const char** extensions = glfwGetRequiredInstanceExtensions(&count);
  if (extensions == nullptr) fail("Vulkan cannot show anything here", "no extension for this display");
  const vk::ApplicationInfo application{.pApplicationName = "palpate", .apiVersion = VK_API_VERSION_1_1};
  instance = {context, vk::InstanceCreateInfo{.pApplicationInfo = &application,
                                              .enabledExtensionCount = count,
                                              .ppEnabledExtensionNames = extensions}};
  makeSurface();
  std::string asked;
  for (const vk::raii::PhysicalDevice& candidate : vk::raii::PhysicalDevices(instance)) {
    const auto found = familyFor(candidate, surface);
    if (!found) continue;
    const std::string its_name = candidate.getProperties().deviceName.data();
    if (!name.empty() && (gpu.empty() || its_name.find(gpu) == std::string::npos)) continue;
    physical = candidate;
    name = its_name;
    family = *found;
    if (!gpu.empty() && its_name.find(gpu) != std::string::npos) break;
  }
  if (name.empty()) fail("no Vulkan device can show in it", "none has a queue for this display");

  const float priority = 1;
  const vk::DeviceQueueCreateInfo queues{.queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
  const char* const swapchain_extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  device = {physical, vk::DeviceCreateInfo{.queueCreateInfoCount = 1,
                                           .pQueueCreateInfos = &queues,
                                           .enabledExtensionCount = 1,
                                           .ppEnabledExtensionNames = &swapchain_extension}};
  queue = {device, family, 0};
  const vk::DescriptorPoolSize size{.type = vk::DescriptorType::eCombinedImageSampler, .descriptorCount = 4};
  descriptors = {device, vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                      .maxSets = 4,
                                                      .poolSizeCount = 1,
                                                      .pPoolSizes = &size}};
  for (Slot& slot : slots) {
    slot.pool = {device, vk::CommandPoolCreateInfo{.queueFamilyIndex = family}};
    slot.commands = std::move(vk::raii::CommandBuffers(
        device, vk::CommandBufferAllocateInfo{.commandPool = *slot.pool, .commandBufferCount = 1})[0]);
    slot.done = {device, vk::FenceCreateInfo{.flags = vk::FenceCreateFlagBits::eSignaled}};
    slot.acquired = {device, vk::SemaphoreCreateInfo{}};
  }
  const auto formats = physical.getSurfaceFormatsKHR(*surface);
  const auto* wanted = std::find_if(std::begin(kFormats), std::end(kFormats), [&](vk::Format one) {
    return std::any_of(formats.begin(), formats.end(), [&](const auto& f) { return f.format == one; });
  });
  if (wanted == std::end(kFormats)) fail("its pixels have no known form", "neither BGRA nor RGBA of 8 bits");
  format = {*wanted, vk::ColorSpaceKHR::eSrgbNonlinear};
  makeRenderPass();
  makeSwapchain();
  startImGui();
}

Presenter::State::~State() {
  if (*device == vk::Device{}) return;
  try {
    device.waitIdle();
  } catch (const vk::SystemError&) {  // a lost device has nothing under way
  }
  if (has_imgui) ImGui_ImplVulkan_Shutdown();
}

void Presenter::State::makeSurface() {
  VkSurfaceKHR made = VK_NULL_HANDLE;
  if (const VkResult result = glfwCreateWindowSurface(*instance, window, nullptr, &made); result != VK_SUCCESS)
    fail("Vulkan cannot show in it", vk::to_string(static_cast<vk::Result>(result)));
  surface = {instance, made};
  ++surfaces;
}

void Presenter::State::makeRenderPass() {
  const vk::AttachmentDescription colour{.format = format.format,
                                         .samples = vk::SampleCountFlagBits::e1,
                                         .loadOp = vk::AttachmentLoadOp::eLoad,
                                         .storeOp = vk::AttachmentStoreOp::eStore,
                                         .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                                         .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                         .initialLayout = vk::ImageLayout::eTransferDstOptimal,
                                         .finalLayout = vk::ImageLayout::ePresentSrcKHR};
  const vk::AttachmentReference reference{.attachment = 0, .layout = vk::ImageLayout::eColorAttachmentOptimal};
  const vk::SubpassDescription subpass{.pipelineBindPoint = vk::PipelineBindPoint::eGraphics,
                                       .colorAttachmentCount = 1,
                                       .pColorAttachments = &reference};
  const vk::SubpassDependency after_copy{
      .srcSubpass = VK_SUBPASS_EXTERNAL,
      .dstSubpass = 0,
      .srcStageMask = vk::PipelineStageFlagBits::eTransfer,
      .dstStageMask = vk::PipelineStageFlagBits::eColorAttachmentOutput,
      .srcAccessMask = vk::AccessFlagBits::eTransferWrite,
      .dstAccessMask = vk::AccessFlagBits::eColorAttachmentRead | vk::AccessFlagBits::eColorAttachmentWrite};
  pass = {device, vk::RenderPassCreateInfo{.attachmentCount = 1,
                                           .pAttachments = &colour,
                                           .subpassCount = 1,
                                           .pSubpasses = &subpass,
                                           .dependencyCount = 1,
                                           .pDependencies = &after_copy}};
}

void Presenter::State::makeSwapchain() {
  device.waitIdle();
  shown.clear();
  if (lost) {
    swapchain = nullptr;  // goes before its surface
    surface = nullptr;
    makeSurface();
    if (physical.getSurfaceSupportKHR(family, *surface) != VK_TRUE)
      fail("its new surface cannot be shown", "the device's queue is for another display");
    lost = false;
  }
  const vk::SurfaceCapabilitiesKHR able = physical.getSurfaceCapabilitiesKHR(*surface);
  extent = able.currentExtent;
  if (extent.width == std::numeric_limits<std::uint32_t>::max()) {  // the window takes the size that it is given
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    extent.width = std::clamp(static_cast<std::uint32_t>(width), able.minImageExtent.width, able.maxImageExtent.width);
    extent.height =
        std::clamp(static_cast<std::uint32_t>(height), able.minImageExtent.height, able.maxImageExtent.height);
  }
  if ((able.supportedUsageFlags & kUsage) != kUsage)
    fail("nothing can be copied into it", "its images are for drawing only");
  std::uint32_t images = std::max(able.minImageCount, 2U);
  if (able.maxImageCount > 0) images = std::min(images, able.maxImageCount);
  vk::raii::SwapchainKHR next(device,
                              vk::SwapchainCreateInfoKHR{.surface = *surface,
                                                         .minImageCount = images,
                                                         .imageFormat = format.format,
                                                         .imageColorSpace = format.colorSpace,
                                                         .imageExtent = extent,
                                                         .imageArrayLayers = 1,
                                                         .imageUsage = kUsage,
                                                         .imageSharingMode = vk::SharingMode::eExclusive,
                                                         .preTransform = able.currentTransform,
                                                         .compositeAlpha = vk::CompositeAlphaFlagBitsKHR::eOpaque,
                                                         .presentMode = vk::PresentModeKHR::eFifo,
                                                         .clipped = VK_TRUE,
                                                         .oldSwapchain = *swapchain});
  swapchain = std::move(next);
  for (const auto& image : swapchain.getImages()) {
    Shown one;
    one.image = vk::Image(image);
    one.view = {device, vk::ImageViewCreateInfo{.image = one.image,
                                                .viewType = vk::ImageViewType::e2D,
                                                .format = format.format,
                                                .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1}}};
    const vk::ImageView view = *one.view;
    one.framebuffer = {device, vk::FramebufferCreateInfo{.renderPass = *pass,
                                                         .attachmentCount = 1,
                                                         .pAttachments = &view,
                                                         .width = extent.width,
                                                         .height = extent.height,
                                                         .layers = 1}};
    one.drawn = {device, vk::SemaphoreCreateInfo{}};
    shown.push_back(std::move(one));
  }
  stale = false;
}

void Presenter::State::startImGui() {
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = *instance;
  info.PhysicalDevice = *physical;
  info.Device = *device;
  info.QueueFamily = family;
  info.Queue = *queue;
  info.DescriptorPool = *descriptors;
  info.MinImageCount = 2;
  info.ImageCount = std::max<std::uint32_t>(2, static_cast<std::uint32_t>(shown.size()));
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  has_imgui = ImGui_ImplVulkan_Init(&info, *pass);
  if (!has_imgui) fail("its panels cannot be drawn", "ImGui's renderer was refused");
  uploadFonts();
}

void Presenter::State::uploadFonts() {
  device.waitIdle();
  Slot& slot = slots.front();
  slot.pool.reset();
  slot.commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  ImGui_ImplVulkan_CreateFontsTexture(*slot.commands);
  slot.commands.end();
  const vk::CommandBuffer commands = *slot.commands;
  queue.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &commands});
  device.waitIdle();
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

HostBuffer Presenter::State::makeBuffer(std::size_t bytes) const {
  HostBuffer made;
  made.bytes = bytes;
  made.buffer = {device, vk::BufferCreateInfo{
                             .size = bytes,
                             .usage = vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst}};
  const vk::MemoryRequirements needs = made.buffer.getMemoryRequirements();
  const vk::PhysicalDeviceMemoryProperties memory = physical.getMemoryProperties();
  constexpr auto kWanted = vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent;
  std::uint32_t type = 0;
  while (type < memory.memoryTypeCount &&
         ((needs.memoryTypeBits >> type & 1U) == 0 || (memory.memoryTypes[type].propertyFlags & kWanted) != kWanted)) {
    ++type;
  }
  if (type == memory.memoryTypeCount) fail("no picture can be copied into it", "no memory that both sides see");
  made.memory = {device, vk::MemoryAllocateInfo{.allocationSize = needs.size, .memoryTypeIndex = type}};
  made.buffer.bindMemory(*made.memory, 0);
  made.mapped = made.memory.mapMemory(0, bytes);
  return made;
}

// Colours in the window's order, before the background; what they hide of the desktop counts for nothing.
void Presenter::State::fill(HostBuffer& buffer, const PlacedPicture& picture, const float (&background)[3]) {
  const std::size_t bytes = 4 * picture.pixels->size();
  if (buffer.bytes != bytes) buffer = makeBuffer(bytes);
  auto* to = static_cast<std::uint32_t*>(buffer.mapped);
  const bool swaps = format.format == vk::Format::eB8G8R8A8Unorm;
  std::uint32_t nothing = 0xFF000000U;
  for (int i = 0; i < 3; ++i) nothing |= static_cast<std::uint32_t>(std::lround(255 * background[i])) << 8 * i;
  for (const layout::PicturePixel& pixel : *picture.pixels) {
    const std::uint32_t c = pixel.rgba >> 24U == 255 ? pixel.rgba : layout::pictureOver(pixel.rgba, nothing);
    *to++ = swaps ? (c & 0xFF00FF00U) | (c >> 16U & 0xFFU) | (c & 0xFFU) << 16U : c;
  }
}

// Empty: the window takes no frame now.
std::optional<std::uint32_t> Presenter::State::acquire(Slot& slot) {
  const int surfaces_before = surfaces;
  for (int tries = 0; tries < kTries; ++tries) {
    try {
      if (stale || lost) makeSwapchain();
      const auto [result, image] = swapchain.acquireNextImage(kMoment_ns, *slot.acquired);
      if (result == vk::Result::eTimeout) return std::nullopt;
      stale = result == vk::Result::eSuboptimalKHR;  // this frame is still shown
      return image;
    } catch (const vk::OutOfDateKHRError&) {
      stale = true;
    } catch (const vk::SurfaceLostKHRError&) {
      lost = true;
    }
  }
  if (lost && surfaces > surfaces_before) fail("its surface is lost", "and so was a new one");
  return std::nullopt;  // it is being resized: the next frame comes
}

void Presenter::State::record(Slot& slot, const Shown& to, const float (&background)[3], const PlacedPicture& picture,
                              ImDrawData* panels, const HostBuffer* captured) {
  const vk::raii::CommandBuffer& commands = slot.commands;
  const vk::ImageSubresourceRange all{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};
  const auto barrier = [&](vk::AccessFlags from, vk::AccessFlags into, vk::ImageLayout before, vk::ImageLayout after,
                           vk::PipelineStageFlags first, vk::PipelineStageFlags then) {
    const vk::ImageMemoryBarrier change{.srcAccessMask = from,
                                        .dstAccessMask = into,
                                        .oldLayout = before,
                                        .newLayout = after,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = to.image,
                                        .subresourceRange = all};
    commands.pipelineBarrier(first, then, {}, {}, {}, change);
  };
  using Access = vk::AccessFlagBits;
  using Layout = vk::ImageLayout;
  using Stage = vk::PipelineStageFlagBits;
  slot.pool.reset();
  commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  barrier({}, Access::eTransferWrite, Layout::eUndefined, Layout::eTransferDstOptimal, Stage::eTransfer,
          Stage::eTransfer);
  const vk::ClearColorValue colour(std::array<float, 4>{background[0], background[1], background[2], 1});
  commands.clearColorImage(to.image, Layout::eTransferDstOptimal, colour, all);
  const int first_x = std::max(picture.x, 0), first_y = std::max(picture.y, 0);
  const int end_x = std::min(picture.x + picture.width, static_cast<int>(extent.width));
  const int end_y = std::min(picture.y + picture.height, static_cast<int>(extent.height));
  if (picture.pixels != nullptr && end_x > first_x && end_y > first_y) {
    barrier(Access::eTransferWrite, Access::eTransferWrite, Layout::eTransferDstOptimal, Layout::eTransferDstOptimal,
            Stage::eTransfer, Stage::eTransfer);
    const auto skipped = static_cast<vk::DeviceSize>(first_y - picture.y) * static_cast<vk::DeviceSize>(picture.width) +
                         static_cast<vk::DeviceSize>(first_x - picture.x);
    const vk::BufferImageCopy region{
        .bufferOffset = 4 * skipped,
        .bufferRowLength = static_cast<std::uint32_t>(picture.width),
        .imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
        .imageOffset = {first_x, first_y, 0},
        .imageExtent = {static_cast<std::uint32_t>(end_x - first_x), static_cast<std::uint32_t>(end_y - first_y), 1}};
    commands.copyBufferToImage(*slot.picture.buffer, to.image, Layout::eTransferDstOptimal, region);
  }
  commands.beginRenderPass({.renderPass = *pass, .framebuffer = *to.framebuffer, .renderArea = {{0, 0}, extent}},
                           vk::SubpassContents::eInline);
  ImGui_ImplVulkan_RenderDrawData(panels, *commands);
  commands.endRenderPass();
  if (captured != nullptr) {
    barrier(Access::eColorAttachmentWrite, Access::eTransferRead, Layout::ePresentSrcKHR, Layout::eTransferSrcOptimal,
            Stage::eColorAttachmentOutput, Stage::eTransfer);
    const vk::BufferImageCopy whole{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                    .imageExtent = {extent.width, extent.height, 1}};
    commands.copyImageToBuffer(to.image, Layout::eTransferSrcOptimal, *captured->buffer, whole);
    barrier(Access::eTransferRead, {}, Layout::eTransferSrcOptimal, Layout::ePresentSrcKHR, Stage::eTransfer,
            Stage::eBottomOfPipe);
    const vk::MemoryBarrier to_host{.srcAccessMask = Access::eTransferWrite, .dstAccessMask = Access::eHostRead};
    commands.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, to_host, {}, {});
  }
  commands.end();
}

bool Presenter::State::present(const float (&background)[3], const PlacedPicture& picture, ImDrawData* panels,
                               HostBuffer* captured) {
  Slot& slot = slots[next_slot];
  if (device.waitForFences(*slot.done, VK_TRUE, kLongest_ns) != vk::Result::eSuccess)
    fail("the device does not finish a frame", "10 s have passed");
  const auto image = acquire(slot);
  if (!image) return false;
  next_slot = (next_slot + 1) % kSlots;
  if (picture.pixels != nullptr && !picture.pixels->empty()) fill(slot.picture, picture, background);
  if (captured != nullptr) *captured = makeBuffer(std::size_t{4} * extent.width * extent.height);
  PlacedPicture placed = picture;
  if (picture.pixels != nullptr && picture.pixels->empty()) placed.pixels = nullptr;
  const Shown& to = shown[*image];
  record(slot, to, background, placed, panels, captured);
  device.resetFences(*slot.done);
  const vk::PipelineStageFlags waits = vk::PipelineStageFlagBits::eTransfer;
  const vk::Semaphore acquired = *slot.acquired, drawn = *to.drawn;
  const vk::CommandBuffer commands = *slot.commands;
  queue.submit(vk::SubmitInfo{.waitSemaphoreCount = 1,
                              .pWaitSemaphores = &acquired,
                              .pWaitDstStageMask = &waits,
                              .commandBufferCount = 1,
                              .pCommandBuffers = &commands,
                              .signalSemaphoreCount = 1,
                              .pSignalSemaphores = &drawn},
               *slot.done);
  const vk::SwapchainKHR chain = *swapchain;
  try {
    const vk::Result result = queue.presentKHR({.waitSemaphoreCount = 1,
                                                .pWaitSemaphores = &drawn,
                                                .swapchainCount = 1,
                                                .pSwapchains = &chain,
                                                .pImageIndices = &*image});
    if (result == vk::Result::eSuboptimalKHR) stale = true;
  } catch (const vk::OutOfDateKHRError&) {
    stale = true;
  } catch (const vk::SurfaceLostKHRError&) {
    lost = true;
  }
  if (captured != nullptr && device.waitForFences(*slot.done, VK_TRUE, kLongest_ns) != vk::Result::eSuccess)
    fail("the device does not finish a frame", "10 s have passed");
  return true;
}

RenderedImage Presenter::State::imageOf(const HostBuffer& captured) const {
  RenderedImage image{static_cast<int>(extent.width), static_cast<int>(extent.height), {}, {}};
  image.rgba.resize(captured.bytes);
  std::memcpy(image.rgba.data(), captured.mapped, captured.bytes);
  image.distance_m.assign(captured.bytes / 4, std::numeric_limits<float>::infinity());
  if (format.format == vk::Format::eB8G8R8A8Unorm) {
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) std::swap(image.rgba[i], image.rgba[i + 2]);
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

namespace {

template <typename Work>
auto asErrors(const Work& work) {
  try {
    return work();
  } catch (const vk::SystemError& error) {
    fail("Vulkan failed while it was shown", error.what());
  }
}

}  // namespace

Presenter::Presenter(GLFWwindow* window, const std::string& gpu)
    : state_(asErrors([&] { return std::make_unique<State>(window, gpu); })) {}

Presenter::~Presenter() = default;

const std::string& Presenter::device() const noexcept {
  return state_->name;
}

bool Presenter::present(const float (&background)[3], const PlacedPicture& picture, ImDrawData* panels) {
  return asErrors([&] { return state_->present(background, picture, panels, nullptr); });
}

std::optional<RenderedImage> Presenter::capture(const float (&background)[3], const PlacedPicture& picture,
                                                ImDrawData* panels) {
  return asErrors([&]() -> std::optional<RenderedImage> {
    HostBuffer captured;
    if (!state_->present(background, picture, panels, &captured)) return std::nullopt;
    return state_->imageOf(captured);
  });
}

void Presenter::renewFonts() {
  asErrors([&] { state_->uploadFonts(); });
}

}  // namespace palpate
