// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_central4.comp: gradient.comp with differences of fourth order. 88 vec4 loads serve 64 gradients.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gradient.layout.h"

layout(local_size_x_id = GRADIENT_CONSTANT_GROUP) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#define FOURTH_ORDER
#include "gradient_row.glsl"
