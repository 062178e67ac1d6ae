// SPDX-License-Identifier: Apache-2.0
// shaders/half_voxel_march.comp: how the isosurface was drawn before draw.comp, kept for `palpate bench render`: one ray for each pixel marches from brick to brick. A brick whose
// bounds cannot hold the isovalue is crossed in one step. A ray that enters the domain inside the object hits its cut
// face.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "half_voxel_march.layout.h"

layout(local_size_x = HALF_VOXEL_MARCH_GROUP, local_size_y = HALF_VOXEL_MARCH_GROUP) in;
layout(push_constant) uniform Push { HalfVoxelMarchPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "half_voxel_march.math.glsl"

layout(std430, binding = HALF_VOXEL_MARCH_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
layout(std430, binding = HALF_VOXEL_MARCH_BINDING_PIXELS) writeonly buffer Pixels { PicturePixel pixels[]; };

const float kInfinity = 1.0 / 0.0;
const float kStepVoxels = 0.5;

struct Hit {
  bool found;
  bool on_face;  // on the domain's border: a cut face
  float t_m;
};

vec2 boxSpan(vec3 eye, vec3 per_metre, vec3 low, vec3 high) {
  const vec3 a = (low - eye) / per_metre, b = (high - eye) / per_metre;
  const vec3 near = min(a, b), far = max(a, b);
  return vec2(max(max(near.x, near.y), near.z), min(min(far.x, far.y), far.z));
}

bool brickMayHoldSurface(uvec3 brick) {
  return crosses(push.isovalue, bounds[brickIndex(brick)]);
}

Hit march(vec3 eye, vec3 per_metre) {
  const vec3 last = vec3(domainSize() - 1);
  const vec2 span = boxSpan(eye, per_metre, vec3(0), last);
  const float start = max(span.x, 0.0);
  if (start >= span.y) return Hit(false, false, 0);
  if (trilinear(eye + start * per_metre) > push.isovalue) return Hit(true, start > 0, start);

  const float step_m = kStepVoxels / max(max(abs(per_metre.x), abs(per_metre.y)), abs(per_metre.z));
  float t = start, outside = start;
  while (t < span.y) {
    const uvec3 brick = uvec3(clamp(eye + t * per_metre, vec3(0), last - 1)) / BRICK_EDGE;
    if (!brickMayHoldSurface(brick)) {
      const vec3 low = vec3(brick * BRICK_EDGE);
      t = max(boxSpan(eye, per_metre, low, low + BRICK_EDGE).y, t) + 0.01 * step_m;
      outside = t;
      continue;
    }
    if (trilinear(eye + t * per_metre) > push.isovalue) {
      float inside = t;
      for (int i = 0; i < HALF_VOXEL_MARCH_BISECTIONS; ++i) {
        const float middle = 0.5 * (outside + inside);
        if (trilinear(eye + middle * per_metre) > push.isovalue) inside = middle; else outside = middle;
      }
      return Hit(true, false, 0.5 * (outside + inside));
    }
    outside = t;
    t += step_m;
  }
  return Hit(false, false, 0);
}

vec3 faceNormal(vec3 p) {
  const vec3 last = vec3(domainSize() - 1);
  const vec3 from_low = p, from_high = last - p;
  const vec3 nearest = min(from_low, from_high);
  const vec3 side = mix(vec3(-1), vec3(1), lessThan(from_high, from_low));
  if (nearest.x <= nearest.y && nearest.x <= nearest.z) return vec3(side.x, 0, 0);
  return nearest.y <= nearest.z ? vec3(0, side.y, 0) : vec3(0, 0, side.z);
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy + uvec2(0, push.first_row);
  if (pixel.x >= push.width || pixel.y >= push.height) return;
  const vec3 spacing = vec3(push.rays.spacing_x, push.rays.spacing_y, push.rays.spacing_z);
  const vec3 right = vec3(push.rays.right_x, push.rays.right_y, push.rays.right_z);
  const vec3 down = vec3(push.rays.down_x, push.rays.down_y, push.rays.down_z);
  const vec3 direction = normalize(vec3(push.rays.corner_x, push.rays.corner_y, push.rays.corner_z) + (pixel.x + 0.5) * right +
                                   (pixel.y + 0.5) * down);
  const vec3 eye = vec3(push.rays.eye_x, push.rays.eye_y, push.rays.eye_z);
  // A direction of zero along an axis would divide 0 by 0 at a box face. This small a direction moves nothing by a
  // pixel.
  const vec3 per_metre = direction / spacing + vec3(equal(direction, vec3(0))) * 1e-6;

  const Hit hit = march(eye, per_metre);
  vec4 colour = unpackUnorm4x8(PICTURE_BACKGROUND);
  if (hit.found) {
    const vec3 p = eye + hit.t_m * per_metre;
    const vec3 gradient = smoothGradient(p, spacing);
    const float steepness = length(gradient);
    vec3 normal = steepness > 0.0 ? -gradient / steepness : -direction;
    if (hit.on_face) normal = faceNormal(p);
    colour = vec4(shade(normal, -direction, normalize(right), normalize(down)), 1);
  }
  pixels[pixel.y * push.width + pixel.x] = PicturePixel(packUnorm4x8(colour), hit.found ? hit.t_m : kInfinity);
}
