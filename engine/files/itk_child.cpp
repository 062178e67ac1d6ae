// SPDX-License-Identifier: Apache-2.0
#include "engine/files/itk_child.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <type_traits>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/module.hpp"

namespace palpate {
namespace {

// Facts as bytes, for the pipe between two processes of one program.
class Packer {
 public:
  template <class T>
  void add(const T& plain) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&plain), sizeof plain);
  }
  void add(const std::string& text) {
    add(text.size());
    bytes_ += text;
  }
  [[nodiscard]] std::string bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  T next() {
    T plain = {};
    std::memcpy(&plain, take(sizeof plain).data(), sizeof plain);
    return plain;
  }
  std::string nextText() { return std::string(take(next<std::size_t>())); }

 private:
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw std::logic_error("facts of an image end early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view bytes_;
};

std::string packed(const ItkFile& file) {
  const ItkHeader& header = file.header();
  Packer pack;
  pack.add(header.components);
  pack.add(header.dimensions.size());
  for (const std::int64_t size : header.dimensions) pack.add(size);
  pack.add(header.origin);
  pack.add(header.spacing);
  pack.add(header.direction);
  pack.add(header.type.has_value());
  pack.add(header.type.value_or(ValueType::kUint8));
  const auto tags = file.tags();
  pack.add(tags.size());
  for (const auto& [key, value] : tags) {
    pack.add(key);
    pack.add(value);
  }
  return pack.bytes();
}

ItkFacts unpacked(const std::string& bytes) {
  Reader read(bytes);
  ItkFacts facts;
  facts.header.components = read.next<unsigned>();
  facts.header.dimensions.resize(read.next<std::size_t>());
  for (std::int64_t& size : facts.header.dimensions) size = read.next<std::int64_t>();
  facts.header.origin = read.next<decltype(facts.header.origin)>();
  facts.header.spacing = read.next<decltype(facts.header.spacing)>();
  facts.header.direction = read.next<decltype(facts.header.direction)>();
  const bool has_type = read.next<bool>();
  const auto type = read.next<ValueType>();
  if (has_type) facts.header.type = type;
  for (std::size_t left = read.next<std::size_t>(); left > 0; --left) {
    const std::string key = read.nextText();
    facts.tags[key] = read.nextText();
  }
  return facts;
}

// ITK would call a file damaged that it merely cannot open.
const std::string& opened(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int why = errno;
  if (descriptor < 0) {
    throw Error(Error::Code::kIo, path, fmt::format("it cannot be opened ({})", std::generic_category().message(why)),
                "check the file and its permissions, and try again");
  }
  close(descriptor);
  return path;
}

double largestFile(const std::vector<std::string>& paths) {
  double largest = 0;
  for (const std::string& path : paths) {
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(path, ignored);
    if (!ignored) largest = std::max(largest, static_cast<double>(bytes));
  }
  return largest;
}

void check(const ChildOutcome& outcome, const RefuseFile& refuse) {
  if (!outcome.trouble) return;
  if (outcome.trouble->error) throw Error(*outcome.trouble->error);
  refuse(outcome.results.size(), outcome.trouble->words);
  throw std::logic_error("a file that cannot be read was not refused");
}

RefuseFile refusalOf(const std::string& source) {
  return [source](std::size_t, const std::string& words) {
    throw Error(Error::Code::kBadInput, source, "it cannot be read (" + words + ")",
                "the file may be cut short or damaged: copy or write it again");
  };
}

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

}  // namespace

ItkHeader readItkHeader(ItkReader reader, const std::string& path, const std::string& source) {
  return readItkSeries(reader, {path}, source, refusalOf(source)).at(0).header;
}

std::vector<ItkFacts> readItkSeries(ItkReader reader, const std::vector<std::string>& paths, const std::string& source,
                                    const RefuseFile& refuse) {
  const ItkModule& itk = loadModule<ItkModule>();  // here: it is not to be loaded after a fork
  const ChildOutcome outcome = runInChild(source, paths.size(), limitsForFile(largestFile(paths)),
                                          [&](std::size_t n) { return packed(*itk.open(reader, opened(paths[n]))); });
  check(outcome, refuse);
  std::vector<ItkFacts> facts;
  for (const std::string& bytes : outcome.results) facts.push_back(unpacked(bytes));
  return facts;
}

void readItkSeriesValues(ItkReader reader, const std::vector<std::string>& paths,
                         const std::vector<std::span<char>>& values, const std::string& source,
                         const RefuseFile& refuse) {
  std::size_t most_bytes = 0;
  for (const std::span<char> part : values) most_bytes = std::max(most_bytes, part.size());
  const ChildLimits limits = limitsForFile(largestFile(paths), 2.0 * static_cast<double>(most_bytes));
  const ItkModule& itk = loadModule<ItkModule>();
  check(runInChild(source, paths.size(), limits,
                   [&](std::size_t n) {
                     const Printed printed;
                     itk.open(reader, opened(paths[n]))->read(values[n]);
                     if (const std::string words = printed.complaint(); !words.empty()) throw std::runtime_error(words);
                     return std::string();
                   }),
        refuse);
}

}  // namespace palpate
