// SPDX-License-Identifier: Apache-2.0
// Choosing and opening a device, and the refusals on the way.
#include "engine/gpu/gpu.hpp"

#include <array>
#include <thread>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/edit.layout.h"
#include "shaders/kernels.hpp"

namespace palpate::gpu {
namespace gpu_test {

using testing::HasSubstr;

// What every device must allow.
constexpr std::uint32_t kMostBindings = 16;
constexpr std::uint32_t kMostPushBytes = 128;

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
  for (const GpuInfo& info : infos) {
    EXPECT_THAT(info.api_version, testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
    EXPECT_EQ(info.tuned_as, info.type);
    EXPECT_FALSE(info.driver.empty());
    EXPECT_GT(info.memory_bytes, 1U << 20U);
    EXPECT_EQ(info.isCpu(), info.type == "cpu");
  }
  EXPECT_EQ(Gpu({.tuned_as = "discrete"}).info().tuned_as, "discrete");
  EXPECT_EQ(Gpu({}).info().tuned_as, Gpu({}).info().type);
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
  std::string all;
  for (const GpuInfo& info : listGpus())
    all += (all.empty() ? "" : ", ") + info.name + (info.unusable.empty() ? "" : " (" + info.unusable + ")");
  EXPECT_EQ(messageOf([] { Gpu({.name = "voodoo2"}); }),
            "--gpu voodoo2: no usable device of this name; this machine has: " + all +
                "; choose one with --gpu; 'palpate devices' lists them");
}

TEST(Groups, AreFoldedIntoRows) {
  const auto folded = [](std::uint32_t count) {
    const Groups groups = Groups::folded(count, 100);
    return std::pair(groups.x, groups.y);
  };
  EXPECT_EQ(folded(1), std::pair(1U, 1U));
  EXPECT_EQ(folded(100), std::pair(100U, 1U));
  EXPECT_EQ(folded(101), std::pair(100U, 2U));
  EXPECT_EQ(folded(200), std::pair(100U, 2U));
  EXPECT_EQ(folded(201), std::pair(100U, 3U));
}

// Stretches between marks, of which there are 32 at most, the start one of them. No device takes an hour for a copy.
TEST(Commands, TellTheTimesBetweenMarks) {
  Gpu gpu({});
  const Buffer a(gpu, "a", 64, MemoryKind::kDevice), b(gpu, "b", 64, MemoryKind::kDevice);
  Commands commands(gpu, "timed", 1);
  const auto namesOf = [&](int marks) {
    commands.begin();
    for (int n = 0; n < marks; ++n) {
      commands.copy(n % 2 == 0 ? a : b, 0, n % 2 == 0 ? b : a, 0, 64);
      commands.barrier();
      commands.mark(std::to_string(n));
    }
    commands.run();
    std::vector<std::string> names;
    for (const StageTime& stage : commands.marks()) {
      names.push_back(stage.name);
      EXPECT_GE(stage.seconds, 0);
      EXPECT_LT(stage.seconds, 3600);
    }
    return names;
  };
  EXPECT_THAT(namesOf(2), testing::IsEmpty());  // nobody asked
  commands.timed(true);
  const std::vector<std::string> two = namesOf(2);
  if (two.empty()) GTEST_SKIP() << "this device has no clock";
  EXPECT_THAT(two, testing::ElementsAre("0", "1"));
  EXPECT_EQ(namesOf(1).size(), 1U);
  EXPECT_EQ(namesOf(40).size(), 31U);
  commands.timed(false);
  EXPECT_THAT(namesOf(2), testing::IsEmpty());
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

KernelSpec commitKernel() {
  return {.name = "brick_commit",
          .spirv = kernelSpirv("brick_commit"),
          .bindings = COMMIT_BINDINGS,
          .push_bytes = sizeof(layout::CommitPush),
          .specialisation = {}};
}

// What a driver compiled for one Gpu is there for every other of the same device, while any of them lives.
TEST(Gpu, ThoseOfOneDeviceShareTheirKernels) {
  auto first = std::make_unique<Gpu>(GpuRequest{});
  Gpu second(GpuRequest{.tuned_as = "discrete"});
  KernelSpec spec = commitKernel();
  const Kernel a(*first, spec);
  EXPECT_EQ(&a.state(), &Kernel(second, spec).state());
  const Kernel::State* known = &a.state();
  first.reset();
  EXPECT_EQ(known, &Kernel(second, spec).state());
  spec.specialisation = {1};
  EXPECT_NE(known, &Kernel(second, spec).state());
}

TEST(Commands, RefuseADispatchThatLeavesABindingEmpty) {
  Gpu gpu({});
  const Kernel kernel(gpu, commitKernel());
  const Buffer buffer(gpu, "one", 64, MemoryKind::kDevice);
  const std::array<const Buffer*, 1> one = {&buffer};
  Commands commands(gpu, "too few", 1);
  commands.begin();
  EXPECT_EQ(messageOf([&] { commands.dispatch(kernel, one, {}, {}); }),
            "kernel brick_commit: it has " + std::to_string(COMMIT_BINDINGS) +
                " bindings but got 1 buffers; this is a fault of Palpate: please report it");
}

TEST(Gpu, KernelsThatDifferInAnythingAreNotShared) {
  Gpu gpu({});
  const Kernel a(gpu, commitKernel());
  const auto differs = [&](auto change) {
    KernelSpec spec = commitKernel();
    change(spec);
    return &Kernel(gpu, spec).state() != &a.state();
  };
  EXPECT_FALSE(differs([](KernelSpec&) {}));
  EXPECT_TRUE(differs([](KernelSpec& spec) { spec.name = "another"; }));
  EXPECT_TRUE(differs([](KernelSpec& spec) { spec.bindings += 1; }));
  EXPECT_TRUE(differs([](KernelSpec& spec) { spec.push_bytes += 4; }));
  EXPECT_TRUE(differs([](KernelSpec& spec) { spec.specialisation = {7}; }));
  // The words alone, which both fit all bindings and push constants.
  const auto ofWords = [&](const char* words) {
    KernelSpec spec = commitKernel();
    spec.bindings = kMostBindings;
    spec.push_bytes = kMostPushBytes;
    spec.spirv = kernelSpirv(words);
    return &Kernel(gpu, spec).state();
  };
  EXPECT_NE(ofWords("brick_commit"), ofWords("page_write"));
  EXPECT_EQ(ofWords("page_write"), ofWords("page_write"));
}

// Each in a thread of its own, as two engines are: the queue is one.
TEST(Gpu, ThoseOfOneDeviceWorkAtOnce) {
  const auto work = [](std::byte seed, bool& same) {
    Gpu gpu({});
    Transfer transfer(gpu, false);
    const Buffer buffer(gpu, "target", 1U << 20U, MemoryKind::kDevice);
    same = true;
    for (int i = 0; i < 50; ++i) {
      const std::vector<std::byte> sent(1U << 20U, static_cast<std::byte>(std::to_integer<int>(seed) + i));
      std::vector<std::byte> received(sent.size());
      transfer.upload(sent, buffer);
      transfer.download(buffer, received);
      same = same && sent == received;
    }
  };
  std::array<bool, 3> same = {};
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < same.size(); ++i) {
      threads.emplace_back(work, static_cast<std::byte>(70 * i), std::ref(same[i]));
    }
  }
  EXPECT_EQ(same, (std::array<bool, 3>{true, true, true}));
}

// Far more than the heap holds, and than the host could overcommit.
TEST(Buffer, RefusesMoreThanTheDeviceHas) {
  Gpu gpu({});
  const std::string message = messageOf(
      [&] { Buffer(gpu, "huge", 4 * gpu.info().memory_bytes + (std::size_t{1} << 36U), MemoryKind::kDevice); });
  EXPECT_THAT(message, HasSubstr("huge"));
  EXPECT_THAT(message, HasSubstr("MiB"));
}

}  // namespace gpu_test
}  // namespace palpate::gpu
