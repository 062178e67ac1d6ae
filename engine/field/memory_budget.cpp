// SPDX-License-Identifier: Apache-2.0
#include "engine/field/memory_budget.hpp"

#include <fstream>
#include <limits>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kBytesPerGiB = 1024.0 * 1024.0 * 1024.0;

}  // namespace

std::size_t availableMemoryBytes() {
  std::ifstream meminfo("/proc/meminfo");
  std::string key;
  std::string rest;
  std::size_t kibibytes = 0;
  while (meminfo >> key >> kibibytes) {
    if (key == "MemAvailable:") return kibibytes * 1024;
    std::getline(meminfo, rest);
  }
  return std::numeric_limits<std::size_t>::max();
}

void checkMemory(const std::string& input, double bytes, std::size_t memory_budget_bytes) {
  const std::size_t budget = memory_budget_bytes != 0 ? memory_budget_bytes : availableMemoryBytes();
  if (bytes <= static_cast<double>(budget)) return;
  throw Error(Error::Code::kOutOfMemory, input,
              fmt::format("it needs {:.3g} GiB with its copy for the GPU, and {:.3g} GiB are free",
                          bytes / kBytesPerGiB, static_cast<double>(budget) / kBytesPerGiB),
              "crop or resample it, or use a machine with more memory");
}

void checkMemory(const std::string& input, std::int64_t nx, std::int64_t ny, std::int64_t nz,
                 double file_bytes_per_voxel, std::size_t memory_budget_bytes) {
  if (nx < 1 || ny < 1 || nz < 1) {
    throw Error(Error::Code::kBadInput, input, fmt::format("its header claims {} x {} x {} voxels", nx, ny, nz),
                "write the file again");
  }
  const double voxels = static_cast<double>(nx) * static_cast<double>(ny) * static_cast<double>(nz);
  checkMemory(input, voxels * (file_bytes_per_voxel + kDenseBytesPerVoxel + kGridBytesPerVoxel + kGpuBytesPerVoxel),
              memory_budget_bytes);
  if (nx > kMaxDimension || ny > kMaxDimension || nz > kMaxDimension) {
    throw Error(Error::Code::kBadInput, input,
                fmt::format("it has {} x {} x {} voxels, and an axis may have {}", nx, ny, nz, kMaxDimension),
                "crop or resample it");
  }
  checkBricks(input, nx, ny, nz);
}

void checkBricks(const std::string& input, std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  const auto bricks = [](std::int64_t n) -> double {
    const std::int64_t whole = (n + 7) / 8;
    return static_cast<double>(whole);
  };
  if (bricks(nx) * bricks(ny) * bricks(nz) <= kMaxBricks) return;
  throw Error(
      Error::Code::kOutOfMemory, input,
      fmt::format("its box of {} x {} x {} voxels has more than {:.0f} bricks of 8 x 8 x 8", nx, ny, nz, kMaxBricks),
      "crop or resample it");
}

}  // namespace palpate
