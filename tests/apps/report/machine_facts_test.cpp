// SPDX-License-Identifier: Apache-2.0
#include "apps/report/machine_facts.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace machine_facts_test {

TEST(MachineFacts, AreReadOnThisMachine) {
  const MachineFacts m = readMachineFacts();
  EXPECT_GE(m.cores, 1);
  EXPECT_GT(m.memory_bytes, 100U << 20);
  EXPECT_TRUE(m.kernel.starts_with("Linux ")) << m.kernel;
  EXPECT_FALSE(m.cpu.empty());
  EXPECT_EQ(m.os.find('"'), std::string::npos);
}

}  // namespace machine_facts_test
}  // namespace palpate
