// SPDX-License-Identifier: Apache-2.0
#include "apps/study/shard.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace shard_test {

TEST(Shard, EveryCellIsInExactlyOneAndTheyAreOfOneSize) {
  for (const std::size_t cells : {0U, 1U, 7U, 100U, 1001U}) {
    for (const int of : {1, 2, 3, 8, 2000}) {
      std::vector<int> times(cells, 0);
      std::size_t least = cells, most = 0;
      for (int number = 1; number <= of; ++number) {
        const std::vector<std::size_t> own = cellsOf({number, of}, cells);
        EXPECT_TRUE(std::is_sorted(own.begin(), own.end()));
        for (const std::size_t cell : own) ++times.at(cell);
        least = std::min(least, own.size());
        most = std::max(most, own.size());
      }
      EXPECT_EQ(std::vector<int>(cells, 1), times);
      EXPECT_LE(most, least + 1);
    }
  }
}

TEST(Shard, IsReadAndWritten) {
  EXPECT_EQ(shardOf("1/1"), (Shard{1, 1}));
  EXPECT_EQ(shardOf("2/8"), (Shard{2, 8}));
  EXPECT_EQ(shardOf("100000/100000"), (Shard{kMostShards, kMostShards}));
  EXPECT_EQ(shardWords({2, 8}), " --shard 2/8");
}

TEST(Shard, WhatIsNoPartIsRefused) {
  for (const char* text : {"", "/", "1", "1/", "/2", "0/2", "3/2", "-1/2", "1/0", "1/-2", "1/2/3", "a/2", "1/b", " 1/2",
                           "1/2 ", "1.5/2", "1/100001", "+1/2", "99999999999/99999999999"}) {
    try {
      static_cast<void>(shardOf(text));
      ADD_FAILURE() << text;
    } catch (const Error& refusal) {
      EXPECT_THAT(refusal.what(), testing::HasSubstr(std::string("--shard ") + text));
      EXPECT_EQ(refusal.code(), Error::Code::kBadInput);
    }
  }
}

}  // namespace shard_test
}  // namespace palpate
