// SPDX-License-Identifier: Apache-2.0
// shaders/active_brick.glsl: does the isosurface need a brick's samples? It does if it crosses cells of this brick or
// of a brick that shares its low faces, edges or corner (engine/bricks/active_bricks.hpp). Include after
// brick_pool.glsl, with `bounds` and ACTIVE_ISOVALUES defined.
bool brickIsActive(uvec3 brick) {
  const uvec3 low = brick - min(brick, uvec3(1));
  for (uint z = low.z; z <= brick.z; ++z) {
    for (uint y = low.y; y <= brick.y; ++y) {
      for (uint x = low.x; x <= brick.x; ++x) {
        if (eitherCrosses(ACTIVE_ISOVALUES, bounds[brickIndex(uvec3(x, y, z))])) return true;
      }
    }
  }
  return false;
}
