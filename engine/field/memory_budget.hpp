// SPDX-License-Identifier: Apache-2.0
// engine/field/memory_budget.hpp: refuses a volume that would not fit, from its header, before anything is allocated.
//
// Counted for each voxel: the file's own values, the dense floats made of them, the grid, and what the engine's copy on
// the GPU will need, which on lavapipe and integrated GPUs is the same memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpate {

inline constexpr double kDenseBytesPerVoxel = 4;      // the float array handed to Volume::fromDense
inline constexpr double kGridBytesPerVoxel = 4.2;     // a full leaf: 512 floats, its mask and its place in the tree
inline constexpr double kGpuBytesPerVoxel = 8;        // density 4, and 16 of gradient for a quarter of the bricks
inline constexpr std::int64_t kMaxDimension = 16384;  // voxels along an axis
// A page and the bounds of a brick take 8 bytes each on the GPU, and a binding of 128 MiB is all that Vulkan
// guarantees.
inline constexpr double kMaxBricks = 16777216;  // of the whole box, stored or not: 2048 x 2048 x 2048 voxels

// Memory that the machine has free for new work [byte]: MemAvailable of /proc/meminfo; SIZE_MAX where there is none.
[[nodiscard]] std::size_t availableMemoryBytes();

// Throws Error(kOutOfMemory) if a dense volume of these dimensions exceeds the budget (0: availableMemoryBytes), and
// Error(kBadInput) for a dimension below 1 or above kMaxDimension. `file_bytes_per_voxel`: the raw values held while
// reading [byte]. Cost: none, or one read of /proc/meminfo. Any thread.
void checkMemory(const std::string& input, std::int64_t nx, std::int64_t ny, std::int64_t nz,
                 double file_bytes_per_voxel, std::size_t memory_budget_bytes);

// The same for volumes that are sparse from the start: `bytes` [byte] is what the loader counted.
void checkMemory(const std::string& input, double bytes, std::size_t memory_budget_bytes);

// Throws Error(kOutOfMemory) if a box of these dimensions has more than kMaxBricks bricks.
void checkBricks(const std::string& input, std::int64_t nx, std::int64_t ny, std::int64_t nz);

}  // namespace palpate
