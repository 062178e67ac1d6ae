// SPDX-License-Identifier: Apache-2.0
// engine/volume/dicom_slice.hpp: one file of a DICOM series. Private to engine/volume.
//
// Frame: LPS, millimetres, as in the file. Set-up thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/vec.hpp"
#include "engine/volume/itk_child.hpp"

namespace palpate {

struct DicomSlice {
  std::filesystem::path path;
  ItkFacts file;                    // what it says of itself
  Vec3 position_mm = Vec3::Zero();  // of its first pixel; known after checkDicomSlice
  double along_mm = 0;              // its position along the slices' normal

  [[nodiscard]] std::string name() const { return path.filename().string(); }
  [[nodiscard]] Vec3 axis(std::size_t n) const {  // unit direction of columns (0) or rows (1) as their index grows
    const auto& direction = file.header.direction[n];
    return {direction[0], direction[1], direction[2]};
  }
  // A value by "0020|000e"; "" where it is missing.
  [[nodiscard]] std::string tag(const std::string& key) const {
    const auto found = file.tags.find(key);
    return found == file.tags.end() ? std::string() : found->second;
  }
};

// Throws Error(kBadInput) for a file whose elements are not all there. Only what passes may be given to GDCM.
void checkDicomFile(const std::filesystem::path& path, const std::string& source);

// Sets position_mm. Throws Error(kBadInput) for a slice that is in colour, has several frames, or does not say how
// large its pixels are and where it lies.
void checkDicomSlice(DicomSlice& slice, const std::string& source);

// The numbers of a value such as "a\b\c".
[[nodiscard]] std::vector<double> dicomNumbers(const std::string& text);

}  // namespace palpate
