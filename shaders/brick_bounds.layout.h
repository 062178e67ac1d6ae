// SPDX-License-Identifier: Apache-2.0
// shaders/brick_bounds.layout.h: push constants and bindings of the brick bounds kernel.
#ifndef PALPATE_BRICK_BOUNDS_LAYOUT_H
#define PALPATE_BRICK_BOUNDS_LAYOUT_H
#include "brick_pool.layout.h"

#define BOUNDS_BINDING_BOUNDS BINDING_OWN
#define BOUNDS_BINDINGS (BINDING_OWN + 1)
#define BOUNDS_GROUP 64  // bricks a work group

PALPATE_LAYOUT_BEGIN

struct BoundsPush {
  PoolDomain domain;
  uint brick_count;
};

PALPATE_LAYOUT_CHECK(BoundsPush, 28)
PALPATE_PUSH_CHECK(BoundsPush)

PALPATE_LAYOUT_END
#endif
