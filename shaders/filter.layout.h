// SPDX-License-Identifier: Apache-2.0
// shaders/filter.layout.h: what the filter kernels share. Each reads one brick pool and writes bricks of another pool.
#ifndef PALPATE_FILTER_LAYOUT_H
#define PALPATE_FILTER_LAYOUT_H
#include "brick_pool.layout.h"

#define FILTER_BINDING_TASKS BINDING_OWN
#define FILTER_BINDING_RESULT (BINDING_OWN + 1)  // one density slab of the pool that is written
#define FILTER_BINDING_TAPS (BINDING_OWN + 2)    // numbers of the filter step, as floats
#define FILTER_BINDINGS (BINDING_OWN + 3)

// Specialisation constants of every filter kernel. Constant 0 is the pool's. Those of one kernel begin at
// FILTER_CONSTANT_OWN.
#define FILTER_CONSTANT_EDGE 1    // 1: for bricks whose reach crosses the border; 0: for the others
#define FILTER_CONSTANT_BORDER 2  // BORDER_...
#define FILTER_CONSTANT_OWN 3

#define BORDER_NEAREST 0u
#define BORDER_MIRROR 1u

// Which extreme filter_extreme_*.comp look for.
#define EXTREME_HIGHEST 0u
#define EXTREME_LOWEST 1u

#define FILTER_GROUP 64u  // invocations in a work group

PALPATE_LAYOUT_BEGIN

struct FilterTask {
  uint brick;  // linear page index
  uint slot;   // within the bound slab of the result
};

struct FilterPush {
  PoolDomain domain;
  uint first_task, task_count;
};

PALPATE_LAYOUT_CHECK(FilterTask, 8)
PALPATE_LAYOUT_CHECK(FilterPush, 32)
PALPATE_PUSH_CHECK(FilterPush)

PALPATE_LAYOUT_END
#endif
