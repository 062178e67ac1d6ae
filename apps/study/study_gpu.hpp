// SPDX-License-Identifier: Apache-2.0
// apps/study/study_gpu.hpp: the Vulkan device of a study, opened by the first cell that needs it. One thread.
#pragma once

#include <memory>
#include <string>

#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

// How rows name this program among its rivals.
inline constexpr const char* kOwnLibrary = "Palpate";

struct StudyGpu {
  explicit StudyGpu(const std::string& name) : gpu({.name = name}), transfer(gpu) {}
  gpu::Gpu gpu;
  gpu::Transfer transfer;
};

class LazyGpu {
 public:
  // `name`: as of gpu::GpuRequest; throws Error as gpu::Gpu does.
  StudyGpu& of(const std::string& name) {
    if (!gpu_) gpu_ = std::make_unique<StudyGpu>(name);
    return *gpu_;
  }

 private:
  std::unique_ptr<StudyGpu> gpu_;
};

}  // namespace palpate
