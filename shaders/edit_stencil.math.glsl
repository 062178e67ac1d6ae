// SPDX-License-Identifier: Apache-2.0
// shaders/edit_stencil.math.glsl: the commands that read a voxel's neighbours: smooth, inflate, deflate. docs/edits.md
// defines them. Read by GLSL and by C++ (shaders/kernel_text.hpp), after edit.math.glsl.

// Densities before (0) and after (1) four voxels along each axis. Beyond the domain: the voxels' own.
struct EditNeighbours {
  vec4 x0, x1, y0, y1, z0, z1;
};

// One axis' part in the smoothed density: both differences to the neighbours, times their share. Near the largest float
// the parts of two axes might overflow with different signs, and their sum would be NaN. So each part is kept finite.
PALPATE_TEXT vec4 blur(vec4 f, vec4 before, vec4 after, float share) {
  precise vec4 sum = finite((before - f) + (after - f)) * share;
  return sum;
}

PALPATE_TEXT vec4 smoothed(vec4 f, EditNeighbours n, EditScale scale, vec4 amount) {
  precise vec4 sum = (blur(f, n.x0, n.x1, scale.blur_x) + blur(f, n.y0, n.y1, scale.blur_y)) +
                     blur(f, n.z0, n.z1, scale.blur_z);
  precise vec4 moved = finite(f + amount * sum);
  return moved;
}

// Square of the steepest rise to `top`, the higher of two neighbours along an axis. This is the upwind difference of a
// moving surface after Osher and Sethian (1988), which makes no new extrema.
PALPATE_TEXT vec4 upwindSquare(vec4 f, vec4 top, float inv_h) {
  precise vec4 steep = greater(top - f, vec4(0.0f)) * inv_h;
  precise vec4 square = steep * steep;
  return square;
}

// Moves the surface by `way` [m], outwards (sign 1) or inwards (sign -1). Moving inwards is the same with all densities
// negated. In this scheme no density passes its highest neighbour; the last line keeps that true if squares overflow.
PALPATE_TEXT vec4 inflated(vec4 f, EditNeighbours n, EditScale scale, vec4 way, float sign) {
  const vec4 here = sign * f;
  const vec4 top_x = greater(sign * n.x0, sign * n.x1);
  const vec4 top_y = greater(sign * n.y0, sign * n.y1);
  const vec4 top_z = greater(sign * n.z0, sign * n.z1);
  const vec4 highest = greater(greater(greater(here, top_x), top_y), top_z);
  precise vec4 square = (upwindSquare(here, top_x, scale.inv_h_x) + upwindSquare(here, top_y, scale.inv_h_y)) +
                        upwindSquare(here, top_z, scale.inv_h_z);
  precise vec4 moved = f + (way * sign) * lesser(sqrt(square), vec4(LARGEST_DENSITY));
  return mix(moved, sign * highest, lessThan(highest, sign * moved));
}

// The new densities of four voxels.
PALPATE_TEXT vec4 editedAmong(uint kind, EditCommand c, EditScale scale, vec4 px, float py, float pz, vec4 f,
                              EditNeighbours n) {
  const vec4 distance = strokeDistance(c, px, py, pz);
  const vec4 amount = amountAt(c, distance);
  vec4 moved = f;
  if (kind == EDIT_SMOOTH) {
    moved = smoothed(f, n, scale, amount);
  } else {
    precise vec4 way = amount * c.value;
    moved = inflated(f, n, scale, way, kind == EDIT_INFLATE ? 1.0f : -1.0f);
  }
  return mix(f, moved, both(lessThanEqual(distance, vec4(c.reach)), greaterThan(amount, vec4(0.0f))));
}
