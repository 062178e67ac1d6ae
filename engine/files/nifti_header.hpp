// SPDX-License-Identifier: Apache-2.0
// engine/files/nifti_header.hpp: parses the header of a NIfTI-1 file. Private to engine/files. Any thread.
// Source of the format: nifti1.h, https://nifti.nimh.nih.gov/nifti-1
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/field/value_type.hpp"
#include "engine/files/nifti_form.hpp"

namespace palpate {

inline constexpr std::size_t kNiftiHeaderBytes = 348;

struct NiftiHeader {
  bool swapped = false;       // the file's byte order is not the machine's
  bool one_file = true;       // false: the values are in a file of their own
  std::array<int, 3> size{};  // as in the file; may be 0 or negative [voxel]
  ValueType type = ValueType::kInt16;
  std::uint64_t data_offset = 0;    // of the values in their file, unpacked [byte]
  double slope = 1, intercept = 0;  // of the values; 1 and 0 if the file has none
  NiftiForms forms;
};

// `bytes`: the first kNiftiHeaderBytes, in either byte order. Throws Error(kBadInput, `source`) for a header that is
// cut; another format; more than one volume, or voxels of several numbers; voxel sizes that are not positive; and an
// impossible offset, slope or intercept.
[[nodiscard]] NiftiHeader readNiftiHeader(std::string_view bytes, const std::string& source);

}  // namespace palpate
