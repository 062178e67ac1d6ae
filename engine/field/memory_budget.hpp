// SPDX-License-Identifier: Apache-2.0
// engine/field/memory_budget.hpp: refuses a volume that would not fit into memory. The header of its file is enough, so
// nothing is allocated before.
//
// Counted for each voxel: the file's own values, the dense floats made from them, the grid, and the engine's copy on
// the GPU. (On lavapipe and integrated GPUs that copy is in the same memory.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpate {

inline constexpr double kDenseBytesPerVoxel = 4;      // the float array handed to Volume::fromDense
inline constexpr double kGridBytesPerVoxel = 4.2;     // a full leaf: 512 floats, its mask and its place in the tree
inline constexpr double kGpuBytesPerVoxel = 8;        // density 4; sample 16, for a quarter of the bricks
inline constexpr std::int64_t kMaxDimension = 16384;  // voxels along an axis
// Bricks of a domain, stored or not: 2048 x 2048 x 2048 voxels. A brick's page takes 8 bytes on the GPU, and so do its
// bounds; Vulkan guarantees only 128 MiB for a binding.
inline constexpr double kMaxBricks = 16777216;

// Memory that the machine has free for new work [byte]: MemAvailable of /proc/meminfo, or SIZE_MAX without that file.
[[nodiscard]] std::size_t availableMemoryBytes();

// Throws Error(kOutOfMemory) if a dense volume of these dimensions exceeds the budget (0: availableMemoryBytes), and
// Error(kBadInput) for a dimension below 1 or above kMaxDimension. `file_bytes_per_voxel`: the raw values held while
// reading [byte]. Cost: none, or one read of /proc/meminfo. Any thread.
void checkMemory(const std::string& input, std::int64_t nx, std::int64_t ny, std::int64_t nz,
                 double file_bytes_per_voxel, std::size_t memory_budget_bytes);

// The same for volumes that are sparse from the start. `bytes` [byte]: what the loader counted.
void checkMemory(const std::string& input, double bytes, std::size_t memory_budget_bytes);

// Throws Error(kOutOfMemory) if a domain of these dimensions has more than kMaxBricks bricks.
void checkBricks(const std::string& input, std::int64_t nx, std::int64_t ny, std::int64_t nz);

}  // namespace palpate
