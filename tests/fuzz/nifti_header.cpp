// SPDX-License-Identifier: Apache-2.0
// The header of a NIfTI file, and where it places the voxels. The header in the other byte order must say the same, and
// voxels must lie where the formulas of nifti1.h put them.
#include "engine/files/nifti_header.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

constexpr const char* kSource = "some.nii";

// Swaps the bytes of every number of the header. The table: offset, count, size [byte].
std::string turned(std::string bytes) {
  struct Row {
    std::size_t at, count, size;
  };
  constexpr std::array<Row, 8> kRows = {
      {{0, 1, 4}, {40, 8, 2}, {56, 3, 4}, {68, 4, 2}, {76, 11, 4}, {120, 1, 2}, {252, 2, 2}, {256, 18, 4}}};
  for (const Row& row : kRows) {
    for (std::size_t n = 0; n < row.count; ++n) {
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(row.at + n * row.size);
      std::reverse(begin, begin + static_cast<std::ptrdiff_t>(row.size));
    }
  }
  return bytes;
}

// Columns: a step along i, j and k, and the first voxel, in the file's frame and unit.
using Affine = Eigen::Matrix<double, 3, 4>;

Affine affineOfSform(const NiftiForms& forms) {
  Affine affine;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column)
      affine(static_cast<int>(row), static_cast<int>(column)) = forms.sform[row][column];
  }
  return affine;
}

// nifti1.h, "method 2": the rotation of a quaternion a, b, c, d of length 1, voxel sizes, and the sign of qfac. The
// file leaves a out.
Affine affineOfQform(const NiftiForms& forms) {
  auto [b, c, d] = forms.quaternion;
  const double rest = 1 - (b * b + c * c + d * d);
  double a = rest < 1e-7 ? 0 : std::sqrt(rest);
  const double length = std::hypot(std::hypot(a, b), std::hypot(c, d));
  a /= length, b /= length, c /= length, d /= length;
  Affine affine;
  affine << a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c), forms.offset[0],
      2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b), forms.offset[1], 2 * (b * d - a * c),
      2 * (c * d + a * b), a * a + d * d - b * b - c * c, forms.offset[2];
  for (int axis = 0; axis < 3; ++axis) affine.col(axis) *= forms.voxel_size[static_cast<std::size_t>(axis)];
  if (forms.qfac < 0) affine.col(2) *= -1;
  return affine;
}

// Whether the lattice puts corners of the volume where the affine does.
bool places(const Affine& affine, const Lattice& lattice, const Vec3& last, double metres_per_unit) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 voxel = Vec3(corner & 1, corner >> 1 & 1, corner >> 2).cwiseProduct(last);
    const Vec3 wanted = Vec3(-1, -1, 1).cwiseProduct(affine * voxel.homogeneous()) * metres_per_unit;
    // Some ten roundings of numbers as large as the largest term of a sum.
    const Affine terms = affine.cwiseAbs();
    const double largest = (terms * voxel.homogeneous()).maxCoeff() * metres_per_unit;
    if (!((lattice.toWorld(voxel) - wanted).norm() <= 1e-14 * largest)) return false;
  }
  return true;
}

void checkPlacing(const NiftiHeader& header, const Vec3& last) {
  NiftiPlacing placing;
  if (!fuzz::accepts(kSource, [&] { placing = placingOf(header.forms, last, kSource); })) return;
  const Lattice& lattice = placing.lattice;
  fuzz::require(lattice.spacing_m.allFinite() && lattice.spacing_m.minCoeff() > 0, "a spacing is not positive");
  fuzz::require(lattice.origin_W.allFinite() && lattice.R_WL.allFinite(), "the lattice is not finite");
  fuzz::require(!placing.orientation.empty(), "nothing is said of the orientation");
  const NiftiForms& forms = header.forms;
  const double unit = forms.millimetres_per_unit * 1e-3;
  Affine sizes = Affine::Zero();
  for (int axis = 0; axis < 3; ++axis) sizes(axis, axis) = forms.voxel_size[static_cast<std::size_t>(axis)];
  const bool has_form = forms.qform_code > 0 || forms.sform_code > 0;
  fuzz::require((forms.sform_code > 0 && places(affineOfSform(forms), lattice, last, unit)) ||
                    (forms.qform_code > 0 && places(affineOfQform(forms), lattice, last, unit)) ||
                    (!has_form && places(sizes, lattice, last, unit)),
                "voxels do not lie where the file says");
}

void check(const std::string& bytes) {
  NiftiHeader header;
  if (!fuzz::accepts(kSource, [&] { header = readNiftiHeader(bytes, kSource); })) return;
  fuzz::require(std::isfinite(header.slope) && std::isfinite(header.intercept) && header.slope != 0, "no slope");
  fuzz::require(header.data_offset >= (header.one_file ? kNiftiHeaderBytes : 0), "values begin within the header");
  for (const double size : header.forms.voxel_size) fuzz::require(std::isfinite(size) && size > 0, "no voxel size");
  NiftiHeader other;
  fuzz::mustAccept("in the other byte order it is refused", [&] { other = readNiftiHeader(turned(bytes), kSource); });
  fuzz::require(
      other.swapped != header.swapped && other.one_file == header.one_file && other.size == header.size &&
          other.type == header.type && other.data_offset == header.data_offset && other.slope == header.slope &&
          other.intercept == header.intercept && other.forms.qform_code == header.forms.qform_code &&
          other.forms.sform_code == header.forms.sform_code && other.forms.voxel_size == header.forms.voxel_size,
      "in the other byte order it reads otherwise");
  const auto [nx, ny, nz] = header.size;
  if (nx > 0 && ny > 0 && nz > 0) checkPlacing(header, Vec3(nx - 1, ny - 1, nz - 1));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
