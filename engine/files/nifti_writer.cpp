// SPDX-License-Identifier: Apache-2.0
// Writes NIfTI-1 in one file. Source of the format: nifti1.h, https://nifti.nimh.nih.gov/nifti-1
//
// World axes turn from LPS to RAS. Both of the format's ways to say where voxels lie are there and agree: the
// quaternion with pixdim, whose qfac carries a left-handed lattice, and the affine matrix. All of them are 32-bit
// floats.
#include <cstring>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/files/writers.hpp"

namespace palpate {
namespace {

constexpr std::size_t kHeaderBytes = 352;  // 348, and "no extensions"

// Offsets are the format's.
class Header {
 public:
  template <class T>
  void put(std::size_t offset, double value) {
    const T typed = static_cast<T>(value);
    std::memcpy(bytes_.data() + offset, &typed, sizeof typed);
  }
  void putText(std::size_t offset, std::string_view text) { bytes_.replace(offset, text.size(), text); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = std::string(kHeaderBytes, '\0');
};

void putSize(Header& header, const Vec3i& size) {
  header.put<std::int16_t>(40, 3);  // dim: their count, then the sizes, the unused ones 1
  for (std::size_t n = 0; n < 7; ++n) {
    header.put<std::int16_t>(42 + 2 * n, n < 3 ? size[static_cast<int>(n)] : 1);
  }
}

void putLattice(Header& header, const Lattice& lattice) {
  const Mat3 to_ras = Vec3(-1, -1, 1).asDiagonal();
  const Mat3 axes = to_ras * lattice.R_WL;
  const Vec3 origin_mm = to_ras * lattice.origin_W * kMillimetresPerMetre;
  const Vec3 spacing_mm = lattice.spacing_m * kMillimetresPerMetre;
  const double handed = axes.determinant() < 0 ? -1 : 1;
  Mat3 rotation = axes;
  rotation.col(2) *= handed;
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;  // the format leaves w out: it is not negative

  header.put<float>(76, handed);  // qfac
  header.put<std::int16_t>(252, 1);
  header.put<std::int16_t>(254, 1);
  for (int n = 0; n < 3; ++n) {
    const auto at = static_cast<std::size_t>(n);
    header.put<float>(80 + 4 * at, spacing_mm[n]);
    header.put<float>(256 + 4 * at, q.vec()[n]);
    header.put<float>(268 + 4 * at, origin_mm[n]);
    for (int axis = 0; axis < 3; ++axis) {
      header.put<float>(280 + 16 * at + 4 * static_cast<std::size_t>(axis), axes(n, axis) * spacing_mm[axis]);
    }
    header.put<float>(292 + 16 * at, origin_mm[n]);
  }
}

}  // namespace

void writeNifti(const Volume& volume, const std::string& name, const ByteSink& sink) {
  if (volume.size().maxCoeff() > std::numeric_limits<std::int16_t>::max()) {
    throw Error(Error::Code::kBadInput, name,
                fmt::format("NIfTI-1 counts 32767 voxels along an axis, and there are {}", volume.size().maxCoeff()),
                "write .nrrd or .vdb");
  }
  const ValueType type = typeToWrite(volume);
  Header header;
  header.put<std::int32_t>(0, 348);
  putSize(header, volume.size());
  header.put<std::int16_t>(70, type == ValueType::kInt16 ? 4 : 16);   // datatype
  header.put<std::int16_t>(72, type == ValueType::kInt16 ? 16 : 32);  // bits a voxel
  header.put<float>(108, kHeaderBytes);                               // where the values begin
  header.put<float>(112, 1);                                          // slope; the intercept is 0
  header.put<std::int8_t>(123, 2);                                    // millimetres
  header.putText(148, "written by Palpate");
  putLattice(header, volume.lattice());
  header.putText(344, "n+1");
  sink(header.bytes());
  writeValues(volume, type, sink);
}

}  // namespace palpate
