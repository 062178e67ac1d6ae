// SPDX-License-Identifier: Apache-2.0
// shaders/edit.math.glsl: what an edit command does to four voxels along i. Its twin, engine/edit/edit_math.hpp, takes
// the same steps in the same order. min and max may differ in the sign of zero, so comparisons are used instead.
// `precise` keeps every product and sum apart.
//
// The kernels are specialised for one kind of command, since lavapipe takes every branch and masks what it stores.

const float kLargest = 3.4028234e38;  // results stay finite

vec4 lesser(vec4 a, vec4 b) { return mix(a, b, lessThan(b, a)); }
vec4 greater(vec4 a, vec4 b) { return mix(a, b, lessThan(a, b)); }

// Distance of the points (px, py, pz) from the stroke [m].
vec4 strokeDistance(EditCommand c, vec4 px, float py, float pz) {
  const float ab_x = c.ab_x, ab_y = c.ab_y, ab_z = c.ab_z;
  precise vec4 qx = px - c.a_x;
  precise float qy = py - c.a_y;
  precise float qz = pz - c.a_z;
  precise vec4 rx = qx, ry = vec4(qy), rz = vec4(qz);
  const float inv_ab2 = c.inv_ab2;
  if (inv_ab2 > 0.0) {
    precise float across = qy * ab_y + qz * ab_z;
    precise vec4 t = (qx * ab_x + across) * inv_ab2;
    t = lesser(greater(t, vec4(0)), vec4(1));
    rx = qx - t * ab_x;
    ry = qy - t * ab_y;
    rz = qz - t * ab_z;
  }
  precise vec4 square = (rx * rx + ry * ry) + rz * rz;
  return sqrt(square);
}

// Height above the command's plane [m].
vec4 planeHeight(EditCommand c, vec4 px, float py, float pz) {
  precise float across = (c.n_y * py + c.n_z * pz) - c.n_d;
  precise vec4 height = c.n_x * px + across;
  return height;
}

// Share of the way to the target, for points at `distance` from the stroke.
vec4 amountAt(EditCommand c, vec4 distance) {
  const float strength = c.strength;
  const float inv_fade = c.inv_fade;
  if (inv_fade == 0.0) return vec4(strength);
  precise vec4 s = (c.radius - distance) * inv_fade;
  s = lesser(greater(s, vec4(0)), vec4(1));
  precise vec4 smooth_s = (s * s) * (3.0 - 2.0 * s);
  precise vec4 amount = strength * smooth_s;
  return amount;
}

vec4 finite(vec4 f) { return lesser(greater(f, vec4(-kLargest)), vec4(kLargest)); }

// From density f towards `target`. Where the amount is nothing, or the point is out of reach, f stays bit for bit.
vec4 blend(vec4 f, vec4 target, vec4 amount, bvec4 reached) {
  precise vec4 step = amount * (target - f);
  precise vec4 blended = finite(f + step);
  const vec4 result = mix(blended, target, greaterThanEqual(amount, vec4(1)));
  return mix(f, result, bvec4(uvec4(reached) & uvec4(greaterThan(amount, vec4(0)))));
}

// Targets of the surface that a command makes, `depth` metres under it (negative: above it).
vec4 filledTarget(EditCommand c, vec4 f, vec4 depth) {
  precise vec4 ramp = c.isovalue + c.slope * depth;
  return greater(f, lesser(ramp, vec4(c.object)));
}
vec4 clearedTarget(EditCommand c, vec4 f, vec4 depth) {
  precise vec4 ramp = c.isovalue - c.slope * depth;
  return lesser(f, greater(ramp, vec4(c.background)));
}

// How much of a removal the material at density f lets happen.
vec4 materialRate(EditCommand c, vec4 f) {
  precise vec4 share = (f - c.material_low) * c.material_inv_range;
  share = lesser(greater(share, vec4(0)), vec4(1));
  precise vec4 rate = 1.0 - c.material_drop * share;
  return rate;
}
