// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_rle.hpp"

#include <bit>
#include <cstdint>

namespace palpate {
namespace {

std::uint32_t littleEndian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Calls `run(bytes, repeat)` for each run of a plane that has exactly `bytes` bytes: these bytes, or one byte `repeat`
// times. False if the plane has fewer or more.
template <class Run>
bool forEachRun(std::string_view plane, double bytes, const Run& run) {
  double given = 0;
  for (std::size_t at = 0; given < bytes;) {
    if (at >= plane.size()) return false;
    const auto head = static_cast<unsigned char>(plane[at++]);
    if (head == 128) continue;
    const bool literal = head < 128;
    const std::size_t count = literal ? head + 1U : 257U - head;
    const std::size_t stored = literal ? count : 1;
    if (stored > plane.size() - at) return false;
    given += static_cast<double>(count);
    if (given > bytes) return false;
    run(plane.substr(at, stored), literal ? 1 : count);
    at += stored;
  }
  return true;
}

// Calls `take(n, plane)`, which returns whether the plane is good, for each of `planes` planes.
template <class Take>
bool forEachPlane(std::string_view frame, double planes, const Take& take) {
  constexpr std::size_t kHeader = 64;
  if (frame.size() < kHeader || littleEndian(frame, 0) != planes) return false;
  std::size_t begin = littleEndian(frame, 4);
  if (begin < kHeader) return false;
  for (std::size_t plane = 1; static_cast<double>(plane) <= planes; ++plane) {
    const bool last = static_cast<double>(plane) == planes;
    const std::size_t end = last ? frame.size() : littleEndian(frame, 4 * (plane + 1));
    if (end < begin || end > frame.size()) return false;
    if (!take(plane - 1, frame.substr(begin, end - begin))) return false;
    begin = end;
  }
  return true;
}

}  // namespace

bool rleFits(std::string_view frame, double pixels, double planes) {
  return forEachPlane(frame, planes, [&](std::size_t, std::string_view plane) {
    return forEachRun(plane, pixels, [](std::string_view, std::size_t) {});
  });
}

bool unpackRle(std::string_view frame, std::size_t word_bytes, std::span<char> words) {
  constexpr bool kLowestFirst = std::endian::native == std::endian::little;
  const std::size_t count = words.size() / word_bytes;
  const auto pixels = static_cast<double>(count);
  return forEachPlane(frame, static_cast<double>(word_bytes), [&](std::size_t n, std::string_view plane) {
    std::size_t at = kLowestFirst ? word_bytes - 1 - n : n;
    return forEachRun(plane, pixels, [&](std::string_view bytes, std::size_t repeat) {
      for (std::size_t time = 0; time < repeat; ++time) {
        for (const char byte : bytes) {
          words[at] = byte;
          at += word_bytes;
        }
      }
    });
  });
}

}  // namespace palpate
