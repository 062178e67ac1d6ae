// SPDX-License-Identifier: Apache-2.0
// shaders/draw.comp: draws the isosurface: a ray for each pixel steps through the cells of the volume, past all that the
// cell tree knows to be empty, to the exact root in the first cell where the density along it exceeds the isovalue. A
// ray that enters the domain inside the object hits its cut face, as does one that begins at a clipping plane there.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "cell_tree.layout.h"
#include "draw.layout.h"

layout(local_size_x = DRAW_TILE * DRAW_TILE) in;
layout(constant_id = DRAW_CONSTANT_LEVELS) const uint kLevels = 1;
layout(constant_id = DRAW_CONSTANT_CLIPS) const uint kClips = 0;
layout(constant_id = DRAW_CONSTANT_SLICES) const uint kSlices = 0;
layout(constant_id = DRAW_CONSTANT_OTHER) const uint kOther = 0;
layout(constant_id = DRAW_CONSTANT_OCCLUSION) const uint kOcclusion = 0;
layout(constant_id = DRAW_CONSTANT_NORMALS) const uint kNormals = 0;

layout(push_constant) uniform Push { DrawPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = DRAW_BINDING_TREE) readonly buffer Tree { uint tree[]; };
layout(std430, binding = DRAW_BINDING_BLOCKS) readonly buffer Blocks { uint blocks[]; };
layout(std430, binding = DRAW_BINDING_OTHER_TREE) readonly buffer OtherTree { uint other_tree[]; };
layout(std430, binding = DRAW_BINDING_OTHER_BLOCKS) readonly buffer OtherBlocks { uint other_blocks[]; };
layout(std430, binding = DRAW_BINDING_TILES) readonly buffer Tiles { uint tiles[]; };
layout(std430, binding = DRAW_BINDING_EXTRAS) readonly buffer Extras { DrawExtras extras; };
layout(std430, binding = DRAW_BINDING_PIXELS) writeonly buffer Pixels { PicturePixel pixels[]; };

const float kInfinity = 1.0 / 0.0;

uint treeWord(const int which, uint i) { return which == 0 ? tree[i] : other_tree[i]; }
uint blockWord(const int which, uint i) { return which == 0 ? blocks[i] : other_blocks[i]; }
#define CELL_TREE_LEVELS_USED kLevels
#include "cell_tree.glsl"
#include "draw_cell.math.glsl"
#include "draw_shade.glsl"

struct Hit {
  float t_m;  // infinity: nothing is hit
  ivec3 cell;
  vec3 place;  // in the cell
};

// First point with density above the isovalue from t_begin to t_end. The ray is outside the object at t_begin. The root
// is found after the loop: neighbouring invocations run in step, and each would wait for those that have one.
Hit march(const int which, float isovalue, Ray ray, float t_begin, float t_end) {
  float t = t_begin, t_leave = t_end;
  const uint most_steps = 4 * (push.domain.size_x + push.domain.size_y + push.domain.size_z);  // a ray enters fewer cells
  uint steps = 0;
  ivec3 cell = cellAt(ray, t, ivec3(0), ivec3(domainSize()) - 2);
  float corners[8];
  vec3 from, to;
  CellInterval found;
  bool is_found = false;
  KnownBrick known = kNoBrick;
  while (t < t_end) {
    for (;;) {
      const ivec3 edge = emptyAround(which, cell, known);
      if (edge.x == 0) break;
      const ivec3 low = cell & -edge;
      t = earliest(planeTimes(ray, low + edge * ray.forward));
      if (!(t < t_end) || ++steps > most_steps) break;
      cell = cellAt(ray, t, low, low + edge - 1);
    }
    if (!(t < t_end) || ++steps > most_steps) break;
    const vec3 enter = enterTimes(ray, cell), leave = leaveTimes(ray, cell);
    t_leave = min(earliest(leave), t_end);
    // A face that is crossed at this very time lies at 0 or 1.
    const vec3 at = ray.eye - vec3(cell);
    const vec3 face = vec3(ray.forward);
    from = mix(clamp(at + t * ray.direction, 0.0, 1.0), 1.0 - face, equal(enter, vec3(t)));
    to = mix(clamp(at + t_leave * ray.direction, 0.0, 1.0), face, equal(leave, vec3(t_leave)));
    cornersOf(uvec3(cell), corners);
    scaleCorners(corners, isovalue);
    found = firstInterval(corners, from, to);
    is_found = found.at_high > 0.0;
    if (is_found) break;
    t = t_leave;
    if (t < t_end) cell = cellAt(ray, t, cell, cell);
  }
  if (!is_found) return Hit(kInfinity, ivec3(0), vec3(0));
  const float root = rootIn(found, corners, from, to);
  return Hit(t + root * (t_leave - t), cell, from + root * (to - from));
}

struct Span {
  float begin, end;
  vec3 normal;  // of what the ray meets at its begin, outwards
};

// Where the ray is in the domain and on the kept side of the clipping planes.
Span spanOf(Ray ray, vec3 spacing) {
  const ivec3 last = ivec3(domainSize()) - 1;
  const vec3 enter = planeTimes(ray, last * (1 - ray.forward)), leave = planeTimes(ray, last * ray.forward);
  Span span = Span(max(latest(enter), 0.0), earliest(leave), vec3(0));
  span.normal = vec3(equal(enter, vec3(span.begin))) * (1.0 - 2.0 * vec3(ray.forward));
  for (uint i = 0; i < kClips; ++i) {
    const DrawPlane plane = extras.clips[i];
    const vec3 n = vec3(plane.x, plane.y, plane.z);
    const float at_eye = dot(n, ray.eye) + plane.d, change = dot(n, ray.direction);
    if (change > 0.0) {
      const float t = -at_eye / change;
      if (t > span.begin) {
        span.begin = t;
        span.normal = -n / spacing;
      }
    } else if (change < 0.0) {
      span.end = min(span.end, -at_eye / change);
    } else if (at_eye < 0.0) {
      span.end = -kInfinity;
    }
  }
  return span;
}

Hit firstHit(const int which, float isovalue, Ray ray, Span span) {
  if (!(span.begin < span.end)) return Hit(kInfinity, ivec3(0), vec3(0));
  if (trilinear(ray.eye + span.begin * ray.direction) > isovalue) return Hit(span.begin, ivec3(-1), vec3(0));
  return march(which, isovalue, ray, span.begin, span.end);
}

// The time in which the ray goes a hundredth of a voxel. A plane of voxels that bounds the volume, or that clips it, is
// crossed at a time that is rounded otherwise than the slice's: within this they are the same place.
float slackOf(Ray ray) { return 0.01 * min(min(abs(ray.inverse.x), abs(ray.inverse.y)), abs(ray.inverse.z)); }

// Slice planes show the density where the ray crosses them in the volume.
struct Slice {
  float t_m;
  vec4 colour;
};
Slice firstSlice(Ray ray, Span span) {
  float t_m = kInfinity;
  for (uint i = 0; i < kSlices && span.begin < span.end; ++i) {
    const DrawPlane plane = extras.slices[i];
    const vec3 n = vec3(plane.x, plane.y, plane.z);
    const float t = -(dot(n, ray.eye) + plane.d) / dot(n, ray.direction);
    if (t >= span.begin - slackOf(ray) && t <= span.end + slackOf(ray)) t_m = min(t_m, max(t, 0.0));
  }
  const float density = isinf(t_m) ? 0.0 : trilinear(ray.eye + t_m * ray.direction);
  const float grey = clamp((density - extras.slice_black) / (extras.slice_white - extras.slice_black), 0.0, 1.0);
  return Slice(t_m, vec4(vec3(grey), 1));
}

// What a pixel shows, and how far along its ray that is.
struct Seen {
  vec4 colour;
  float t_m;
};

// Puts one of the isosurfaces before what was seen so far: first the opaque one and the slices, then the translucent one.
void see(const int which, Ray ray, Span span, Frame frame, inout Seen seen) {
  const bool is_first = which == 0;
  const float isovalue = is_first ? push.isovalue : extras.other_isovalue;
  const Hit hit = firstHit(which, isovalue, ray, span);
  if (hit.t_m < seen.t_m) {
    const vec4 surface = surfaceColour(frame, isovalue, hit.cell, hit.place, span.normal, is_first ? kBone : kSkin);
    const vec4 before = seen.colour.a > 0.0 ? vec4(mix(seen.colour.rgb, surface.rgb, extras.other_opacity), 1)
                                            : vec4(surface.rgb, extras.other_opacity);
    seen.colour = is_first ? surface : before;
    if (is_first) seen.t_m = hit.t_m;
  }
  if (kSlices > 0 && is_first) {
    const Slice slice = firstSlice(ray, span);
    // A slice in the plane of a cut face is seen on it.
    if (!isinf(slice.t_m) && slice.t_m <= (hit.cell.x < 0 ? seen.t_m + slackOf(ray) : seen.t_m)) {
      seen.t_m = slice.t_m;
      seen.colour = slice.colour;
    }
  }
}

void main() {
  const uint tile_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (tile_index >= push.tile_count) return;
  const uint tile = tiles[push.first_tile + tile_index];
  // Eight neighbouring invocations, which run in step on a processor, are a block of 4x2 pixels.
  const uint i = gl_LocalInvocationID.x;
  const uvec2 in_tile = uvec2(i & 3 | i >> 1 & 4, i >> 2 & 1 | i >> 3 & 6);
  const uint stride = push.grid & 255, square = push.grid >> 24;
  const uvec2 size = uvec2(push.size & 65535, push.size >> 16);
  const uvec2 pixel = (uvec2(tile & 65535, tile >> 16) * DRAW_TILE + in_tile) * stride + (uvec2(push.grid) >> uvec2(8, 16) & 255);
  if (any(greaterThanEqual(pixel, size))) return;

  const vec3 spacing = vec3(push.rays.spacing_x, push.rays.spacing_y, push.rays.spacing_z);
  const vec3 right = vec3(push.rays.right_x, push.rays.right_y, push.rays.right_z);
  const vec3 down = vec3(push.rays.down_x, push.rays.down_y, push.rays.down_z);
  const vec3 direction = normalize(vec3(push.rays.corner_x, push.rays.corner_y, push.rays.corner_z) + (pixel.x + 0.5) * right +
                                   (pixel.y + 0.5) * down);
  // A direction of nearly zero along an axis would divide by zero at a plane. This small a direction moves nothing by a
  // hundredth of a voxel.
  const vec3 wanted = direction / spacing;
  const float least = 1e-7 * max(max(abs(wanted.x), abs(wanted.y)), abs(wanted.z));
  const vec3 per_metre = mix(wanted, mix(vec3(least), vec3(-least), lessThan(wanted, vec3(0))), lessThan(abs(wanted), vec3(least)));
  const Ray ray = Ray(vec3(push.rays.eye_x, push.rays.eye_y, push.rays.eye_z), per_metre, 1.0 / per_metre, ivec3(greaterThan(per_metre, vec3(0))));

  const Span span = spanOf(ray, spacing);
  const vec3 forward = vec3(push.rays.corner_x, push.rays.corner_y, push.rays.corner_z) + 0.5 * (size.x * right + size.y * down);
  const Frame frame = Frame(direction, normalize(right), normalize(down), forward, spacing);
  Seen seen = Seen(unpackUnorm4x8(PICTURE_BACKGROUND), kInfinity);
  if (kOther == 0) {
    see(0, ray, span, frame, seen);
  } else {  // in a loop, so that drivers compile what it does, which is most of this kernel, once
    [[dont_unroll]] for (int which = 0; which < 2; ++which) see(which, ray, span, frame, seen);
  }
  const PicturePixel drawn = PicturePixel(packUnorm4x8(seen.colour), seen.t_m);
  const uvec2 end = min(pixel + square, size);
  for (uint y = pixel.y; y < end.y; ++y) {
    for (uint x = pixel.x; x < end.x; ++x) pixels[y * size.x + x] = drawn;
  }
}
