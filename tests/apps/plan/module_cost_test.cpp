// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/module_cost.hpp"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>

#include "base/mapped_libraries.hpp"
#include "base/module.hpp"

namespace palpate {
namespace module_cost_test {

using testing::HasSubstr;

bool isMapped(const std::string& name) {
  const std::vector<std::string> libraries = mappedLibraries();
  return std::ranges::find(libraries, name + ".so") != libraries.end();
}

// Embree is never loaded here, so it brings itself and its library; afterwards it is not loaded still.
TEST(ModuleCost, IsThatOfLoadingItAndLeavesNothingBehind) {
  ASSERT_FALSE(isMapped("embree"));
  const ModuleCost cost = moduleCost("embree");
  EXPECT_EQ(cost.name, "embree");
  EXPECT_EQ(cost.failure, "");
  EXPECT_GT(cost.ms, 0);
  EXPECT_GE(cost.libraries, 2U);
  EXPECT_GT(cost.bytes, 4096U);
  EXPECT_FALSE(isMapped("embree"));
}

TEST(ModuleCost, OfOneThatIsNotThereIsAReason) {
  const ModuleCost cost = moduleCost("no_such_module");
  EXPECT_THAT(cost.failure, HasSubstr("no_such_module.so"));
  EXPECT_EQ(cost.libraries, 0U);
}

}  // namespace module_cost_test
}  // namespace palpate
