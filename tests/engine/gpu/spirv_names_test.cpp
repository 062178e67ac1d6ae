// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/spirv_names.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "shaders/kernels.hpp"

namespace palpate::gpu {
namespace spirv_names_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using Words = std::vector<std::uint32_t>;

// By hand, as the specification says: header; OpName %7 "kReach" (k R e a, then c h and the end); OpName %9 "main";
// OpDecorate %7 SpecId 4; OpDecorate %9 SpecId 2 would name a constant "main".
const Words kShader = {0x07230203,
                       0x00010500,
                       0,
                       10,
                       0,  // header
                       4U << 16U | 5U,
                       7,
                       0x6165526BU,
                       0x00006863U,  // "kRea" "ch"
                       4U << 16U | 5U,
                       9,
                       0x6E69616DU,
                       0,  // "main", its end in a word alone
                       4U << 16U | 71U,
                       7,
                       1,
                       4,  // SpecId 4
                       3U << 16U | 71U,
                       9,
                       2,  // another decoration
                       4U << 16U | 71U,
                       8,
                       1,
                       3};  // a constant without a name

TEST(SpirvNames, AreThoseOfTheConstants) {
  EXPECT_THAT(constantNames(kShader), ElementsAre(Pair(4, "kReach")));
}

// Cut anywhere, it reads no word behind the end and finds no more than the whole has.
TEST(SpirvNames, OfWhatIsNoShaderAreNone) {
  EXPECT_THAT(constantNames({}), IsEmpty());
  Words foreign = kShader;
  foreign[0] = 0x03022307;  // the other byte order
  EXPECT_THAT(constantNames(foreign), IsEmpty());
  for (std::size_t length = 0; length < kShader.size(); ++length) {
    const Words cut(kShader.begin(), kShader.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_LE(constantNames(cut).size(), 1U);
    EXPECT_EQ(constantNames(cut).size(), length >= 17 ? 1U : 0U) << length;
  }
  Words endless = kShader;
  endless[5] = 0;  // an instruction of no length
  EXPECT_THAT(constantNames(endless), IsEmpty());
}

// The names of gradient_task.glsl and gradient_row.glsl, with the constants of gradient.layout.h.
TEST(SpirvNames, AreThereInThePrograms) {
  EXPECT_THAT(constantNames(poolKernelSpirv("gradient", 1)), ElementsAre(Pair(1, "kHalf"), Pair(2, "kRun")));
  EXPECT_THAT(constantNames(poolKernelSpirv("gradient", 2)),
              ElementsAre(Pair(0, "kSlabCount"), Pair(1, "kHalf"), Pair(2, "kRun")));
}

}  // namespace spirv_names_test
}  // namespace palpate::gpu
