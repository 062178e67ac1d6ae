// SPDX-License-Identifier: Apache-2.0
// shaders/cell_tree.glsl: steps along a ray from cell to cell and leaves space without isosurface in one step. Include
// after brick_pool.glsl, with CELL_TREE_LEVELS_USED and functions treeWord(which, i) and blockWord(which, i).
//
// Which cells a ray visits does not depend on the steps that it takes: the time at which it crosses a plane is computed
// from the plane alone, and a ray is in a cell from the last of the cell's three near planes to the first of its far
// ones. So a pixel stays the same when the tree changes elsewhere.

struct Ray {
  vec3 eye;        // [voxel]
  vec3 direction;  // [voxel/m], no element is 0
  vec3 inverse;    // [m/voxel]
  ivec3 forward;   // 1 where the direction is positive, else 0
};

vec3 planeTimes(Ray ray, ivec3 planes) { return (vec3(planes) - ray.eye) * ray.inverse; }
vec3 enterTimes(Ray ray, ivec3 cell) { return planeTimes(ray, cell + 1 - ray.forward); }
vec3 leaveTimes(Ray ray, ivec3 cell) { return planeTimes(ray, cell + ray.forward); }
float latest(vec3 times) { return max(max(times.x, times.y), times.z); }
float earliest(vec3 times) { return min(min(times.x, times.y), times.z); }

// The cell where the ray is at time t, in a box of cells or beside it: the next one where t is the box's end.
ivec3 cellAt(Ray ray, float t, ivec3 low, ivec3 high) {
  const ivec3 guess = clamp(ivec3(floor(ray.eye + t * ray.direction)), low, high);
  const ivec3 step = 2 * ray.forward - 1;
  return guess + step * (ivec3(lessThanEqual(leaveTimes(ray, guess), vec3(t))) -
                         ivec3(greaterThan(enterTimes(ray, guess), vec3(t))));
}

// The brick in which a ray was found last, so that it is looked up once.
struct KnownBrick {
  uint index;
  uint blocks;  // slot of its cells
};
const KnownBrick kNoBrick = KnownBrick(0xffffffffu, 0u);

// Edges of the largest box of the tree around a cell that holds no isosurface; 0 where the isosurface crosses the cell.
// Boxes are aligned to their edges.
ivec3 emptyAround(const int which, ivec3 cell, inout KnownBrick known) {
  const uvec3 at = uvec3(cell);
  const uint brick = brickIndex(at >> 3u);
  int edge = 0;
  if (brick != known.index) {
    [[unroll]] for (uint level = CELL_TREE_LEVELS_USED; level >= 1u; --level) {
      const uint shift = 1u + 2u * level;  // of the children: bricks at level 1
      const uvec3 child = at >> shift;
      const uvec3 node = child >> 2u;
      const uint nodes_x = cellNodesAlong(POOL_DOMAIN.bricks_x, level), nodes_y = cellNodesAlong(POOL_DOMAIN.bricks_y, level);
      const uint bit = (child.z & 3u) << 4u | (child.y & 3u) << 2u | (child.x & 3u);
      if (edge == 0) {
        const uint word = treeWord(which, cellLevelBegin(POOL_DOMAIN, level) +
                                              2u * ((node.z * nodes_y + node.y) * nodes_x + node.x) + (bit >> 5u));
        if ((word >> (bit & 31u) & 1u) == 0u) edge = 1 << shift;
      }
    }
    if (edge == 0) known = KnownBrick(brick, treeWord(which, 1u + brick));
  }
  if (edge != 0) return ivec3(edge);
  const uint block = (at.z >> 2u & 1u) << 2u | (at.y >> 2u & 1u) << 1u | (at.x >> 2u & 1u);
  const uint word = blockWord(which, known.blocks * CELL_WORDS_OF_BRICK + 2u * block + (at.z >> 1u & 1u));
  if (word == 0u) return ivec3(4, 4, 2);
  const uint bit = (at.z & 1u) << 4u | (at.y & 3u) << 2u | (at.x & 3u);
  return (word >> bit & 1u) == 0u ? ivec3(1) : ivec3(0);
}
