// SPDX-License-Identifier: Apache-2.0
// The module "gdcm".
#include "engine/files/gdcm_file.hpp"

#include <stdexcept>

#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include "engine/files/quiet.hpp"

namespace palpate {
namespace {

// The image's buffer holds the words as they are stored: GDCM applies slope and intercept, and turns MONOCHROME1 over,
// in filters of their own.
void unpack(const std::string& path, unsigned bits_allocated, std::span<char> words) {
  const Quiet quiet;
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read()) throw std::runtime_error("GDCM cannot read it");
  const gdcm::Image& image = reader.GetImage();
  if (image.GetPixelFormat().GetBitsAllocated() != bits_allocated || image.GetBufferLength() != words.size())
    throw std::runtime_error("its packed pixels are of another size than it says");
  if (!image.GetBuffer(words.data())) throw std::runtime_error("GDCM cannot unpack its pixels");
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::GdcmModule palpate_gdcm = {palpate::unpack};
