// SPDX-License-Identifier: Apache-2.0
// shaders/edit.layout.h: edit commands as the edit kernels and their CPU twin read them, and the bindings of these
// kernels.
//
// docs/edits.md says what each kind does. Positions are in metres along the lattice's axes, relative to the centre of
// the command's origin voxel. So floats are precise wherever the brush is.
#ifndef PALPATE_EDIT_LAYOUT_H
#define PALPATE_EDIT_LAYOUT_H
#include "brick_pool.layout.h"

// The numbers of EditKind (engine/edit/edit_command.hpp).
#define EDIT_ADD 0u
#define EDIT_REMOVE 1u
#define EDIT_PAINT 2u
#define EDIT_FLATTEN 3u
#define EDIT_CUT 4u
#define EDIT_STAMP_ADD 5u
#define EDIT_STAMP_REMOVE 6u
#define EDIT_SMOOTH 7u
#define EDIT_INFLATE 8u
#define EDIT_DEFLATE 9u
#define EDIT_KINDS 10u

// Kinds that edit_stencil.comp runs; edit.comp runs the others.
#define EDIT_READS_NEIGHBOURS(kind) ((kind) == EDIT_SMOOTH || (kind) == EDIT_INFLATE || (kind) == EDIT_DEFLATE)

// edit.comp changes bricks in place. For a voxel it reads that voxel alone.
#define EDIT_BINDING_PAGES 0
#define EDIT_BINDING_SLAB 1  // one density slab, read and written
#define EDIT_BINDING_TASKS 2
#define EDIT_BINDING_COMMANDS 3
#define EDIT_BINDING_STAMPS 4
#define EDIT_BINDINGS 5

// edit_stencil.comp reads the pool and writes changed bricks to a buffer aside. Then brick_commit.comp copies them
// back.
#define STENCIL_BINDING_TASKS BINDING_OWN
#define STENCIL_BINDING_COMMANDS (BINDING_OWN + 1)
#define STENCIL_BINDING_ASIDE (BINDING_OWN + 2)
#define STENCIL_BINDINGS (BINDING_OWN + 3)

#define COMMIT_BINDING_PAGES 0
#define COMMIT_BINDING_SLAB 1  // one density slab, written
#define COMMIT_BINDING_TASKS 2
#define COMMIT_BINDING_ASIDE 3
#define COMMIT_BINDINGS 4

PALPATE_LAYOUT_BEGIN

struct EditCommand {
  uint kind;                           // EDIT_...
  int origin_x, origin_y, origin_z;    // [voxel]
  float a_x, a_y, a_z;                 // where the stroke starts [m]
  float ab_x, ab_y, ab_z;              // from there to its end [m]
  float inv_ab2;                       // 1 / |ab|^2; 0: the stroke is a point [1/m^2]
  float radius;                        // [m]
  float reach;                         // a voxel farther from the stroke keeps its density [m]
  float strength;                      // share of the way to the target, in (0, 1] [-]
  float inv_fade;                      // 1 / width over which strength falls to 0 at the radius; 0: no fade [1/m]
  float value;                         // paint: target [density]; inflate, deflate: step [m]
  float n_x, n_y, n_z, n_d;            // plane: n . p - n_d is the height above it [-, m]
  float isovalue, background, object;  // [density]
  float slope;                         // of the density ramp across a new surface [density/m]
  float material_low, material_inv_range, material_drop;  // remove: strength * (1 - drop * share of the range)
  uint stamp_first;                                       // index of the stamp's first distance in the stamp buffer
  uint stamp_x, stamp_y, stamp_z;                         // size of the stamp's lattice [voxel of the stamp]
  float m_xx, m_xy, m_xz, m_xt;                           // position [m] to the stamp's lattice [voxel of the stamp]
  float m_yx, m_yy, m_yz, m_yt;
  float m_zx, m_zy, m_zz, m_zt;
};

// A brick to edit. Without a slot only its page is written: from then on the brick is `constant`.
struct EditTask {
  uint brick;         // linear page index
  uint slot;          // in the pool, or NO_SLOT
  uint was_constant;  // 1: until now the brick held `constant` everywhere and had no slot
  float constant;     // [density]
};

// Factors that depend on the spacing alone, rounded to float once.
struct EditScale {
  float h_x, h_y, h_z;              // spacing [m]
  float blur_x, blur_y, blur_z;     // smooth: share of each neighbour along the axes [-]
  float inv_h_x, inv_h_y, inv_h_z;  // 1 / spacing [1/m]
};

struct EditPush {
  PoolDomain domain;
  uint first_task, task_count;
  uint first_command, command_count;
  EditScale scale;
};

struct CommitPush {
  uint first_task, task_count;
  uint first_aside;  // the first task's brick among those written aside
};

PALPATE_LAYOUT_CHECK(EditCommand, 172)
PALPATE_LAYOUT_CHECK(EditTask, 16)
PALPATE_LAYOUT_CHECK(EditScale, 36)
PALPATE_LAYOUT_CHECK(EditPush, 76)
PALPATE_PUSH_CHECK(EditPush)

PALPATE_LAYOUT_END
#endif
