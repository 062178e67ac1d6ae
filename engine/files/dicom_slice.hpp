// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_slice.hpp: one file of a DICOM series. Private to engine/files.
//
// Frame: LPS, millimetres, as in the file. Set-up thread. Where a slice lies is read from its values here and not taken
// from GDCM, which puts 1 mm and the axes of the patient where it understands none.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/vec.hpp"
#include "engine/files/itk_child.hpp"

namespace palpate {

struct DicomSlice {
  std::filesystem::path path;
  ItkFacts file;  // what it says of itself
  // Known after checkDicomSlice:
  Vec3 position_mm = Vec3::Zero();                            // of its first pixel
  std::array<Vec3, 2> axes = {Vec3::UnitX(), Vec3::UnitY()};  // unit directions in which columns and rows are counted
  std::array<double, 2> spacing_mm = {1, 1};                  // between columns, between rows
  double along_mm = 0;  // its position along the slices' normal; set by placeSlices

  [[nodiscard]] std::string name() const { return path.filename().string(); }
  // A value by "0020|000e"; "" where it is missing.
  [[nodiscard]] std::string tag(const std::string& key) const {
    const auto found = file.tags.find(key);
    return found == file.tags.end() ? std::string() : found->second;
  }
};
using DicomSeries = std::vector<DicomSlice>;

// False for a DICOM file that holds no image (dicom_structure.hpp). Throws Error(kBadInput) for a slice whose elements
// are not all there. Only a slice may be given to GDCM.
[[nodiscard]] bool isDicomSlice(const std::filesystem::path& path, const std::string& source);

// Sets position, axes and spacing. Throws Error(kBadInput) for a slice that is in colour, has several frames, or does
// not say how large its pixels are and where it lies, in finite decimal numbers; and for a slope and an intercept that
// are none.
void checkDicomSlice(DicomSlice& slice, const std::string& source);

// For itk_child.hpp: names the file that ITK cannot read. Both outlive the result.
[[nodiscard]] RefuseFile refuseSlice(const std::vector<std::filesystem::path>& files, const std::string& source);

// The numbers of a value such as "a\b\c". A word that is no finite decimal number becomes NaN: "inf", "0x10", "2 mm".
[[nodiscard]] std::vector<double> dicomNumbers(const std::string& text);

}  // namespace palpate
