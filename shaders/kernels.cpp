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
              "add it to PALPATE_POOL_KERNELS or PALPATE_PLAIN_KERNELS in shaders/CMakeLists.txt");
}

std::span<const std::uint32_t> poolKernelSpirv(std::string_view name, std::uint32_t slabs) {
  return kernelSpirv(slabs == 1 ? std::string(name) + "_one_slab" : std::string(name));
}

}  // namespace palpate
