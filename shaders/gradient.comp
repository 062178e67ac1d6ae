// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.comp: samples (gradient, density) of listed bricks, by central differences. A work group is a brick.
// An invocation computes some rows of eight voxels that follow each other along k, and reads each row that they need
// once. With eight rows 52 vec4 loads serve 64 gradients (with one row 80). It uses no shared memory, which is slow on
// lavapipe.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gradient.layout.h"

layout(local_size_x_id = GRADIENT_CONSTANT_GROUP) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "gradient_row.glsl"
