// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.layout.h: push constants, bindings and operators of the gradient kernels.
#ifndef PALPATE_GRADIENT_LAYOUT_H
#define PALPATE_GRADIENT_LAYOUT_H
#include "sample_code.layout.h"

#define GRADIENT_BINDING_TASKS BINDING_OWN
#define GRADIENT_BINDING_SAMPLES (BINDING_OWN + 1)  // one sample slab, written
#define GRADIENT_BINDING_BOUNDS (BINDING_OWN + 2)   // of all bricks, for tasks with IF_ACTIVE
#define GRADIENT_BINDINGS (BINDING_OWN + 3)
// gradient_smoothed.comp takes the gradient from a smoothed pool and the samples' densities from this second pool.
#define GRADIENT_BINDING_DENSITY_PAGES (BINDING_OWN + 3)
#define GRADIENT_BINDING_DENSITY_SLABS (BINDING_OWN + 4)
#define GRADIENT_SMOOTHED_BINDINGS (BINDING_OWN + 12)  // DENSITY_SLABS of them

// Specialisation constants. Constant 0 is the pool's.
#define GRADIENT_CONSTANT_HALF 1     // 1: samples are stored as halves (sample_code.layout.h)
#define GRADIENT_CONSTANT_RUN 2      // of gradient_row.glsl: rows along k that an invocation computes
#define GRADIENT_CONSTANT_GROUP 3    // of gradient_row.glsl: invocations of a brick, BRICK_ROWS / run
#define GRADIENT_CONSTANT_DENSITY 4  // of gradient_smoothed.comp: slabs of the densities, 1 to DENSITY_SLABS

#define GRADIENT_CENTRAL 0u   // (f(1) - f(-1)) / 2h: gradient.comp, gradient_smoothed.comp
#define GRADIENT_CENTRAL4 1u  // (8 (f(1) - f(-1)) - (f(2) - f(-2))) / 12h: gradient_central4.comp
#define GRADIENT_SOBEL 2u     // gradient_sobel.comp

#define SOBEL_BRICKS 8u  // bricks in a work group of gradient_sobel.comp, eight columns of rows each

PALPATE_LAYOUT_BEGIN

struct GradientPush {
  PoolDomain domain;
  uint first_task, task_count;
  float inv_2h_x, inv_2h_y, inv_2h_z;     // 1 / (2 * spacing), for the two-sided difference [1/m]
  float inv_h_x, inv_h_y, inv_h_z;        // 1 / spacing, for the one-sided difference at the border [1/m]
  float inv_12h_x, inv_12h_y, inv_12h_z;  // 1 / (12 * spacing), for the fourth-order difference [1/m]
  IsovaluePair isovalues;                 // these decide which bricks are active
  SampleCode code;
};

PALPATE_LAYOUT_CHECK(GradientPush, 88)
PALPATE_PUSH_CHECK(GradientPush)

PALPATE_LAYOUT_END
#endif
