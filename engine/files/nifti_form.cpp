// SPDX-License-Identifier: Apache-2.0
#include "engine/files/nifti_form.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr int kScanner = 1;          // code of a form in the scanner's frame
constexpr double kSheared = 1e-4;    // cosine between two axes; a smaller one is a file's rounding (checkLattice)
constexpr double kDisagrees = 0.01;  // [voxel]; less is the rounding of a quaternion

// A form as a matrix, in the file's frame and unit: the steps along i, j, k (columns) and the place of the first voxel.
struct Affine {
  Mat3 steps = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
};

Affine qformOf(const NiftiForms& forms) {
  const auto [b, c, d] = forms.quaternion;
  const double rest = 1 - (b * b + c * c + d * d);
  // Half a turn: what rounding leaves of the first component is nothing.
  const double a = rest < 1e-7 ? 0 : std::sqrt(rest);
  const Eigen::Quaterniond q = Eigen::Quaterniond(a, b, c, d).normalized();
  Affine affine;
  affine.steps = q.toRotationMatrix();
  affine.steps.col(2) *= std::isfinite(forms.qfac) ? (forms.qfac < 0 ? -1 : 1) : forms.qfac;
  for (int axis = 0; axis < 3; ++axis) {
    affine.steps.col(axis) *= forms.voxel_size[static_cast<std::size_t>(axis)];
    affine.origin[axis] = forms.offset[static_cast<std::size_t>(axis)];
  }
  return affine;
}

Affine sformOf(const NiftiForms& forms) {
  Affine affine;
  for (int row = 0; row < 3; ++row) {
    const auto& numbers = forms.sform[static_cast<std::size_t>(row)];
    for (int column = 0; column < 3; ++column) affine.steps(row, column) = numbers[static_cast<std::size_t>(column)];
    affine.origin[row] = numbers[3];
  }
  return affine;
}

// For a file without a form: steps along right, anterior, superior.
Affine sizesAlone(const NiftiForms& forms) {
  Affine affine;
  for (int axis = 0; axis < 3; ++axis) affine.steps(axis, axis) = forms.voxel_size[static_cast<std::size_t>(axis)];
  return affine;
}

void checkNumbers(const Affine& affine, const char* form, const std::string& source) {
  const bool finite = affine.steps.allFinite() && affine.origin.allFinite();
  if (!finite || affine.steps.cwiseAbs().maxCoeff() > 1e12 || affine.origin.cwiseAbs().maxCoeff() > 1e12) {
    refuse(source, fmt::format("its {} holds numbers that are no place of a voxel", form),
           "copy or write the file again");
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (affine.steps.col(axis).norm() > 0) continue;
    refuse(source, fmt::format("its {} gives voxels no length along axis {}", form, "ijk"[axis]),
           "write the true voxel size into the header");
  }
}

// The largest cosine between two axes.
double shearOf(const Affine& affine) {
  double shear = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 a = affine.steps.col(axis).normalized();
    const Vec3 b = affine.steps.col((axis + 1) % 3).normalized();
    shear = std::max(shear, std::abs(a.dot(b)));
  }
  return shear;
}

// The angle between the two axes that are farthest from perpendicular [degree].
double angleOf(double shear) {
  return std::acos(shear) * 180 / std::numbers::pi;
}

// RAS to LPS, the file's unit to metres.
Lattice latticeOf(const Affine& affine, double millimetres_per_unit) {
  const double metres = millimetres_per_unit * kMetresPerMillimetre;
  const Vec3 to_lps(-1, -1, 1);
  Lattice lattice;
  lattice.origin_W = to_lps.cwiseProduct(affine.origin) * metres;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = affine.steps.col(axis);
    lattice.spacing_m[axis] = step.norm() * metres;
    lattice.R_WL.col(axis) = to_lps.cwiseProduct(step.normalized());
  }
  return lattice;
}

// The largest distance between the places that two forms give to a corner of the volume, in the file's unit.
double apart(const Affine& a, const Affine& b, const Vec3& last) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 voxel = Vec3(corner & 1, corner >> 1 & 1, corner >> 2).cwiseProduct(last);
    most = std::max(most, ((a.steps - b.steps) * voxel + a.origin - b.origin).norm());
  }
  return most;
}

std::string sizesDisagree(const NiftiForms& forms, const Affine& sform) {
  for (int axis = 0; axis < 3; ++axis) {
    const double by_size = forms.voxel_size[static_cast<std::size_t>(axis)];
    const double by_form = sform.steps.col(axis).norm();
    if (std::abs(by_size - by_form) <= 1e-3 * by_form) continue;
    return fmt::format("its sform makes voxels {:g} mm long along {}, its pixdim {:g} mm; the sform is taken",
                       by_form * forms.millimetres_per_unit, "ijk"[axis], by_size * forms.millimetres_per_unit);
  }
  return "";
}

}  // namespace

NiftiPlacing placingOf(const NiftiForms& forms, const Vec3& last, const std::string& source) {
  std::optional<Affine> qform;
  std::optional<Affine> sform;
  if (forms.qform_code > 0) checkNumbers(qform.emplace(qformOf(forms)), "qform", source);
  if (forms.sform_code > 0) checkNumbers(sform.emplace(sformOf(forms)), "sform", source);
  NiftiPlacing placing;
  if (!qform && !sform) {
    placing.lattice = latticeOf(sizesAlone(forms), forms.millimetres_per_unit);
    placing.orientation = "no orientation in the file: taken as RAS, so left and right may be exchanged";
    return placing;
  }
  const double shear = sform ? shearOf(*sform) : 0;
  const bool sheared = shear > kSheared;
  if (sheared && !qform) {
    refuse(source,
           fmt::format("its sform is sheared: two of its axes meet at {:.4g} degrees, and voxels here are boxes",
                       angleOf(shear)),
           "resample it onto orthogonal axes");
  }
  const bool qform_alone_in_scanner = qform && forms.qform_code == kScanner && forms.sform_code != kScanner;
  const bool take_sform = sform && !sheared && !qform_alone_in_scanner;
  placing.lattice = latticeOf(take_sform ? *sform : *qform, forms.millimetres_per_unit);
  placing.orientation = fmt::format("RAS file turned to LPS, by its {}", take_sform ? "sform" : "qform");
  if (sheared) {
    placing.remark =
        fmt::format("its sform is sheared (two axes meet at {:.4g} degrees); its qform is taken", angleOf(shear));
  } else if (sform && qform) {
    const double by = apart(*qform, *sform, last);
    const Affine& taken = take_sform ? *sform : *qform;
    if (by > kDisagrees * taken.steps.colwise().norm().minCoeff()) {
      placing.remark = fmt::format("its qform and its sform place voxels up to {:.3g} mm apart; the {} is taken{}",
                                   by * forms.millimetres_per_unit, take_sform ? "sform" : "qform",
                                   qform_alone_in_scanner ? ", whose frame is the scanner's" : "");
    }
  } else if (sform) {
    placing.remark = sizesDisagree(forms, *sform);
  }
  return placing;
}

}  // namespace palpate
