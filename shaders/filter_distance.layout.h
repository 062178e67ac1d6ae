// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance.layout.h: what the kernels of the signed distance share, in C++ and GLSL: their parameters,
// and the word that they keep for each voxel.
//
// The word holds two things. The first is the nearest surface point, as its offset from the voxel: from -8 to 8 voxels,
// each component rounded to 1/8 voxel. Rounding moves the point off the surface; filter_distance_finish.comp corrects
// that. The second is the voxel across: the nearest voxel on the other side of the surface, 0 to 7 whole voxels along
// each axis. It is exact, and bounds the distance from the surface on both sides. From the lowest bit on:
//
//   21 bits  surface point along i, j, k in steps of 1/8 voxel, plus 64; all zero: none is known
//    9 bits  voxel across along i, j, k, either way; all zero: none is known
//    1 bit   the opposite of the bit before it
//    1 bit   the voxel is inside
//
// The word is stored in place of a float. The last bit but one makes its bits those of a normal number (exponent 64 to
// 191): no denormal, NaN or zero. So copying it as a float cannot change it.
#ifndef PALPATE_FILTER_DISTANCE_LAYOUT_H
#define PALPATE_FILTER_DISTANCE_LAYOUT_H
#include "layout_types.h"

// Indices into the filter step's numbers (taps). Lengths are in units of the smallest spacing.
#define DISTANCE_ISOVALUE 0     // [density]
#define DISTANCE_BAND 1         // half width [unit]
#define DISTANCE_UNIT 2         // smallest spacing [m]
#define DISTANCE_SLACK 3        // radius in which a point's tangent plane counts: half a voxel's diagonal
#define DISTANCE_EDGE 4         // spacing along i, j, k [unit], at least 1
#define DISTANCE_EDGE_SQUARE 7  // their squares
#define DISTANCE_TAPS 10

#define DISTANCE_NONE 0u       // in place of a word: nothing is known, not even the voxel's side
#define DISTANCE_PARTS 8       // steps of an offset per voxel
#define DISTANCE_POINT_BITS 7  // bits of each component of the surface point
#define DISTANCE_POINT_MIDDLE 64
#define DISTANCE_POINT 0x1fffffu  // mask of the surface point
#define DISTANCE_ACROSS_BITS 3    // bits of each component of the voxel across
#define DISTANCE_ACROSS_FIRST 21
#define DISTANCE_ACROSS 0x3fe00000u  // mask of the voxel across
#define DISTANCE_INSIDE 0x80000000u
#define DISTANCE_LEFT 0.5f         // a stored surface point is taken to be at most this far off the surface [unit]
#define DISTANCE_FARTHEST 4096.0f  // square of eight units, in [1/8 unit]; no band reaches farther
#define DISTANCE_NOWHERE 1e38f     // squared: above every true distance

#endif
