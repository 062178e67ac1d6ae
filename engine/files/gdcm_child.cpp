// SPDX-License-Identifier: Apache-2.0
#include "engine/files/gdcm_child.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/error.hpp"
#include "base/module.hpp"
#include "engine/files/gdcm_file.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

// Catches what C code prints to the standard error of a child process. libjpeg replaces missing data by zeros, and
// reports it there only.
class Printed {
 public:
  Printed() : file_(memfd_create("printed", MFD_CLOEXEC)) {
    if (file_ < 0 || dup2(file_, STDERR_FILENO) < 0)
      throw std::runtime_error(fmt::format("no memory for messages ({})", std::generic_category().message(errno)));
  }
  ~Printed() { close(file_); }
  Printed(const Printed&) = delete;
  Printed& operator=(const Printed&) = delete;
  // The line in which libjpeg complains about its data; empty if there is none.
  [[nodiscard]] std::string complaint() const {
    std::string all(static_cast<std::size_t>(std::max<off_t>(0, lseek(file_, 0, SEEK_END))), '\0');
    const ssize_t got = pread(file_, all.data(), all.size(), 0);
    all.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    for (const std::string_view words : {"Corrupt JPEG data", "Premature end of JPEG file"}) {
      const std::size_t at = all.find(words);
      if (at != std::string::npos) return all.substr(at, all.find('\n', at) - at);
    }
    return {};
  }

 private:
  int file_;
};

// Whatever the files are, the child has what the largest of them needs.
ChildLimits largestLimits(const std::vector<PackedFile>& files, const std::string& source) {
  double largest_file = 0;
  double most_words = 0;
  for (const PackedFile& file : files) {
    largest_file = std::max(largest_file, static_cast<double>(fileBytes(file.path.string(), source)));
    most_words = std::max(most_words, static_cast<double>(file.words.size()));
  }
  return limitsForPacked(largest_file, most_words);
}

}  // namespace

// Seen with GDCM 3.0.21: 150 MiB and 3.3 times the words, for one frame of 128 MiB and for 1024 frames of 512 KiB, of
// JPEG, JPEG-LS and JPEG 2000. The limit is 6 times the words, so that a file of a few bytes which holds many words is
// no trouble. Each takes its time, too: JPEG 2000 gave 75 MiB of words a second.
ChildLimits limitsForPacked(double file_bytes, double word_bytes) {
  return limitsForFile(file_bytes + word_bytes, 4 * word_bytes);
}

void refuseTrouble(const ChildTrouble& trouble, const std::string& name, const std::string& source) {
  using Kind = ChildTrouble::Kind;
  if (trouble.error) throw Error(*trouble.error);
  if (trouble.kind == Kind::kMemory || trouble.kind == Kind::kTooLong) {
    throw Error(trouble.kind == Kind::kMemory ? Error::Code::kOutOfMemory : Error::Code::kBadInput, source,
                fmt::format("{} cannot be unpacked ({})", name, trouble.words),
                trouble.kind == Kind::kMemory ? "free memory, or unpack the series in another program"
                                              : "unpack the series in another program");
  }
  refuse(source, fmt::format("{} is damaged ({})", name, trouble.words), "copy the series again");
}

void unpackDicom(const std::vector<PackedFile>& files, const std::string& source) {
  const GdcmModule& gdcm = loadModule<GdcmModule>();  // here: it is not to be loaded after a fork
  const auto name = [&](std::size_t n) { return "slice " + files[n].path.filename().string(); };
  const ChildOutcome outcome = runInChild(source, files.size(), largestLimits(files, source), [&](std::size_t n) {
    checkOpens(files[n].path.string(), source, name(n));  // GDCM would call a file damaged that it merely cannot open
    const Printed printed;
    gdcm.unpack(files[n].path.string(), files[n].bits_allocated, files[n].words);
    if (const std::string words = printed.complaint(); !words.empty()) throw std::runtime_error(words);
    return std::string();
  });
  if (outcome.trouble) refuseTrouble(*outcome.trouble, name(outcome.results.size()), source);
}

}  // namespace palpate
