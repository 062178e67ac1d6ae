// SPDX-License-Identifier: Apache-2.0
// shaders/edit_stamp.glsl: the signed distance of a stamp, trilinear in its lattice. Twin: engine/edit/edit_math.hpp.

float stampLerp(float a, float b, float t) {
  precise float way = t * (b - a);
  precise float value = a + way;
  return value;
}

// Distance [m] at a position [m], negative inside; `inside` says whether the stamp's lattice reaches there.
float stampDistance(EditCommand c, float px, float py, float pz, out bool inside) {
  precise float u = ((c.m_xx * px + c.m_xy * py) + c.m_xz * pz) + c.m_xt;
  precise float v = ((c.m_yx * px + c.m_yy * py) + c.m_yz * pz) + c.m_yt;
  precise float w = ((c.m_zx * px + c.m_zy * py) + c.m_zz * pz) + c.m_zt;
  const uvec3 n = uvec3(c.stamp_x, c.stamp_y, c.stamp_z);
  inside = u >= 0.0 && v >= 0.0 && w >= 0.0 && u <= float(n.x - 1) && v <= float(n.y - 1) && w <= float(n.z - 1);
  if (!inside) return 0.0;
  const uvec3 cell = min(uvec3(uint(u), uint(v), uint(w)), n - 2u);
  precise float fu = u - float(cell.x), fv = v - float(cell.y), fw = w - float(cell.z);
  const uint at = c.stamp_first + (cell.z * n.y + cell.y) * n.x + cell.x;
  const uint up = n.x, deep = n.x * n.y;
  precise float low = stampLerp(stampLerp(stamps[at], stamps[at + 1], fu),
                                stampLerp(stamps[at + up], stamps[at + up + 1], fu), fv);
  precise float high = stampLerp(stampLerp(stamps[at + deep], stamps[at + deep + 1], fu),
                                 stampLerp(stamps[at + deep + up], stamps[at + deep + up + 1], fu), fv);
  return stampLerp(low, high, fw);
}
