// SPDX-License-Identifier: Apache-2.0
// shaders/brick_bounds.layout.h: push constants and bindings of the brick bounds kernel.
#ifndef PALPATE_BRICK_BOUNDS_LAYOUT_H
#define PALPATE_BRICK_BOUNDS_LAYOUT_H
#include "brick_pool.layout.h"

#define BOUNDS_BINDING_BOUNDS BINDING_OWN
#define BOUNDS_BINDING_TASKS (BINDING_OWN + 1)    // the bricks to do, if `listed`
#define BOUNDS_BINDING_RESULTS (BINDING_OWN + 2)  // the bounds of listed bricks, in the list's order
#define BOUNDS_BINDINGS (BINDING_OWN + 3)
#define BOUNDS_GROUP 64        // bricks in a work group
#define BOUNDS_GROUP_LISTED 8  // the same for a list: it is short, so more groups share it

PALPATE_LAYOUT_BEGIN

struct BoundsPush {
  PoolDomain domain;
  uint brick_count;
  uint listed;  // 1: only the bricks of the list; 0: all
};

PALPATE_LAYOUT_CHECK(BoundsPush, 32)
PALPATE_PUSH_CHECK(BoundsPush)

PALPATE_LAYOUT_END
#endif
