// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/host_list.hpp"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace host_list_test {

TEST(HostList, DoublesUpToWhatItMayTakeAndNoFurther) {
  gpu::Gpu gpu({});
  HostList<float> list(gpu, "numbers", 40, 400);
  list.fit(41);
  EXPECT_EQ(list.buffer().bytes(), 320U);
  list.fit(81);  // doubled it would take 640
  EXPECT_EQ(list.buffer().bytes(), 400U);
  list.write(std::array{1.0F, 2.0F});
  try {
    list.fit(101);
    FAIL() << "it fitted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
    EXPECT_THAT(error.what(), testing::HasSubstr("numbers"));
  }
  EXPECT_EQ(list.buffer().bytes(), 400U);
  EXPECT_THAT(list.read(2), testing::ElementsAre(1.0F, 2.0F));
}

TEST(HostList, MayTakeOneBindingWhereNothingElseIsSaid) {
  gpu::Gpu gpu({});
  HostList<float> list(gpu, "numbers", 1);
  EXPECT_THROW(list.fit(gpu.info().max_binding_bytes / sizeof(float) + 1), Error);
}

}  // namespace host_list_test
}  // namespace palpate
