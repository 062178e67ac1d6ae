// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.comp: plane-ready samples (gradient, density) of listed bricks, by central differences of second or
// fourth order. A work group is a brick, an invocation a row of eight voxels along i: ten vec4 loads serve eight
// gradients (eighteen at fourth order), with no shared memory (which lavapipe punishes).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gradient.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "gradient_row.glsl"
