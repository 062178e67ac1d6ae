// SPDX-License-Identifier: Apache-2.0
// Where kernels promise bits, nothing may be contracted: a sum that is fused with the product before it rounds once
// instead of twice. `precise` forbids it (NoContraction in SPIR-V), and no pass of the optimiser may have lost that,
// nor have fused by itself. A CPU's driver does not show it: it takes fused operations apart again.
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shaders/kernels.hpp"

namespace palpate {
namespace contraction_test {

// Of the SPIR-V specification, 3.52 and of GLSL.std.450.
constexpr std::uint32_t kHeaderWords = 5;
constexpr std::uint32_t kExtInst = 12, kDecorate = 71, kFAdd = 129, kFSub = 131, kFMul = 133;
constexpr std::uint32_t kNoContraction = 42;
constexpr std::uint32_t kFma = 50;

struct Found {
  std::size_t arithmetic = 0;  // sums, differences and products
  std::size_t fused = 0;
  std::size_t fusible = 0;  // sums and differences of products, neither of which forbids it
};

Found contractionsIn(std::span<const std::uint32_t> words) {
  Found found;
  std::set<std::uint32_t> exact;  // decorations come first in a module, products before their sums
  std::set<std::uint32_t> loose_products;
  for (std::size_t at = kHeaderWords; at < words.size(); at += words[at] >> 16) {
    const std::uint32_t* word = &words[at];
    switch (word[0] & 0xffff) {
      case kDecorate:
        if (word[2] == kNoContraction) exact.insert(word[1]);
        break;
      case kExtInst:
        found.fused += word[4] == kFma ? 1U : 0U;
        break;
      case kFMul:
        ++found.arithmetic;
        if (!exact.contains(word[2])) loose_products.insert(word[2]);
        break;
      case kFAdd:
      case kFSub:
        ++found.arithmetic;
        if (!exact.contains(word[2]) && (loose_products.contains(word[3]) || loose_products.contains(word[4])))
          ++found.fusible;
        break;
      default:
        break;
    }
  }
  return found;
}

class Contraction : public testing::TestWithParam<const char*> {};

TEST_P(Contraction, IsForbiddenWhereBitsArePromised) {
  const std::string name = GetParam();
  std::vector<std::string> names = {name};
  if (name != "edit") names.push_back(name + "_one_slab");  // the one that reads no pool
  for (const std::string& built : names) {
    const Found found = contractionsIn(kernelSpirv(built));
    EXPECT_GT(found.arithmetic, 0U) << built;
    EXPECT_EQ(found.fused, 0U) << built;
    EXPECT_EQ(found.fusible, 0U) << built;
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, Contraction,
                         testing::Values("gradient", "gradient_central4", "gradient_smoothed", "gradient_sobel",
                                         "window", "edit", "edit_stencil", "filter_convolve", "filter_bilateral",
                                         "filter_diffuse", "filter_distance_seed", "filter_distance_spread",
                                         "filter_distance_finish"),
                         [](const auto& kernel) { return std::string(kernel.param); });

}  // namespace contraction_test
}  // namespace palpate
