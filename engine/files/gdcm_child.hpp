// SPDX-License-Identifier: Apache-2.0
// engine/files/gdcm_child.hpp: unpacks the pixels of DICOM files by GDCM, in a child process (base/child_process.hpp).
// Private to engine/files.
//
// Why a child process: Debian builds GDCM with its assertions on, so it may end over a damaged file. Set-up thread.
// Cost: a fork, and GDCM's own.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/child_process.hpp"

namespace palpate {

struct PackedFile {
  std::filesystem::path path;
  unsigned bits_allocated = 16;  // of a word
  std::span<char> words;         // where the words of all frames go: shared memory (base/shared_buffer.hpp)
};

// Throws Error(kBadInput) that names the first file which GDCM cannot unpack, crashes on or takes too long over;
// Error(kOutOfMemory) for one that needs more than its limit, or than there is; Error(kIo) for one that cannot be
// opened.
void unpackDicom(const std::vector<PackedFile>& files, const std::string& source);

// What the child may take for a file of `file_bytes` whose frames unpack to `word_bytes` together.
[[nodiscard]] ChildLimits limitsForPacked(double file_bytes, double word_bytes);

// Throws as unpackDicom() does. Only what is neither memory nor time speaks of damage.
[[noreturn]] void refuseTrouble(const ChildTrouble& trouble, const std::string& name, const std::string& source);

}  // namespace palpate
