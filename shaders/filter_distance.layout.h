// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance.layout.h: what the kernels of a distance share: the numbers that they are given, and the word
// in which a voxel keeps the surface point that it knows. C++ and GLSL.
//
// The word keeps two things. The surface point, as its offset from the voxel, each component rounded to 1/8 voxel, from
// -8 to 8 voxels: what rounding moves it off the surface, the finish takes back. And how far the nearest voxel across the
// surface lies, 0 to 7 whole voxels along each axis: that is exact, and bounds the distance from the surface on both
// sides. From the lowest bit on:
//
//   21 bits  surface point along i, j, k in steps of 1/8 voxel, plus 64; all zero: none is known
//    9 bits  voxel across along i, j, k, either way; all zero: none is known
//    1 bit   the opposite of the bit before it
//    1 bit   the voxel is inside
//
// The word lies in a float's place. By the bit but one its bits are those of an ordinary number (exponent 64 ... 191),
// neither a denormal nor NaN nor zero, so nothing that copies floats can change it.
#ifndef PALPATE_FILTER_DISTANCE_LAYOUT_H
#define PALPATE_FILTER_DISTANCE_LAYOUT_H
#include "layout_types.h"

// Places in the step's taps. Lengths are in units of the smallest spacing.
#define DISTANCE_ISOVALUE 0     // [density]
#define DISTANCE_BAND 1         // half width [unit]
#define DISTANCE_UNIT 2         // smallest spacing [m]
#define DISTANCE_SLACK 3        // how far beside a surface point its tangent plane is believed: half a voxel's diagonal
#define DISTANCE_EDGE 4         // spacing along i, j, k [unit], at least 1
#define DISTANCE_EDGE_SQUARE 7  // their squares
#define DISTANCE_TAPS 10

#define DISTANCE_NONE 0u             // in place of a word: nothing is known, not even the voxel's side
#define DISTANCE_PARTS 8             // steps to a voxel
#define DISTANCE_POINT_BITS 7        // of a surface point's component
#define DISTANCE_POINT_MIDDLE 64
#define DISTANCE_POINT 0x1fffffu     // the surface point's bits
#define DISTANCE_ACROSS_BITS 3       // of a component of the way to the voxel across
#define DISTANCE_ACROSS_FIRST 21
#define DISTANCE_ACROSS 0x3fe00000u  // its bits
#define DISTANCE_INSIDE 0x80000000u
#define DISTANCE_LEFT 0.5f           // a surface point is believed to lie so far from the surface at most [unit]
#define DISTANCE_FARTHEST 4096.0f    // squared [1/8 unit]: eight units, beyond which no band reaches
#define DISTANCE_NOWHERE 1e38f       // squared: above all that there is

#endif
