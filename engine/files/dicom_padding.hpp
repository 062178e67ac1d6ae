// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_padding.hpp: what pixels become that a DICOM file names as padding. Private to engine/files. Any
// thread.
//
// Padding marks pixels outside the image: a scanner writes a value there that no tissue has. But programs also name the
// background of a mask or of a map of labels so. Its density then is the right one, and another would make the mask
// disappear.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

struct SettledPadding {
  std::size_t padded = 0;  // pixels
  std::size_t kept = 0;    // of these, those that keep their density
};

// Pixels that are padding become noValue() (dicom_values.hpp), but for those that keep their density if `may_keep`:
// - whose density is at or below the lowest of the pixels that are no padding, unless it is a picture (their densities
//   span 256 or more) that lies farther above than it spans: -32768 beside a CT says nothing but padding;
// - all, if the pixels that are no padding have one density: the volume would have no other.
// A density that is no number is not kept. `padding` is empty, or has one entry for each density. Throws
// Error(kBadInput) if all pixels are padding. Cost: two reads of the densities.
SettledPadding settlePadding(std::vector<float>& densities, const std::vector<bool>& padding, bool may_keep,
                             const std::string& source);

}  // namespace palpate
