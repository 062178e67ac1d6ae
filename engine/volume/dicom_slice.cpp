// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/dicom_slice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/volume/dicom_structure.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& source, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, source, reason, remedy);
}

std::string bytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A decimal string as DICOM has it: no "inf", no "nan", no hexadecimal.
bool isDecimal(const std::string& text) {
  return text.find_first_not_of("0123456789+-.eE ") == std::string::npos;
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

void checkDicomFile(const fs::path& path, const std::string& source) {
  if (dicomIsWhole(bytesOf(path))) return;
  refuse(source, fmt::format("slice {} is cut short or damaged", path.filename().string()), "copy the series again");
}

void checkDicomSlice(DicomSlice& slice, const std::string& source) {
  const ItkHeader& header = slice.file.header;
  if (header.components != 1 || !header.type) {
    refuse(source, fmt::format("slice {} has {} components a pixel", slice.name(), header.components),
           "give a CT or MR series");
  }
  if (header.dimensions.size() > 2 && header.dimensions[2] > 1) {
    refuse(source, fmt::format("{} holds several frames", slice.name()), "convert it to NIfTI or NRRD");
  }
  // A slope or intercept that is there and no number would make every density one, or be passed over by GDCM.
  for (const auto& [key, name] : {std::pair("0028|1053", "RescaleSlope"), std::pair("0028|1052", "RescaleIntercept")}) {
    const std::string text = slice.tag(key);
    if (text.empty()) continue;
    const std::vector<double> numbers = dicomNumbers(text);
    const bool good = numbers.size() == 1 && std::isfinite(numbers[0]) && isDecimal(text);
    if (good && (numbers[0] != 0 || key == std::string_view("0028|1052"))) continue;
    refuse(source, fmt::format("the {} \"{}\" of slice {} is no number to scale by", name, text, slice.name()),
           "copy the series again");
  }
  const std::vector<double> spacing = dicomNumbers(slice.tag("0028|0030"));
  if (spacing.size() != 2 || !(spacing[0] > 0) || !(spacing[1] > 0)) {
    refuse(source,
           fmt::format("the PixelSpacing \"{}\" of slice {} is not positive", slice.tag("0028|0030"), slice.name()),
           "write the true pixel size into the files");
  }
  const std::vector<double> position = dicomNumbers(slice.tag("0020|0032"));
  if (position.size() != 3 || dicomNumbers(slice.tag("0020|0037")).size() != 6) {
    refuse(source, fmt::format("slice {} has no position or orientation", slice.name()), "give a CT or MR series");
  }
  slice.position_mm = Vec3(position[0], position[1], position[2]);
}

}  // namespace palpate
