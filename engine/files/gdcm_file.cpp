// SPDX-License-Identifier: Apache-2.0
// The module "gdcm".
#include "engine/files/gdcm_file.hpp"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include "engine/files/quiet.hpp"

namespace palpate {
namespace {

// Spreads the words at the front of `words` over all of it, from the last to the first.
template <class From, class To>
void widen(std::span<char> words) {
  for (std::size_t n = words.size() / sizeof(To); n-- > 0;) {
    From from;
    std::memcpy(&from, words.data() + n * sizeof from, sizeof from);
    const To to = from;
    std::memcpy(words.data() + n * sizeof to, &to, sizeof to);
  }
}

void widen(std::span<char> words, std::size_t from_bytes, std::size_t to_bytes, bool is_signed) {
  if (from_bytes == 2)
    return is_signed ? widen<std::int16_t, std::int32_t>(words) : widen<std::uint16_t, std::uint32_t>(words);
  if (to_bytes == 2)
    return is_signed ? widen<std::int8_t, std::int16_t>(words) : widen<std::uint8_t, std::uint16_t>(words);
  is_signed ? widen<std::int8_t, std::int32_t>(words) : widen<std::uint8_t, std::uint32_t>(words);
}

// The bits of a packed value, as the frame header of JPEG (ITU-T T.81, B.2.2) or JPEG-LS (T.87, C.2.2) says; 0 if there
// is none. Segments are a marker, a length, and bytes.
unsigned precisionOf(std::span<const char> stream) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(stream[n]); };
  for (std::size_t at = 2; at + 5 <= stream.size() && byte(at) == 0xff;) {
    const unsigned marker = byte(at + 1);
    const bool no_frame = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;  // tables
    if ((marker >= 0xc0 && marker <= 0xcf && !no_frame) || marker == 0xf7) return byte(at + 4);
    at += marker == 0xff ? 1 : 2 + byte(at + 2) * 256U + byte(at + 3);
  }
  return 0;
}

// GDCM unpacks JPEG and JPEG-LS into words as wide as the file says, and crashes if the stream has narrower ones; and
// it clears what lies beyond the stored bits that the file names. So it is told what the stream has. Of JPEG 2000 it
// finds that itself.
void useWordsOfStream(gdcm::Image& image) {
  const gdcm::SequenceOfFragments* const fragments = image.GetDataElement().GetSequenceOfFragments();
  if (fragments == nullptr || fragments->GetNumberOfFragments() == 0) return;
  const gdcm::ByteValue* const first = fragments->GetFragment(0).GetByteValue();
  if (first == nullptr || image.GetPixelFormat().GetSamplesPerPixel() != 1) return;
  const unsigned bits = precisionOf({first->GetPointer(), first->GetLength()});
  if (bits > 1 && bits < 8)
    throw std::runtime_error("its packed pixels have " + std::to_string(bits) +
                             " bits each, which GDCM does not unpack");
  if (bits < 8 || bits > 16) return;
  const auto stored = static_cast<unsigned short>(bits);
  image.SetPixelFormat(gdcm::PixelFormat(1, bits <= 8 ? 8 : 16, stored, static_cast<unsigned short>(stored - 1),
                                         image.GetPixelFormat().GetPixelRepresentation()));
}

// The image's buffer holds the words as they are stored: GDCM applies slope and intercept, and turns MONOCHROME1 over,
// in filters of their own.
void unpack(const std::string& path, unsigned bits_allocated, std::span<char> words) {
  const Quiet quiet;
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read()) throw std::runtime_error("GDCM cannot read it");
  gdcm::Image& image = reader.GetImage();
  useWordsOfStream(image);
  const std::size_t from_bytes = image.GetPixelFormat().GetBitsAllocated() / 8U;
  const std::size_t to_bytes = bits_allocated / 8U;
  if ((from_bytes != 1 && from_bytes != 2 && from_bytes != 4) || from_bytes > to_bytes ||
      image.GetBufferLength() != words.size() / to_bytes * from_bytes)
    throw std::runtime_error("its packed pixels are of another size than it says");
  if (!image.GetBuffer(words.data())) throw std::runtime_error("GDCM cannot unpack its pixels");
  if (from_bytes < to_bytes) widen(words, from_bytes, to_bytes, image.GetPixelFormat().GetPixelRepresentation() == 1);
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::GdcmModule palpate_gdcm = {palpate::unpack};
