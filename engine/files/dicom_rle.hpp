// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_rle.hpp: frames of DICOM images packed as RLE. Private to engine/files. Any thread.
//
// A frame is 16 words that say where its byte planes begin, then the planes: the highest byte of every pixel, then the
// next one. A plane is packed by PackBits.
// Source: DICOM PS3.5, annex G.
#pragma once

#include <span>
#include <string_view>

namespace palpate {

// Whether a frame is complete: `planes` planes of exactly `pixels` bytes each, and padding. Cost: one step a run.
[[nodiscard]] bool rleFits(std::string_view frame, double pixels, double planes);

// Unpacks a frame of one sample into words of `word_bytes` in the machine's byte order. False if it is not complete;
// `words` then hold anything.
[[nodiscard]] bool unpackRle(std::string_view frame, std::size_t word_bytes, std::span<char> words);

}  // namespace palpate
