// SPDX-License-Identifier: Apache-2.0
// shaders/filter_row_ends.glsl: rows of eight voxels with one neighbour at either end. For filters of reach 1 that
// treat bricks inside and at the border alike. Include after filter.glsl.
const int kRowWide = int(BRICK_EDGE) + 2;

// Reads row (y, z) of the domain within a brick column: voxels -1 ... 8 along i. Beyond the domain the last voxel
// repeats.
#define READ_ROW(row, brick_x, y, z)                                                                             \
  {                                                                                                              \
    const uint row_quad_ = (((z) % BRICK_EDGE) * BRICK_EDGE + (y) % BRICK_EDGE) * 2;                             \
    const uint row_page_ = brickIndex(uvec3(brick_x, (y) / BRICK_EDGE, (z) / BRICK_EDGE));                       \
    const BrickPage own_page_ = pages[row_page_];                                                                \
    const vec4 low_ = pageQuad(own_page_, row_quad_), high_ = pageQuad(own_page_, row_quad_ + 1);                \
    row[0] = low_[0];                                                                                            \
    row[kRowWide - 1] = high_[3];                                                                                \
    if ((brick_x) > 0) row[0] = pageQuad(pages[row_page_ - 1], row_quad_ + 1)[3];                                \
    if ((brick_x) + 1 < POOL_DOMAIN.bricks_x) row[kRowWide - 1] = pageQuad(pages[row_page_ + 1], row_quad_)[0];  \
    for (int t_ = 0; t_ < 4; ++t_) {                                                                             \
      row[1 + t_] = low_[t_];                                                                                    \
      row[5 + t_] = high_[t_];                                                                                   \
    }                                                                                                            \
  }
