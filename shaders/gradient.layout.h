// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.layout.h: push constants and bindings of the gradient kernel.
#ifndef PALPATE_GRADIENT_LAYOUT_H
#define PALPATE_GRADIENT_LAYOUT_H
#include "brick_pool.layout.h"

#define GRADIENT_BINDING_TASKS BINDING_OWN
#define GRADIENT_BINDING_SAMPLES (BINDING_OWN + 1)  // one sample slab, written
#define GRADIENT_BINDING_BOUNDS (BINDING_OWN + 2)   // of all bricks, for tasks with IF_ACTIVE
#define GRADIENT_BINDINGS (BINDING_OWN + 3)

PALPATE_LAYOUT_BEGIN

struct GradientPush {
  PoolDomain domain;
  uint first_task, task_count;
  float inv_2h_x, inv_2h_y, inv_2h_z;  // 1 / (2 * spacing), for the two-sided difference [1/m]
  float inv_h_x, inv_h_y, inv_h_z;     // 1 / spacing, for the one-sided difference at the border [1/m]
  float isovalue;                      // [density]
};

PALPATE_LAYOUT_CHECK(GradientPush, 60)
PALPATE_PUSH_CHECK(GradientPush)

PALPATE_LAYOUT_END
#endif
