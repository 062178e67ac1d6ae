// SPDX-License-Identifier: Apache-2.0
// shaders/window.layout.h: push constants and bindings of the window kernel.
#ifndef PALPATE_WINDOW_LAYOUT_H
#define PALPATE_WINDOW_LAYOUT_H
#include "sample_code.layout.h"

#define WINDOW_BINDING_TASKS BINDING_OWN
#define WINDOW_BINDING_SAMPLES (BINDING_OWN + 1)  // one sample slab, read
#define WINDOW_BINDING_WINDOW (BINDING_OWN + 2)   // the window, written
#define WINDOW_BINDING_BOUNDS (BINDING_OWN + 3)   // of all bricks, for tasks with IF_ACTIVE
#define WINDOW_BINDINGS (BINDING_OWN + 4)

#define WINDOW_CONSTANT_HALF 1  // specialisation constant; 1: samples are stored as halves

PALPATE_LAYOUT_BEGIN

struct WindowPush {
  PoolDomain domain;
  uint first_task, task_count;
  uint first_x, first_y, first_z;     // the window's first voxel in the volume
  uint window_x, window_y, window_z;  // its size [voxel]
  IsovaluePair isovalues;             // these decide which bricks are active
  SampleCode code;
};

PALPATE_LAYOUT_CHECK(WindowPush, 76)
PALPATE_PUSH_CHECK(WindowPush)

PALPATE_LAYOUT_END
#endif
