// SPDX-License-Identifier: Apache-2.0
// What a Gpu counts of its own work.
#include "engine/gpu/gpu_use.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/kernel.hpp"
#include "shaders/edit.layout.h"
#include "shaders/kernels.hpp"

namespace palpate::gpu {
namespace gpu_use_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

KernelSpec commitSpec() {
  return {.name = "brick_commit",
          .spirv = kernelSpirv("brick_commit"),
          .bindings = COMMIT_BINDINGS,
          .push_bytes = sizeof(layout::CommitPush),
          .specialisation = {}};
}
KernelSpec editSpec(std::uint32_t kind) {
  return {.name = "edit",
          .spirv = kernelSpirv("edit"),
          .bindings = EDIT_BINDINGS,
          .push_bytes = sizeof(layout::EditPush),
          .specialisation = {kind}};
}

// Dispatches of no group: they are counted, and touch nothing.
void dispatchTimes(Commands& commands, const Kernel& commit, Gpu& gpu, int times) {
  std::vector<Buffer> buffers;
  for (int n = 0; n < COMMIT_BINDINGS; ++n) buffers.emplace_back(gpu, "work", 256, MemoryKind::kDevice);
  std::vector<const Buffer*> all;
  for (const Buffer& buffer : buffers) all.push_back(&buffer);
  commands.begin();
  for (int n = 0; n < times; ++n) {
    commands.dispatch(commit, all, pushBytes(layout::CommitPush{}), {0, 1});
    commands.barrier();
  }
  commands.run();
}

TEST(GpuUse, OfAGpuThatDidNothingIsEmpty) {
  const Gpu gpu({});
  EXPECT_THAT(gpu.use().kernels, IsEmpty());
  EXPECT_THAT(gpu.use().buffers, IsEmpty());
  EXPECT_EQ(gpu.use().submissions, 0U);
}

TEST(GpuUse, CountsDispatchesByKernel) {
  Gpu gpu({});
  const Kernel a(gpu, commitSpec());
  const Kernel b(gpu, editSpec(2));
  const Kernel again(gpu, commitSpec());
  Commands commands(gpu, "counted", 8);
  dispatchTimes(commands, a, gpu, 3);
  dispatchTimes(commands, again, gpu, 2);
  const GpuUse use = gpu.use();
  ASSERT_EQ(use.kernels.size(), 2U);
  EXPECT_EQ(use.kernels[0].name, "brick_commit");
  EXPECT_EQ(use.kernels[0].dispatches, 5U);
  EXPECT_GT(use.kernels[0].made_s, 0);
  EXPECT_THAT(use.kernels[0].constants, IsEmpty());
  EXPECT_EQ(use.kernels[1].name, "edit");
  EXPECT_EQ(use.kernels[1].dispatches, 0U);
  EXPECT_THAT(use.kernels[1].constants, ElementsAre(Pair("kKind", 2U)));  // edit.comp
  EXPECT_EQ(use.submissions, 2U);
}

// Pipelines are shared, counts are not.
TEST(GpuUse, IsEachGpusOwn) {
  Gpu first({}), second({});
  const Kernel a(first, commitSpec()), b(second, commitSpec());
  Commands commands(first, "counted", 8);
  dispatchTimes(commands, a, first, 4);
  EXPECT_EQ(first.use().kernels[0].dispatches, 4U);
  ASSERT_EQ(second.use().kernels.size(), 1U);
  EXPECT_EQ(second.use().kernels[0].dispatches, 0U);
  EXPECT_EQ(second.use().kernels[0].made_s, 0);  // it was there
  EXPECT_EQ(second.use().submissions, 0U);
}

TEST(GpuUse, HasTheBuffersThatAreThereByName) {
  Gpu gpu({});
  const Buffer b(gpu, "b", 24, MemoryKind::kHost);
  {
    const Buffer other(gpu, "b", 40, MemoryKind::kDevice), a(gpu, "a", 1000, MemoryKind::kDevice);
    const std::vector<BufferUse> buffers = gpu.use().buffers;
    ASSERT_EQ(buffers.size(), 2U);
    EXPECT_EQ(buffers[0].name, "a");
    EXPECT_EQ(buffers[0].count, 1U);
    EXPECT_EQ(buffers[0].bytes, 1000U);
    EXPECT_EQ(buffers[1].name, "b");
    EXPECT_EQ(buffers[1].count, 2U);
    EXPECT_EQ(buffers[1].bytes, 64U);
  }
  const std::vector<BufferUse> left = gpu.use().buffers;
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].name, "b");
  EXPECT_EQ(left[0].count, 1U);
  EXPECT_EQ(left[0].bytes, 24U);
  EXPECT_EQ(gpu.use().peak_bytes, 1064U);
}

}  // namespace gpu_use_test
}  // namespace palpate::gpu
