// SPDX-License-Identifier: Apache-2.0
// The walk over a DICOM file's elements, and what it finds: pixels lie in the file, and frames of RLE unpack. A file
// that it accepts as complete must be refused without its last byte, and with bytes added at its end.
#include "engine/files/dicom_structure.hpp"

#include <vector>

#include "engine/files/dicom_rle.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

// A deflated file may have one padding byte of 0 after its data. Every file that names the deflated syntax counts as
// one.
bool mayBePadded(std::string_view file) {
  return file.find("1.2.840.10008.1.2.1.99") != std::string_view::npos && file.ends_with('\0');
}

void checkPixels(const DicomDataSet& set, std::string_view file) {
  if (set.deflated) return;
  fuzz::require(set.pixel_offset <= file.size(), "its pixels lie behind its end");
  const std::size_t word_bytes = (set.root.number(DicomTag::kBitsAllocated, 8) + 7) / 8;
  const std::size_t bytes =
      std::size_t{set.root.number(DicomTag::kRows, 0)} * set.root.number(DicomTag::kColumns, 0) * word_bytes;
  const bool one_sample = set.root.number(DicomTag::kSamplesPerPixel, 1) <= 1;
  for (const DicomDataSet::Fragment& frame : set.rle_frames) {
    fuzz::require(frame.offset <= file.size() && frame.bytes <= file.size() - frame.offset, "a frame lies outside");
    if (!one_sample || word_bytes == 0 || word_bytes > 15 || bytes > std::size_t{1} << 24U) continue;
    std::vector<char> words(bytes);
    fuzz::require(unpackRle(file.substr(frame.offset, frame.bytes), word_bytes, words), "a frame does not unpack");
  }
}

void check(std::string_view file) {
  const std::optional<DicomDataSet> set = readDicomDataSet(file);
  fuzz::verdict = set ? fuzz::Verdict::kAccepted : fuzz::Verdict::kRefused;
  if (fuzz::verdict == fuzz::Verdict::kRefused) return;
  checkPixels(*set, file);
  if (!mayBePadded(file)) {
    fuzz::require(!dicomIsWhole(file.substr(0, file.size() - 1)), "without its last byte it is whole too");
  }
  fuzz::require(!dicomIsWhole(file.substr(0, file.size() - 2)), "without its last two bytes it is whole too");
  // No element is this short, and 0xff... is no tag.
  for (const std::string_view more : {std::string_view("x"), std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff")})
    fuzz::require(!dicomIsWhole(std::string(file) + std::string(more)), "with bytes behind it it is whole too");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
