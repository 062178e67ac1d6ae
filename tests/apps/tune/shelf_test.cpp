// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/shelf.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace shelf_test {

struct Thing {
  int name = 0;
  std::uint64_t bytes = 0;
};

class ShelfTest : public testing::Test {
 protected:
  std::shared_ptr<Thing> find(int name, std::uint64_t bytes = 1) {
    return shelf_.find([&](const Thing& thing) { return thing.name == name; },
                       [&] {
                         ++made_;
                         if (fails_ > 0 && fails_-- > 0) throw Error(Error::Code::kOutOfMemory, "a", "b", "c");
                         return std::make_shared<Thing>(Thing{name, bytes});
                       },
                       [](const Thing& thing) { return thing.bytes; });
  }
  std::uint64_t limit_ = 10;
  int made_ = 0, fails_ = 0;
  Shelf<Thing> shelf_ = Shelf<Thing>(2, [this] { return limit_; });
};

TEST_F(ShelfTest, KeepsThoseUsedLast) {
  static_cast<void>(find(1));
  static_cast<void>(find(2));
  static_cast<void>(find(1));
  EXPECT_EQ(made_, 2);
  static_cast<void>(find(3));  // drops 2
  static_cast<void>(find(1));
  EXPECT_EQ(made_, 3);
  static_cast<void>(find(2));
  EXPECT_EQ(made_, 4);
}

TEST_F(ShelfTest, DropsWhatTakesTooMuch) {
  static_cast<void>(find(1, 11));
  static_cast<void>(find(2, 5));
  static_cast<void>(find(1, 11));
  EXPECT_EQ(made_, 3);
}

TEST_F(ShelfTest, WhatIsInUseLivesOn) {
  limit_ = 0;
  const std::shared_ptr<Thing> held = find(1);
  const std::weak_ptr<Thing> not_held = find(2);
  EXPECT_EQ(held->name, 1);
  static_cast<void>(find(3));
  EXPECT_TRUE(not_held.expired());
  EXPECT_EQ(held->name, 1);
}

TEST_F(ShelfTest, MakesRoomForWhatFindsNoMemory) {
  const std::weak_ptr<Thing> dropped = find(1);
  fails_ = 1;
  EXPECT_EQ(find(2)->name, 2);
  EXPECT_TRUE(dropped.expired());
  fails_ = 2;
  EXPECT_THROW(static_cast<void>(find(3)), Error);
  fails_ = 1;  // the shelf is empty: nothing can be dropped
  EXPECT_THROW(static_cast<void>(find(3)), Error);
}

}  // namespace shelf_test
}  // namespace palpate
