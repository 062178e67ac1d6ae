// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_image.hpp: reads one image file. ITK reads the header, in a child process. The values are read here,
// from where the format's reader says that they lie. Private to engine/files.
//
// ITK gives LPS millimetres; the volume's lattice is in metres. ITK hides some faults of a header: it takes the
// absolute value of a negative spacing, and 1 for 0. So each format's reader looks at the raw header first.
#pragma once

#include <optional>
#include <string>

#include "engine/field/volume.hpp"
#include "engine/files/itk_file.hpp"
#include "engine/files/stored_values.hpp"

namespace palpate {

struct ItkRequest {
  ItkReader reader = ItkReader::kNrrd;
  std::string path;
  VolumeFacts facts;                // source is the name in messages; value_type is filled where it is empty
  double metres_per_unit = 1.0e-3;  // of the file's lengths
  std::optional<Lattice> lattice;   // replaces ITK's, if the reader knows better
  std::optional<ItkHeader> header;  // replaces ITK's, if the reader knows better; ITK then does not see the file
  double slope = 1;                 // applied here, for formats to which ITK does not apply it
  double intercept = 0;
  std::size_t memory_budget_bytes = 0;
  std::optional<ValueType> stored_type;  // of the values in the file; empty: the type that ITK found
  StoredValues stored;                   // where the values lie
};

// Throws Error for several components, fewer than three dimensions, more than one time point, more memory than the
// budget, missing values, and whatever ITK cannot read. Set-up thread.
[[nodiscard]] Volume readItkImage(ItkRequest request);

}  // namespace palpate
