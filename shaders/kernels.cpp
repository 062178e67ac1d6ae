// SPDX-License-Identifier: Apache-2.0
#include "shaders/kernels.hpp"

#include <cstddef>
#include <string>

#include "base/error.hpp"

namespace palpate {
namespace {

struct EmbeddedKernel {
  std::string_view name;
  const unsigned char* bytes;
  std::size_t size;
};

#include "kernels_table.inc"

}  // namespace

std::span<const std::uint32_t> kernelSpirv(std::string_view name) {
  for (const EmbeddedKernel& kernel : kKernels) {
    if (kernel.name == name) {
      return {reinterpret_cast<const std::uint32_t*>(kernel.bytes), kernel.size / sizeof(std::uint32_t)};
    }
  }
  throw Error(Error::Code::kDevice, "kernel " + std::string(name), "it is not built into this program",
              "add it to PALPATE_KERNELS in shaders/CMakeLists.txt");
}

}  // namespace palpate
