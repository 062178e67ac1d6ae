// SPDX-License-Identifier: Apache-2.0
// engine/files/nifti_form.hpp: where a NIfTI file places its voxels. Private to engine/files. Any thread.
//
// A file has up to two forms for this (nifti1.h, "methods 2 and 3"): the qform, a quaternion with voxel sizes beside
// it, and the sform, a matrix. Each has a code that names its frame; 1 is the scanner's frame, the patient's own. Forms
// are RAS, in the file's unit of length. The result is in LPS metres.
//
// The sform is used, with two exceptions: the qform is used if it alone is in the scanner's frame, or if the sform is
// sheared and the qform is not. A file without either is taken as RAS with the first voxel at the origin.
#pragma once

#include <array>
#include <string>

#include "base/lattice.hpp"

namespace palpate {

struct NiftiForms {
  int qform_code = 0, sform_code = 0;  // above 0: the form exists
  std::array<double, 3> voxel_size = {1, 1, 1};
  double qfac = 1;                        // -1: the third axis is turned around
  std::array<double, 3> quaternion = {};  // b, c, d
  std::array<double, 3> offset = {};      // of the first voxel
  std::array<std::array<double, 4>, 3> sform = {};
  double millimetres_per_unit = 1;
};

struct NiftiPlacing {
  Lattice lattice;          // rounded as in the file; orthonormalised() makes it exact
  std::string orientation;  // in words: which form was used
  std::string remark;       // in words: how the forms or the voxel sizes disagree; empty: they agree
};

// `last`: the index of the last voxel; the two forms are compared over the whole volume. Throws Error(kBadInput) for
// numbers that are not finite, an axis of length 0, and a sheared sform without a qform.
[[nodiscard]] NiftiPlacing placingOf(const NiftiForms& forms, const Vec3& last, const std::string& source);

}  // namespace palpate
