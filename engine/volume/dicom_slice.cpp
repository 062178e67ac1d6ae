// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/dicom_slice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& source, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, source, reason, remedy);
}

// Whether a file's pixels are all there; GDCM fills what is missing with what it likes. True where the pixel data
// (7fe0, 0010) cannot be found as little endian, as in a deflated file.
bool pixelsAreWhole(const fs::path& path) {
  using namespace std::string_view_literals;
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  const std::size_t tag = bytes.rfind("\xe0\x7f\x10\x00"sv);
  if (tag == std::string::npos || tag + 12 > bytes.size()) return tag == std::string::npos;
  const bool has_type = bytes[tag + 4] == 'O';  // explicit: OB or OW, two bytes of nothing, the length
  const std::size_t place = tag + (has_type ? 8 : 4);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + place, sizeof length);
  if (length == 0xffffffffU) return bytes.find("\xfe\xff\xdd\xe0"sv, place) != std::string::npos;  // encapsulated
  return place + sizeof length + length <= bytes.size();
}

}  // namespace

std::vector<double> dicomNumbers(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\\', begin), text.size());
    numbers.push_back(std::atof(text.substr(begin, end - begin).c_str()));
    begin = end + 1;
  }
  return numbers;
}

DicomSlice readDicomSlice(const fs::path& path, const std::string& source) {
  DicomSlice slice;
  slice.path = path;
  try {
    slice.file = std::make_unique<ItkFile>(ItkReader::kDicomSlice, path.string());
  } catch (const std::runtime_error& failure) {
    refuse(source, fmt::format("slice {} cannot be read ({})", slice.name(), failure.what()), "copy the series again");
  }
  return slice;
}

void checkDicomSlice(DicomSlice& slice, const std::string& source) {
  const ItkHeader& header = slice.file->header();
  if (header.components != 1 || !header.type) {
    refuse(source, fmt::format("slice {} has {} components a pixel", slice.name(), header.components),
           "give a CT or MR series");
  }
  if (header.dimensions.size() > 2 && header.dimensions[2] > 1) {
    refuse(source, fmt::format("{} holds several frames", slice.name()), "convert it to NIfTI or NRRD");
  }
  if (!pixelsAreWhole(slice.path))
    refuse(source, fmt::format("slice {} is cut short", slice.name()), "copy the series again");
  const std::vector<double> spacing = dicomNumbers(slice.file->tag("0028|0030"));
  if (spacing.size() != 2 || !(spacing[0] > 0) || !(spacing[1] > 0)) {
    refuse(
        source,
        fmt::format("the PixelSpacing \"{}\" of slice {} is not positive", slice.file->tag("0028|0030"), slice.name()),
        "write the true pixel size into the files");
  }
  const std::vector<double> position = dicomNumbers(slice.file->tag("0020|0032"));
  if (position.size() != 3 || dicomNumbers(slice.file->tag("0020|0037")).size() != 6) {
    refuse(source, fmt::format("slice {} has no position or orientation", slice.name()), "give a CT or MR series");
  }
  slice.position_mm = Vec3(position[0], position[1], position[2]);
}

}  // namespace palpate
