// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/brick_tasks.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace brick_tasks_test {

using testing::ElementsAre;
using testing::FieldsAre;

// In the order in which they came, slab by slab, behind what the list holds already.
TEST(BrickTasks, GoSlabBySlab) {
  BrickTasks tasks;
  tasks.add(7, {2, 4}, true);
  tasks.add(3, {0, 2});
  tasks.add(9, {2, 0});
  tasks.add(5, {});  // without samples
  std::vector<layout::BrickTask> list = {{1, 6}};
  EXPECT_THAT(tasks.moveTo(list), ElementsAre(FieldsAre(0U, 1U, 2U), FieldsAre(2U, 3U, 2U)));
  EXPECT_THAT(list, ElementsAre(FieldsAre(1U, 6U), FieldsAre(3U, 2U), FieldsAre(5U, NO_SLOT),
                                FieldsAre(7U, 4U | IF_ACTIVE), FieldsAre(9U, 0U)));
  EXPECT_TRUE(tasks.moveTo(list).empty());
  EXPECT_EQ(list.size(), 5U);
}

}  // namespace brick_tasks_test
}  // namespace palpate
