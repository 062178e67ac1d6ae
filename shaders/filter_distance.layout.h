// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance.layout.h: what the kernels of a distance share: the numbers that they are given, and the word
// in which a voxel keeps the surface point that it knows. C++ and GLSL.
//
// A surface point is kept as its offset from the voxel, each component rounded to 1/32 voxel, from -8 to 8 voxels: what
// rounding moves it off the surface, the finish takes back. The word lies in a float's place: its bits are those of an
// ordinary number (exponent 64 ... 79), neither a denormal nor NaN, so nothing that copies floats can change it.
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

#define DISTANCE_NONE 0u            // no surface point is known
#define DISTANCE_KNOWN 0x20000000u  // one is
#define DISTANCE_PARTS 32           // steps to a voxel
#define DISTANCE_MIDDLE 256         // added to a component, which then has nine bits
#define DISTANCE_FIELD 9
#define DISTANCE_MASK 511u
#define DISTANCE_LEFT 0.5f         // a surface point is believed to lie so far from the surface at most [unit]
#define DISTANCE_FARTHEST 65536.0f  // squared [1/32 unit]: eight units, beyond which no band reaches
#define DISTANCE_NOWHERE 1e38f      // squared: above all that there is

#endif
