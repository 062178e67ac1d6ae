// SPDX-License-Identifier: Apache-2.0
// Choosing and opening a device, and the refusals on the way.
#include "engine/gpu/gpu.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/kernel.hpp"

namespace palpate::gpu {
namespace {

using testing::HasSubstr;

template <typename Work>
std::string messageOf(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Gpu, ListsDevicesBestFirst) {
  const auto rank = [](const GpuInfo& info) {
    const std::vector<std::string> order = {"discrete", "integrated", "virtual", "cpu", "other"};
    return std::find(order.begin(), order.end(), info.type) - order.begin();
  };
  const std::vector<GpuInfo> infos = listGpus();
  ASSERT_FALSE(infos.empty());
  for (std::size_t i = 1; i < infos.size(); ++i) EXPECT_LE(rank(infos[i - 1]), rank(infos[i]));
  EXPECT_FALSE(infos.front().name.empty());
  EXPECT_GE(infos.front().max_binding_bytes, 128U << 20U);  // what Vulkan guarantees, and what a slab is
}

TEST(Gpu, OpensTheBestUsableDeviceByDefault) {
  for (const GpuInfo& info : listGpus()) {
    if (!info.unusable.empty()) continue;
    EXPECT_EQ(Gpu({}).info().name, info.name);
    return;
  }
  FAIL() << "no usable device";
}

TEST(Gpu, FindsADeviceByPartOfItsNameInAnyCase) {
  std::string part = listGpus().back().name.substr(0, 5);
  std::transform(part.begin(), part.end(), part.begin(), [](unsigned char c) { return std::toupper(c); });
  EXPECT_EQ(Gpu({.name = part}).info().name, listGpus().back().name);
}

TEST(Gpu, RefusesAnUnknownNameAndSaysWhatThereIs) {
  const std::string message = messageOf([] { Gpu({.name = "voodoo2"}); });
  EXPECT_THAT(message, HasSubstr("--gpu voodoo2"));
  EXPECT_THAT(message, HasSubstr(listGpus().front().name));
  EXPECT_THAT(message, HasSubstr("palpate devices"));
}

TEST(Gpu, CountsTheBytesOfItsBuffers) {
  Gpu gpu({});
  EXPECT_EQ(gpu.bytesInUse(), 0U);
  {
    const Buffer a(gpu, "a", 1000, MemoryKind::kDevice);
    Buffer b(gpu, "b", 24, MemoryKind::kHost);
    const Buffer moved = std::move(b);
    EXPECT_EQ(gpu.bytesInUse(), 1024U);
    EXPECT_NE(moved.mapped(), nullptr);
  }
  EXPECT_EQ(gpu.bytesInUse(), 0U);
}

// Far more than the heap holds, and than the host could overcommit.
TEST(Buffer, RefusesMoreThanTheDeviceHas) {
  Gpu gpu({});
  const std::string message = messageOf(
      [&] { Buffer(gpu, "huge", 4 * gpu.info().memory_bytes + (std::size_t{1} << 36U), MemoryKind::kDevice); });
  EXPECT_THAT(message, HasSubstr("huge"));
  EXPECT_THAT(message, HasSubstr("MiB"));
}

}  // namespace
}  // namespace palpate::gpu
