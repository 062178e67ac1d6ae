// SPDX-License-Identifier: Apache-2.0
// shaders/edit_stamp.math.glsl: what a stamp does. A stamp is a signed distance, sampled on a lattice of its own and
// interpolated trilinearly. docs/edits.md defines it. Read by GLSL and by C++ (shaders/kernel_text.hpp), after
// edit.math.glsl.

struct StampPlace {
  bool inside;    // the place lies on the stamp's lattice
  uint first;     // index of the cell's first corner in the stamp buffer
  float u, v, w;  // place within the cell along the stamp's axes, 0 ... 1
};

// A coordinate of a position [m] in the stamp's lattice [voxel of the stamp], from one row of the command's matrix.
PALPATE_TEXT float stampCoordinate(float m_x, float m_y, float m_z, float m_t, float px, float py, float pz) {
  precise float at = ((m_x * px + m_y * py) + m_z * pz) + m_t;
  return at;
}

PALPATE_TEXT bool isOnStamp(float at, uint size) { return at >= 0.0f && at <= float(size - 1u); }

// The cell that holds a coordinate. The last voxel belongs to the cell before it.
PALPATE_TEXT uint stampCell(float at, uint size) {
  const uint cell = uint(at);
  return cell < size - 2u ? cell : size - 2u;
}

PALPATE_TEXT StampPlace stampPlace(EditCommand c, float px, float py, float pz) {
  const float u = stampCoordinate(c.m_xx, c.m_xy, c.m_xz, c.m_xt, px, py, pz);
  const float v = stampCoordinate(c.m_yx, c.m_yy, c.m_yz, c.m_yt, px, py, pz);
  const float w = stampCoordinate(c.m_zx, c.m_zy, c.m_zz, c.m_zt, px, py, pz);
  StampPlace place;
  place.inside = isOnStamp(u, c.stamp_x) && isOnStamp(v, c.stamp_y) && isOnStamp(w, c.stamp_z);
  place.first = c.stamp_first;
  place.u = 0.0f;
  place.v = 0.0f;
  place.w = 0.0f;
  if (!place.inside) return place;
  const uint x = stampCell(u, c.stamp_x);
  const uint y = stampCell(v, c.stamp_y);
  const uint z = stampCell(w, c.stamp_z);
  precise float in_x = u - float(x);
  precise float in_y = v - float(y);
  precise float in_z = w - float(z);
  place.first = c.stamp_first + (z * c.stamp_y + y) * c.stamp_x + x;
  place.u = in_x;
  place.v = in_y;
  place.w = in_z;
  return place;
}

// Distance [m], negative inside the mesh. low, high: distances at the corners of the cell's two sides along the stamp's
// third axis, its first axis fastest.
PALPATE_TEXT float stampDistance(StampPlace place, vec4 low, vec4 high) {
  const float below = lerped(lerped(low[0], low[1], place.u), lerped(low[2], low[3], place.u), place.v);
  const float above = lerped(lerped(high[0], high[1], place.u), lerped(high[2], high[3], place.u), place.v);
  return lerped(below, above, place.w);
}

// The new densities of four voxels; `inside`: where the stamp's lattice reaches.
PALPATE_TEXT vec4 stamped(uint kind, EditCommand c, vec4 distance, bvec4 inside, vec4 f) {
  const vec4 depth = -distance;
  vec4 target = greater(f, filledRamp(c, depth));
  if (kind == EDIT_STAMP_REMOVE) target = lesser(f, clearedRamp(c, depth));
  return blend(f, target, vec4(c.strength), both(inside, greaterThanEqual(depth, vec4(-c.reach))));
}
