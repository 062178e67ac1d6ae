// SPDX-License-Identifier: Apache-2.0
// shaders/edit.math.glsl: what an edit command does to four voxels along i. docs/edits.md defines it and the order of
// its operations. `precise` keeps products and sums from being fused. Read by GLSL and by C++
// (shaders/kernel_text.hpp), after numbers.math.glsl.
//
// `kind` is the command's kind. Kernels pass a constant, so each kernel holds the arithmetic of one kind only.
// Otherwise lavapipe would take every branch and mask what it stores.

// Place of voxels along an axis of the lattice, from the command's origin voxel [m].
PALPATE_TEXT vec4 placesAlong(ivec4 voxels, int origin, float spacing) {
  precise vec4 places = vec4(voxels - origin) * spacing;
  return places;
}
PALPATE_TEXT float placeAlong(int voxel, int origin, float spacing) {
  precise float place = float(voxel - origin) * spacing;
  return place;
}

// Distance of the points (px, py, pz) from the stroke [m].
PALPATE_TEXT vec4 strokeDistance(EditCommand c, vec4 px, float py, float pz) {
  precise vec4 qx = px - c.a_x;
  precise float qy = py - c.a_y;
  precise float qz = pz - c.a_z;
  precise vec4 rx = qx;
  precise vec4 ry = vec4(qy);
  precise vec4 rz = vec4(qz);
  if (c.inv_ab2 > 0.0f) {
    precise float across = qy * c.ab_y + qz * c.ab_z;
    precise vec4 t = (qx * c.ab_x + across) * c.inv_ab2;
    t = lesser(greater(t, vec4(0.0f)), vec4(1.0f));
    rx = qx - t * c.ab_x;
    ry = qy - t * c.ab_y;
    rz = qz - t * c.ab_z;
  }
  precise vec4 square = (rx * rx + ry * ry) + rz * rz;
  return sqrt(square);
}

// Height above the command's plane [m].
PALPATE_TEXT vec4 planeHeight(EditCommand c, vec4 px, float py, float pz) {
  precise float across = (c.n_y * py + c.n_z * pz) - c.n_d;
  precise vec4 height = c.n_x * px + across;
  return height;
}

// Share of its fade that a command has at `distance` from the stroke: 1 where it has its full strength, 0 at the rim.
PALPATE_TEXT vec4 fadeShare(EditCommand c, vec4 distance) {
  if (c.inv_fade == 0.0f) return vec4(1.0f);
  precise vec4 share = (c.radius - distance) * c.inv_fade;
  return lesser(greater(share, vec4(0.0f)), vec4(1.0f));
}

// Share of the way to the target at `distance` from the stroke.
PALPATE_TEXT vec4 amountAt(EditCommand c, vec4 distance) {
  if (c.inv_fade == 0.0f) return vec4(c.strength);
  const vec4 s = fadeShare(c, distance);
  precise vec4 amount = c.strength * ((s * s) * (3.0f - 2.0f * s));
  return amount;
}

// Moves density f towards `target`. If the amount is 0 or the point is out of reach, f stays as it is, bit for bit.
PALPATE_TEXT vec4 blend(vec4 f, vec4 target, vec4 amount, bvec4 reached) {
  precise vec4 blended = finite(f + amount * (target - f));
  const vec4 moved = mix(blended, target, greaterThanEqual(amount, vec4(1.0f)));
  return mix(f, moved, both(reached, greaterThan(amount, vec4(0.0f))));
}

// The ramp of a new surface, `depth` metres under it (negative: above it). filledRamp() is that of a filled region,
// clearedRamp() that of a cleared one.
PALPATE_TEXT vec4 filledRamp(EditCommand c, vec4 depth) {
  precise vec4 ramp = c.isovalue + c.slope * depth;
  return lesser(ramp, vec4(c.object));
}
PALPATE_TEXT vec4 clearedRamp(EditCommand c, vec4 depth) {
  precise vec4 ramp = c.isovalue - c.slope * depth;
  return greater(ramp, vec4(c.background));
}

// Share of a removal that takes effect in material of density f.
PALPATE_TEXT vec4 materialRate(EditCommand c, vec4 f) {
  precise vec4 share = (f - c.material_low) * c.material_inv_range;
  share = lesser(greater(share, vec4(0.0f)), vec4(1.0f));
  precise vec4 rate = 1.0f - c.material_drop * share;
  return rate;
}

// ---- The new densities, for kinds that read no neighbour.

PALPATE_TEXT vec4 cutOff(EditCommand c, vec4 px, float py, float pz, vec4 f) {
  const vec4 height = planeHeight(c, px, py, pz);
  const vec4 target = lesser(f, clearedRamp(c, height));
  return blend(f, target, vec4(c.strength), greaterThanEqual(height, vec4(-c.reach)));
}

PALPATE_TEXT vec4 brushed(uint kind, EditCommand c, vec4 px, float py, float pz, vec4 f) {
  const vec4 distance = strokeDistance(c, px, py, pz);
  precise vec4 depth = c.radius - distance;
  precise vec4 amount = amountAt(c, distance);
  vec4 target = vec4(c.value);
  if (kind == EDIT_ADD) target = greater(f, filledRamp(c, depth));
  if (kind == EDIT_REMOVE) {
    target = lesser(f, clearedRamp(c, depth));
    if (c.material_drop > 0.0f) amount = amount * materialRate(c, f);
  }
  if (kind == EDIT_FLATTEN) target = lesser(clearedRamp(c, planeHeight(c, px, py, pz)), vec4(c.object));
  return blend(f, target, amount, lessThanEqual(distance, vec4(c.reach)));
}

// All kinds but stamps.
PALPATE_TEXT vec4 edited(uint kind, EditCommand c, vec4 px, float py, float pz, vec4 f) {
  if (kind == EDIT_CUT) return cutOff(c, px, py, pz, f);
  return brushed(kind, c, px, py, pz, f);
}
