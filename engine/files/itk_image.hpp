// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_image.hpp: reads one image file: its header by ITK, in a child process, its values from where the
// format's own file says that they lie. Private to engine/files.
//
// ITK gives LPS millimetres; the lattice that comes back is in metres. ITK hides some faults of a header (it takes the
// size of a negative spacing, puts 1 for 0), so each format's own file looks at the raw header first.
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
  std::optional<Lattice> lattice;   // where the reader knows better than ITK
  std::optional<ItkHeader> header;  // likewise: ITK, which may take offence at it, is not asked for it
  double slope = 1;                 // applied here, for formats in which ITK does not
  double intercept = 0;
  std::size_t memory_budget_bytes = 0;
  std::optional<ValueType> stored_type;  // of the values where they lie; without it ITK's
  StoredValues stored;                   // where they lie
};

// Refuses several components, fewer than three dimensions, more than one time point, what exceeds the memory budget,
// values that are not all there, and what ITK cannot read. Set-up thread.
[[nodiscard]] Volume readItkImage(ItkRequest request);

}  // namespace palpate
