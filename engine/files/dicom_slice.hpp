// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_slice.hpp: one slice of a DICOM series: a file, or a frame of a file that holds several. Private
// to engine/files.
//
// Frame: LPS, millimetres, as in the file. Set-up thread.
// Source: DICOM PS3.3, C.7.6.2 (image plane), C.7.6.16 (the functional groups in which a file of several frames says
// what its frames share and what each has for itself).
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/vec.hpp"
#include "engine/files/dicom_data_set.hpp"

namespace palpate {

struct DicomSlice {
  std::filesystem::path path;
  std::shared_ptr<const DicomDataSet> file;  // shared by its frames
  std::size_t frame = 0, frames = 1;         // which of how many
  std::string part;  // which volume of its series, in words: " stack A phase 2" (dicom_parts.hpp)
  // Known after placeSlice:
  Vec3 position_mm = Vec3::Zero();                            // of its first pixel
  std::array<Vec3, 2> axes = {Vec3::UnitX(), Vec3::UnitY()};  // unit directions in which columns and rows are counted
  std::array<double, 2> spacing_mm = {1, 1};                  // between columns, between rows
  // Set by placeSlices:
  double along_mm = 0;                      // its position along the slices' normal
  std::array<double, 2> aside_px = {0, 0};  // how far it lies aside from the first slice, along columns and rows

  [[nodiscard]] std::size_t columns() const;
  [[nodiscard]] std::size_t rows() const;
  [[nodiscard]] std::string name() const;       // for messages: "slice s1.dcm", "frame 3 of scan.dcm"
  [[nodiscard]] std::string shortName() const;  // "s1.dcm", "frame 3 of scan.dcm"
  // The text of an element: what the frame has for itself, else what its frames share, else what the file has.
  [[nodiscard]] std::string text(DicomTag tag) const;
  // TemporalPositionIndex of the frame; 0 if it has none.
  [[nodiscard]] std::uint32_t phase() const;
  // DimensionIndexValues of the frame, one for each of the file's dimensions.
  [[nodiscard]] const std::vector<std::uint32_t>& dimensionIndices() const;
};
using DicomSeries = std::vector<DicomSlice>;

// The slices of a file, in the order of its frames; none for a DICOM file that holds no image: by its class
// (dicom_structure.hpp), or since it has neither pixels nor a size nor a place. Throws Error(kBadInput) for a file that
// is not complete, lacks pixels, or has no rows, no columns or more frames than 64 volumes of the largest height. A
// file of several frames that does not describe each is one slice, which placeSlice refuses. Cost: reads the file.
[[nodiscard]] DicomSeries slicesOfFile(const std::filesystem::path& path, const std::string& source);

// Sets position, axes and spacing. Throws Error(kBadInput) for those that are not made of finite decimal numbers, and
// for a file of several frames that does not say where each lies.
void placeSlice(DicomSlice& slice, const std::string& source);

// All bytes of a slice's file. Throws Error(kIo).
[[nodiscard]] std::string bytesOfSlice(const std::filesystem::path& path, const std::string& source);

// The numbers in a value such as "1\2\3". A part that is not a finite decimal number, such as "inf", "0x10" or "2 mm",
// becomes NaN.
[[nodiscard]] std::vector<double> dicomNumbers(const std::string& text);

}  // namespace palpate
