// SPDX-License-Identifier: Apache-2.0
#include "tests/engine/files/packed_dicom.hpp"

#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>

namespace palpate {
namespace {

gdcm::TransferSyntax::TSType syntaxOf(DicomPacking packing) {
  switch (packing) {
    case DicomPacking::kRle:
      return gdcm::TransferSyntax::RLELossless;
    case DicomPacking::kJpegLossless:
      return gdcm::TransferSyntax::JPEGLosslessProcess14_1;
    case DicomPacking::kJpegLs:
      return gdcm::TransferSyntax::JPEGLSLossless;
    case DicomPacking::kJpeg2000:
      return gdcm::TransferSyntax::JPEG2000Lossless;
  }
  return gdcm::TransferSyntax::RLELossless;
}

std::uint32_t lengthAt(const std::string& bytes, std::size_t at) {
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + at, sizeof length);
  return length;
}

}  // namespace

std::string packedDicom(const std::string& slice, DicomPacking packing) {
  std::istringstream in(slice);
  gdcm::ImageReader reader;
  reader.SetStream(in);
  if (!reader.Read()) throw std::runtime_error("GDCM cannot read the slice");
  gdcm::ImageChangeTransferSyntax change;
  change.SetTransferSyntax(syntaxOf(packing));
  change.SetInput(reader.GetImage());
  if (!change.Change()) throw std::runtime_error("GDCM cannot pack the slice");
  std::ostringstream out;
  gdcm::ImageWriter writer;
  writer.SetFile(reader.GetFile());
  writer.SetImage(change.GetOutput());
  writer.SetStream(out);
  if (!writer.Write()) throw std::runtime_error("GDCM cannot write the slice");
  return out.str();
}

// Pixels (7fe0,0010) of 12 bytes of head, an item that says where frames begin, and the item of the one frame.
Fragment fragmentOf(const std::string& packed) {
  const std::size_t pixels = packed.rfind(std::string("\xe0\x7f\x10\x00", 4));
  const std::size_t table = pixels + 12;
  const std::size_t item = table + 8 + lengthAt(packed, table + 4);
  return {item + 8, item + 8 + lengthAt(packed, item + 4)};
}

std::string withFragment(const std::string& packed, std::string bytes) {
  const Fragment old = fragmentOf(packed);
  if (bytes.size() % 2 != 0) bytes += '\0';
  const auto length = static_cast<std::uint32_t>(bytes.size());
  std::string text = packed.substr(0, old.first);
  std::memcpy(text.data() + old.first - 4, &length, sizeof length);
  return text + bytes + packed.substr(old.end);
}

}  // namespace palpate
