// SPDX-License-Identifier: Apache-2.0
// shaders/filter_rows.glsl: the rows of eight voxels around one row of a brick, and the densities before and after them
// along i. Include after filter.glsl.

// Where a row is: the page of its brick, and the first quad within that brick.
struct RowPlace {
  uint page, quad;
};

// The row (dj, dk) voxels away from row `row` of a brick. Rows outside the domain read the same row as the nearest one
// inside.
RowPlace rowPlace(uvec3 brick, uint row, int dj, int dk) {
  int y = int(row % BRICK_EDGE) + dj, z = int(row / BRICK_EDGE) + dk;
  if (kEdge != 0) {
    const ivec3 last = ivec3(domainSize()) - 1;
    y = mapped(min(int(brick.y * BRICK_EDGE + row % BRICK_EDGE), last.y) + dj, last.y + 1) - int(brick.y * BRICK_EDGE);
    z = mapped(min(int(brick.z * BRICK_EDGE + row / BRICK_EDGE), last.z) + dk, last.z + 1) - int(brick.z * BRICK_EDGE);
  }
  const int away = (z >> 3) * int(POOL_DOMAIN.bricks_y) + (y >> 3);  // in bricks, rounded down
  const int page = int(brickIndex(brick)) + away * int(POOL_DOMAIN.bricks_x);
  return RowPlace(uint(page), uint(((z & 7) * BRICK_EDGE + (y & 7)) * 2));
}

// The density `at` places after the row's first voxel, or before it if `at` is negative.
float besideRow(RowPlace place, uvec3 brick, int at) {
  int x = at;
  if (kEdge != 0) x = mapped(int(brick.x * BRICK_EDGE) + at, int(domainSize().x)) - int(brick.x * BRICK_EDGE);
  const BrickPage page = pages[uint(int(place.page) + (x >> 3))];
  return pageDensity(page, place.quad + uint((x & 7) >> 2), uint(x & 3));
}

// Whether a filter of this reach along i can read the row's own quads. Behind the domain they repeat the last voxel. A
// mirrored border repeats it too, but only in the first voxel behind the domain.
bool ownQuadsHold(int reach) { return kEdge == 0 || kBorder == BORDER_NEAREST || reach <= 1; }
