// SPDX-License-Identifier: Apache-2.0
// A folder of two DICOM slices of the same words, for tests of what these mean as densities.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/engine/files/dicom_writer.hpp"

namespace palpate {

class TwoDicomSlices : public testing::Test {
 protected:
  using Change = std::function<void(WrittenItem&)>;
  // Two slices of these six words each, and what `change` makes of the second or of both.
  void write(const WrittenImage& image, const Change& change = {}, bool both = true,
             const std::string& syntax = kLittleEndianDicom) const {
    for (int n = 0; n < 2; ++n) {
      WrittenItem set = imageSet(image);
      placeAt(set, fmt::format("0\\0\\{}", 2 * n));
      if (change && (both || n == 1)) change(set);
      writeFile(folder_.file(fmt::format("s{}.dcm", n)), DicomWriter(syntax).file(set));
    }
  }
  void expectSlices(const std::vector<float>& slice, const std::string& more = "") const {
    std::vector<float> both = slice;
    both.insert(both.end(), slice.begin(), slice.end());
    EXPECT_EQ(loadVolume(folder_.path() + more).toDense(), both);
  }
  void refuses(const std::string& reason) const { expectLoadRefusal(folder_.path(), reason); }

  static WrittenImage ramp() {
    WrittenImage image;
    image.words = {0, 1, 2, -1, 100, 32767};
    return image;
  }
  static Change scale(const std::string& slope, const std::string& intercept) {
    return [=](WrittenItem& set) {
      if (!intercept.empty()) set[0x00281052] = textOf("DS", intercept);
      if (!slope.empty()) set[0x00281053] = textOf("DS", slope);
    };
  }
  static WrittenElement table(const std::vector<std::int64_t>& descriptor, const WrittenElement& data,
                              const std::string& type = "SS") {
    return itemsOf({{{0x00283002, numbersOf(type, descriptor)}, {0x00283006, data}}});
  }

  TempFolder folder_;
};

}  // namespace palpate
