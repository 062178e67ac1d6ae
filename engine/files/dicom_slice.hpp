// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_slice.hpp: one file of a DICOM series. Private to engine/files.
//
// Frame: LPS, millimetres, as in the file. Set-up thread. Position, axes and spacing are parsed here and not taken from
// GDCM, which assumes 1 mm and the patient's axes where it cannot parse them.
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
  ItkFacts file;  // its header
  // Known after checkDicomSlice:
  Vec3 position_mm = Vec3::Zero();                            // of its first pixel
  std::array<Vec3, 2> axes = {Vec3::UnitX(), Vec3::UnitY()};  // unit directions in which columns and rows are counted
  std::array<double, 2> spacing_mm = {1, 1};                  // between columns, between rows
  double along_mm = 0;  // its position along the slices' normal; set by placeSlices

  [[nodiscard]] std::string name() const { return path.filename().string(); }
  // The value of a tag such as "0020|000e"; "" if it is missing.
  [[nodiscard]] std::string tag(const std::string& key) const {
    const auto found = file.tags.find(key);
    return found == file.tags.end() ? std::string() : found->second;
  }
};
using DicomSeries = std::vector<DicomSlice>;

// False for a DICOM file that holds no image (dicom_structure.hpp). Throws Error(kBadInput) for a slice that is not
// complete. GDCM may only be given files for which this is true.
[[nodiscard]] bool isDicomSlice(const std::filesystem::path& path, const std::string& source);

// Sets position, axes and spacing. Throws Error(kBadInput) for a slice that is in colour or has several frames, and for
// a position, orientation, pixel spacing, slope or intercept that is not made of finite decimal numbers. Slope and
// intercept may be missing.
void checkDicomSlice(DicomSlice& slice, const std::string& source);

// A callback for itk_child.hpp that throws an Error with the name of the file that ITK cannot read. Both arguments must
// outlive the result.
[[nodiscard]] RefuseFile refuseSlice(const std::vector<std::filesystem::path>& files, const std::string& source);

// The numbers in a value such as "1\2\3". A part that is not a finite decimal number, such as "inf", "0x10" or "2 mm",
// becomes NaN.
[[nodiscard]] std::vector<double> dicomNumbers(const std::string& text);

}  // namespace palpate
