// SPDX-License-Identifier: Apache-2.0
// The other Vulkan tests rest on the validation layer speaking up: here it must.
#include "engine/gpu/validation.hpp"

#include <gtest/gtest.h>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"

namespace palpate::gpu {
namespace validation_test {

TEST(Validation, ReportsACopyPastTheEndOfABuffer) {
  clearValidationMessages();
  Gpu gpu({.validation = true});
  const Buffer from(gpu, "from", 64, MemoryKind::kDevice);
  const Buffer to(gpu, "to", 64, MemoryKind::kDevice);
  Commands commands(gpu, "bad copy", 1);
  commands.begin();
  commands.copy(from, 32, to, 0, 64);
  EXPECT_FALSE(validationMessages().empty());
}

TEST(Validation, ReportsAMissingBarrier) {
  clearValidationMessages();
  Gpu gpu({.validation = true});
  const Buffer a(gpu, "a", 64, MemoryKind::kDevice);
  const Buffer b(gpu, "b", 64, MemoryKind::kDevice);
  Commands commands(gpu, "racing copies", 1);
  commands.begin();
  commands.copy(a, 0, b, 0, 64);
  commands.copy(b, 0, a, 0, 64);  // reads what the first copy may still write
  EXPECT_FALSE(validationMessages().empty());
  commands.run();
}

TEST(Validation, IsSilentOnAProperCopy) {
  clearValidationMessages();
  Gpu gpu({.validation = true});
  const Buffer a(gpu, "a", 64, MemoryKind::kDevice);
  const Buffer b(gpu, "b", 64, MemoryKind::kDevice);
  Commands commands(gpu, "copies", 1);
  commands.begin();
  commands.copy(a, 0, b, 0, 64);
  commands.barrier();
  commands.copy(b, 0, a, 0, 64);
  commands.run();
  EXPECT_TRUE(validationMessages().empty());
}

}  // namespace validation_test
}  // namespace palpate::gpu
