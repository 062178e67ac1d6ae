// SPDX-License-Identifier: Apache-2.0
// NIfTI-1: .nii, .nii.gz and .hdr/.img pairs. The header is read in nifti_header.hpp.
//
// ITK reads none of it. nifti_form.hpp finds where the voxels lie. The values are read here, and scl_slope and
// scl_inter are applied. Analyze 7.5 files are refused: they do not tell left from right.
#include <filesystem>

#include "engine/field/memory_budget.hpp"
#include "engine/files/itk_image.hpp"
#include "engine/files/magic.hpp"
#include "engine/files/nifti_form.hpp"
#include "engine/files/nifti_header.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

// "scan.hdr" and "scan.img" are one volume; the header is in the former.
std::string headerPath(const std::string& name) {
  const std::string lower = lowerCase(name);
  if (lower.ends_with(".img")) return name.substr(0, name.size() - 4) + ".hdr";
  if (lower.ends_with(".img.gz")) return name.substr(0, name.size() - 7) + ".hdr.gz";
  return name;
}

// The file that holds the voxels. Those of "scan.hdr" are in "scan.img"; either file may be gzipped.
std::string dataPath(const NiftiHeader& header, const std::string& header_path) {
  if (header.one_file) return header_path;
  const std::string stem = header_path.substr(0, lowerCase(header_path).rfind(".hdr"));
  for (const std::string suffix : {".img", ".img.gz", ".IMG"}) {
    if (std::filesystem::exists(stem + suffix)) return stem + suffix;
  }
  return stem + ".img";
}

// Where the values lie. In a gzipped file the offset counts unpacked bytes.
StoredValues storedValuesOf(const NiftiHeader& header, const std::string& header_path) {
  const std::string path = dataPath(header, header_path);
  StoredValues values;
  values.parts = {{path, 0}};
  values.skip_bytes = header.data_offset;
  if (isGzip(path) || lowerCase(path).ends_with(".gz")) values.packing = Packing::kGzip;
  values.swapped = header.swapped;
  return values;
}

}  // namespace

Volume readNifti(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const std::string path = headerPath(name);
  if (path != name) refuseEmpty(path, name, "its header " + std::filesystem::path(path).filename().string());
  const NiftiHeader header = readNiftiHeader(headOf(path, kNiftiHeaderBytes, name), name);
  const auto [nx, ny, nz] = header.size;
  checkMemory(name, nx, ny, nz, static_cast<double>(byteSize(header.type)), wanted.memory_budget_bytes);
  ItkRequest request;
  request.reader = ItkReader::kNifti;
  request.path = path;
  request.memory_budget_bytes = wanted.memory_budget_bytes;
  request.stored_type = header.type;
  request.stored = storedValuesOf(header, path);
  const NiftiPlacing placing = placingOf(header.forms, Vec3(nx - 1, ny - 1, nz - 1), name);
  request.lattice = placing.lattice;
  request.facts.source = name;
  request.facts.format = "NIfTI";
  request.facts.value_type = nameOf(header.type);
  request.facts.orientation = placing.orientation;
  request.facts.remark = placing.remark;
  request.facts.instead_of_nan = wanted.instead_of_nan.value_or(0.0F);
  request.header = ItkHeader{};
  request.header->type = request.stored_type;
  request.header->dimensions.assign(header.size.begin(), header.size.end());
  request.slope = request.facts.rescale_slope = header.slope;
  request.intercept = request.facts.rescale_intercept = header.intercept;
  return readItkImage(std::move(request));
}

}  // namespace palpate
