// SPDX-License-Identifier: Apache-2.0
// engine/files/nifti_form.hpp: where a NIfTI file places its voxels. Private to engine/files. Any thread.
//
// A file says so in up to two ways (nifti1.h, "methods 2 and 3"): the qform, a quaternion with voxel sizes beside it,
// and the sform, a matrix. Each has a code that says in which frame; 1 is the scanner's, the patient's own. Frame: RAS,
// in the file's unit of length; here it is turned to LPS metres.
//
// Taken is the sform, or the qform where that alone is in the scanner's frame, or where the sform is sheared and the
// qform is not. Where the file has neither, its axes are taken as RAS, the first voxel as the origin.
#pragma once

#include <array>
#include <string>

#include "base/lattice.hpp"

namespace palpate {

struct NiftiForms {
  int qform_code = 0, sform_code = 0;  // above 0: it is there
  std::array<double, 3> voxel_size = {1, 1, 1};
  double qfac = 1;                        // -1: the third axis is turned around
  std::array<double, 3> quaternion = {};  // b, c, d
  std::array<double, 3> offset = {};      // of the first voxel
  std::array<std::array<double, 4>, 3> sform = {};
  double millimetres_per_unit = 1;
};

struct NiftiPlacing {
  Lattice lattice;          // as the file rounds it: orthonormalised() makes it exact
  std::string orientation;  // words: which form was taken
  std::string remark;       // where the forms or the voxel sizes disagree; empty: they do not
};

// `last`: the last voxel, between which and the first the forms are compared. Throws Error(kBadInput): numbers that are
// not finite, an axis of no length, a sheared sform and no qform.
[[nodiscard]] NiftiPlacing placingOf(const NiftiForms& forms, const Vec3& last, const std::string& source);

}  // namespace palpate
