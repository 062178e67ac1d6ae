// SPDX-License-Identifier: Apache-2.0
// Writes NRRD (http://teem.sourceforge.net/nrrd/format.html) and MetaImage (https://itk.org/Wiki/ITK/MetaIO): a header
// in text, then the values. Both are in LPS millimetres. 17 digits restore a double exactly.
#include <fmt/format.h>

#include "base/units.hpp"
#include "engine/files/writers.hpp"

namespace palpate {
namespace {

Vec3 step_mm(const Lattice& lattice, int axis) {
  return lattice.R_WL.col(axis) * (lattice.spacing_m[axis] * kMillimetresPerMetre);
}

std::string numbers(const Vec3& v, const char* between) {
  return fmt::format("{:.17g}{}{:.17g}{}{:.17g}", v.x(), between, v.y(), between, v.z());
}

}  // namespace

void writeNrrd(const Volume& volume, const ByteSink& sink) {
  const ValueType type = typeToWrite(volume);
  const Lattice& lattice = volume.lattice();
  const Vec3i& size = volume.size();
  std::string header = "NRRD0004\n# written by Palpate\n";
  header += fmt::format("type: {}\n", type == ValueType::kInt16 ? "short" : "float");
  header +=
      fmt::format("dimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n", size.x(), size.y(), size.z());
  header += fmt::format("space directions: ({}) ({}) ({})\n", numbers(step_mm(lattice, 0), ","),
                        numbers(step_mm(lattice, 1), ","), numbers(step_mm(lattice, 2), ","));
  header += "kinds: domain domain domain\nendian: little\nencoding: raw\nspace units: \"mm\" \"mm\" \"mm\"\n";
  header += fmt::format("space origin: ({})\n\n", numbers(lattice.origin_W * kMillimetresPerMetre, ","));
  sink(header);
  writeValues(volume, type, sink);
}

void writeMeta(const Volume& volume, const ByteSink& sink) {
  const ValueType type = typeToWrite(volume);
  const Lattice& lattice = volume.lattice();
  const Vec3i& size = volume.size();
  std::string header = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  header += "CompressedData = False\n";
  // A row of the file's matrix is an axis.
  header += fmt::format("TransformMatrix = {} {} {}\n", numbers(lattice.R_WL.col(0), " "),
                        numbers(lattice.R_WL.col(1), " "), numbers(lattice.R_WL.col(2), " "));
  header += fmt::format("Offset = {}\n", numbers(lattice.origin_W * kMillimetresPerMetre, " "));
  header += fmt::format("ElementSpacing = {}\n", numbers(lattice.spacing_m * kMillimetresPerMetre, " "));
  header += fmt::format("DimSize = {} {} {}\n", size.x(), size.y(), size.z());
  header += fmt::format("ElementType = {}\n", type == ValueType::kInt16 ? "MET_SHORT" : "MET_FLOAT");
  sink(header + "ElementDataFile = LOCAL\n");
  writeValues(volume, type, sink);
}

}  // namespace palpate
