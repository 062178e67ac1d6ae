// SPDX-License-Identifier: Apache-2.0
// NRRD, attached (.nrrd) and detached (.nhdr). Source of the format: https://teem.sourceforge.net/nrrd/format.html
//
// ITK reads the header only. The lattice is made here from "space directions", because ITK 5.2 turns LAS files to LPS,
// but not RAS files. Checked here first: spacings, because ITK takes the absolute value of a negative one; and units of
// length, which ITK ignores.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/files/components.hpp"
#include "engine/files/itk_image.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/text_header.hpp"
#include "engine/files/text_stored.hpp"

namespace palpate {
namespace {

std::size_t nrrdTypeBytes(const std::string& type) {
  if (type.find("64") != std::string::npos || type.find("long long") != std::string::npos) return 8;
  if (type == "double" || type == "longlong" || type == "ulonglong") return 8;
  if (type.find("16") != std::string::npos || type.find("short") != std::string::npos) return 2;
  if (type.find("char") != std::string::npos || type == "int8" || type == "uint8" || type == "int8_t" ||
      type == "uint8_t") {
    return 1;
  }
  return 4;
}

bool holds(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

// What an axis of this kind counts, if it is neither space nor time.
std::optional<Components> componentsOf(const std::string& kind) {
  if (holds(kind, "color")) return Components::kColours;
  if (holds(kind, "matrix")) return Components::kTensors;
  if (kind == "complex") return Components::kComplex;
  const bool is_vector = holds(kind, "vector") || holds(kind, "normal") || holds(kind, "gradient");
  if (is_vector || kind == "point" || kind == "quaternion" || kind == "list") return Components::kVectors;
  return {};
}

std::vector<std::string> kindsOf(const TextHeader& header) {
  std::istringstream words(lowerCase(header.text("kinds")));
  return {std::istream_iterator<std::string>(words), {}};
}

// "none (1,0,0) (0,1,0)": one entry for each axis, empty for an axis without a direction.
std::vector<std::vector<double>> directionsOf(const TextHeader& header) {
  const std::string text = header.text("space directions");
  std::vector<std::vector<double>> directions;
  for (std::size_t at = text.find_first_not_of(" \t"); at < text.size(); at = text.find_first_not_of(" \t", at)) {
    const bool is_vector = text[at] == '(';
    const std::size_t end = std::min(text.find_first_of(is_vector ? ")" : " \t(", at), text.size());
    TextHeader one;
    if (is_vector) one.fields[""] = text.substr(at, end - at);
    directions.push_back(one.numbers(""));
    at = std::min(end + (is_vector ? 1 : 0), text.size());
  }
  return directions;
}

// Which axes are not in space, as far as the header tells. Spacings that are all NaN tell nothing.
std::vector<bool> axesOutOfSpace(const TextHeader& header, std::size_t count) {
  std::vector<bool> are_out(count, false);
  const auto directions = directionsOf(header);
  for (std::size_t axis = 0; axis < std::min(count, directions.size()); ++axis)
    are_out[axis] = directions[axis].empty();
  if (!directions.empty()) return are_out;
  const std::vector<double> spacings = header.numbers("spacings");
  if (std::all_of(spacings.begin(), spacings.end(), [](double s) { return std::isnan(s); })) return are_out;
  for (std::size_t axis = 0; axis < std::min(count, spacings.size()); ++axis)
    are_out[axis] = std::isnan(spacings[axis]);
  return are_out;
}

// Refuses an axis that counts components, and a fourth axis. If the header gives no kinds, the first of four axes is
// taken for components if it is not in space, or if it counts three or four bytes.
void checkAxes(const TextHeader& header, const std::vector<double>& sizes, const std::string& source) {
  const std::vector<std::string> kinds = kindsOf(header);
  const std::vector<bool> are_out = axesOutOfSpace(header, sizes.size());
  std::optional<std::size_t> series;
  for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
    if (sizes[axis] == 1) continue;
    const std::string kind = axis < kinds.size() ? kinds[axis] : "";
    if (const auto components = componentsOf(kind)) refuseComponents(source, *components, sizes[axis]);
    if (kind == "time" || are_out[axis]) series = axis;
  }
  if (sizes.size() <= 3) return;
  const bool is_many = std::count_if(sizes.begin(), sizes.end(), [](double size) { return size > 1; }) > 3;
  const bool is_few = sizes[0] == 3 || sizes[0] == 4;
  const bool are_bytes = nrrdTypeBytes(lowerCase(header.text("type"))) == 1;
  if (kinds.empty() && sizes[0] > 1 && (are_out[0] || (is_many && is_few && are_bytes))) {
    refuseComponents(source, is_few ? Components::kColoursOrVectors : Components::kVectors, sizes[0]);
  }
  if (!is_many && !series) return;
  refuse(source, fmt::format("it is a series of {:.0f} volumes", sizes[series.value_or(sizes.size() - 1)]),
         "extract one time point");
}

// The vectors in a text such as "(1,2,3) none (4,5,6)".
std::vector<Vec3> vectorsOf(const TextHeader& header, const std::string& key) {
  const std::string text = header.text(key);
  std::vector<Vec3> vectors;
  for (std::size_t open = text.find('('); open != std::string::npos; open = text.find('(', open + 1)) {
    TextHeader one;
    one.fields[key] = text.substr(open, text.find(')', open) - open);
    const std::vector<double> numbers = one.numbers(key);
    if (numbers.size() == 3) vectors.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  return vectors;
}

// The sizes of the header; memory is checked here too, because ITK may allocate while it reads a header.
void checkNrrdSizes(const TextHeader& header, const std::string& source, std::size_t memory_budget_bytes) {
  const std::vector<double> sizes = header.numbers("sizes");
  double voxels = 1;
  for (const double size : sizes) {
    if (!(size >= 1 && size <= 1e15) || size != std::floor(size)) {
      refuse(source, fmt::format("its sizes \"{}\" are not counts", header.text("sizes")), "write the file again");
    }
    voxels *= size;
  }
  constexpr std::size_t kMostAxes = 16;  // the format's
  if (sizes.size() < 3 || sizes.size() > kMostAxes) {
    refuse(source, fmt::format("it has {} dimensions", sizes.size()), "give a volume");
  }
  checkAxes(header, sizes, source);
  checkMemory(source, voxels * (kDenseBytesPerVoxel + kGridBytesPerVoxel + kGpuBytesPerVoxel), memory_budget_bytes);
}

// Whether the file tells the size of its voxels. Spacings that are all NaN count as missing.
bool givesVoxelSize(const TextHeader& header) {
  const std::vector<double> spacings = header.numbers("spacings");
  return !header.text("space directions").empty() ||
         std::any_of(spacings.begin(), spacings.end(), [](double spacing) { return !std::isnan(spacing); });
}

// Checks spacings. They may be NaN for axes that are not in space or have one voxel; ITK would take 1 for NaN. All
// others must be above 0.
void checkSpacings(const TextHeader& header, const std::string& source) {
  const std::vector<double> spacings = header.numbers("spacings");
  const std::vector<double> sizes = header.numbers("sizes");
  for (std::size_t axis = 0; axis < spacings.size() && givesVoxelSize(header); ++axis) {
    const double spacing = spacings[axis];
    const bool may_be_none = axis < sizes.size() && sizes[axis] == 1;
    if ((std::isnan(spacing) && may_be_none) || (spacing > 0 && std::isfinite(spacing))) continue;
    refuse(source, fmt::format("its spacings \"{}\" are not positive", header.text("spacings")),
           "write the true voxel size into the header");
  }
  for (const Vec3& direction : vectorsOf(header, "space directions")) {
    const double length = direction.norm();
    if (!(length > 0) && !std::isnan(length)) {
      refuse(source, fmt::format("its space directions \"{}\" hold a zero vector", header.text("space directions")),
             "write the true voxel size into the header");
    }
  }
}

// Millimetres unless "space units" or "units" says otherwise of the first axis.
double metresPerUnit(const TextHeader& header, const std::string& source) {
  std::string units = header.text("space units");
  if (units.empty()) units = header.text("units");
  const std::size_t first = units.find('"');
  if (first == std::string::npos) return 1e-3;
  const std::string unit = units.substr(first + 1, units.find('"', first + 1) - first - 1);
  if (unit.empty() || unit == "mm" || unit == "millimeter" || unit == "millimeters" || unit == "???") return 1e-3;
  if (unit == "um" || unit == "micrometer" || unit == "microns" || unit == "micron") return 1e-6;
  if (unit == "cm" || unit == "centimeter") return 1e-2;
  if (unit == "m" || unit == "meter") return 1;
  refuse(source, fmt::format("its unit of length \"{}\" is not known", unit), "use mm, um, cm or m");
}

// The file's frame to LPS; the identity for frames that have no anatomy.
Vec3 signsToLps(const TextHeader& header) {
  const std::string space = lowerCase(header.text("space"));
  if (space == "right-anterior-superior" || space == "ras") return {-1, -1, 1};
  if (space == "left-anterior-superior" || space == "las") return {1, -1, 1};
  return {1, 1, 1};
}

// The lattice; empty if the header gives no directions, because ITK reads spacings alone correctly. Each of the three
// axes in space needs a direction; ITK would invent a missing one.
std::optional<Lattice> latticeOf(const TextHeader& header, double metres_per_unit, const std::string& source) {
  if (header.text("space directions").empty()) return {};
  const std::vector<Vec3> directions = vectorsOf(header, "space directions");
  const std::vector<Vec3> origin = vectorsOf(header, "space origin");
  if (directions.size() != 3) {
    refuse(source,
           fmt::format("its space directions \"{}\" are not three vectors of three numbers",
                       header.text("space directions")),
           "write the directions of its three axes into the header");
  }
  const Vec3 signs = signsToLps(header);
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = directions[static_cast<std::size_t>(axis)].cwiseProduct(signs) * metres_per_unit;
    lattice.spacing_m[axis] = step.norm();
    lattice.R_WL.col(axis) = step.normalized();
  }
  if (origin.size() == 1) lattice.origin_W = origin[0].cwiseProduct(signs) * metres_per_unit;
  return lattice;
}

std::string orientationOf(const TextHeader& header) {
  const std::string space = lowerCase(header.text("space"));
  if (space.empty()) return "no space in the file: axes taken as LPS";
  if (space == "left-posterior-superior" || space == "lps") return "LPS file";
  if (space == "right-anterior-superior" || space == "ras") return "RAS file turned to LPS";
  if (space == "left-anterior-superior" || space == "las") return "LAS file turned to LPS";
  return fmt::format("space \"{}\" taken as LPS", space);
}

}  // namespace

Volume readNrrd(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const TextHeader header = readTextHeader(name, name, TextFormat::kNrrd);
  checkNrrdSizes(header, name, wanted.memory_budget_bytes);
  checkSpacings(header, name);
  ItkRequest request;
  request.reader = ItkReader::kNrrd;
  request.path = name;
  request.metres_per_unit = metresPerUnit(header, name);
  request.lattice = latticeOf(header, request.metres_per_unit, name);
  request.memory_budget_bytes = wanted.memory_budget_bytes;
  request.stored = nrrdStored(header, name, nrrdTypeBytes(lowerCase(header.text("type"))), name);
  request.facts.source = name;
  request.facts.instead_of_nan = wanted.instead_of_nan;
  request.facts.format = "NRRD";
  request.facts.orientation = orientationOf(header);
  if (!givesVoxelSize(header)) {
    request.facts.remark = "the file gives no voxel size; 1 mm is assumed";
  }
  return readItkImage(std::move(request));
}

}  // namespace palpate
