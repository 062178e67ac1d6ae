// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_task.glsl: what the gradient kernels share: their buffers, and writing samples as floats or halves.
// Include after brick_pool.glsl.
#include "gradient.math.glsl"

layout(constant_id = GRADIENT_CONSTANT_HALF) const uint kHalf = 0;

layout(std430, binding = GRADIENT_BINDING_TASKS) readonly buffer Tasks { BrickTask tasks[]; };
layout(std430, binding = GRADIENT_BINDING_SAMPLES) writeonly buffer Samples { uvec4 samples[]; };
layout(std430, binding = GRADIENT_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
#define ACTIVE_ISOVALUES push.isovalues
#include "active_brick.glsl"
#define SAMPLE_CODE push.code
#include "sample_code.glsl"

float element(Row row, uint i) { return i < 4 ? row.low[i] : row.high[i - 4]; }

// Writes the sample of voxel `at`, counted over the slab. Halves go out in pairs: every second call writes two samples.
// `before`: the sample of the voxel before.
void writeSample(uint at, vec4 before, vec4 value) {
  if (kHalf == 0) {
    samples[at] = floatBitsToUint(value);
  } else if ((at & 1u) == 1) {
    samples[at / 2] = uvec4(packedSample(before), packedSample(value));
  }
}
