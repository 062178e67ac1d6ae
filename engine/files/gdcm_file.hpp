// SPDX-License-Identifier: Apache-2.0
// engine/files/gdcm_file.hpp: unpacks the pixels of DICOM files by GDCM, which is in the module "gdcm"
// (base/module.hpp). Private to engine/files. A damaged file may end the process, so a child process calls it.
#pragma once

#include <span>
#include <string>

namespace palpate {

struct GdcmModule {
  static constexpr const char* kModule = "gdcm";
  static constexpr const char* kTable = "palpate_gdcm";
  // Fills `words` with the stored words of all frames of a file, of `bits_allocated` each, in the machine's byte order.
  // Packed words that are narrower are widened, with their sign. Throws std::runtime_error with words for a message
  // if GDCM cannot, or finds wider words or another number of them. While it runs, std::cerr and std::cout are caught.
  void (*unpack)(const std::string& path, unsigned bits_allocated, std::span<char> words);
};

}  // namespace palpate
