// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_kernels.hpp"

#include <set>

#include <gmock/gmock.h>

#include "engine/filter/filter_spec.hpp"
#include "shaders/filter.layout.h"
#include "shaders/kernels.hpp"

namespace palpate {
namespace filter_kernels_test {

// The specialisation constants that a kernel's SPIR-V has. The optimiser has taken away those that nothing reads.
std::set<std::uint32_t> constantsOf(const std::string& kernel) {
  constexpr std::size_t kHeader = 5;
  constexpr std::uint32_t kOpDecorate = 71, kSpecId = 1;
  const auto words = kernelSpirv(kernel);
  std::set<std::uint32_t> found;
  for (std::size_t at = kHeader; at < words.size(); at += words[at] >> 16U) {
    if ((words[at] & 0xFFFFU) == kOpDecorate && words[at + 2] == kSpecId) found.insert(words[at + 3]);
  }
  return found;
}

// A kernel that knows no border must not be built and dispatched twice, one that knows it must.
TEST(FilterKernels, HaveAnEdgeWhereTheKernelReadsIt) {
  std::set<std::string> seen;
  for (const char* chain : {"gaussian:1", "bilateral:1:range=1", "diffuse:1:kappa=1", "diffuse:1:kappa=1:g=exp",
                            "distance:3", "median:1", "median:2", "median:3", "dilate:1", "erode:2:shape=ball"}) {
    for (const FilterStep& step : lowerFilters(filterChain(chain), Vec3::Constant(1e-3), 0.5F)) {
      const FilterKernel kernel = filterKernel(step);
      EXPECT_EQ(kernel.has_edge, constantsOf(kernel.name).contains(FILTER_CONSTANT_EDGE)) << kernel.name;
      seen.insert(kernel.name);
    }
  }
  EXPECT_EQ(seen.size(), 11U);  // all of shaders/filter_*.comp
}

}  // namespace filter_kernels_test
}  // namespace palpate
