// SPDX-License-Identifier: Apache-2.0
#include "engine/files/itk_child.hpp"

#include <cstring>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "base/child_process.hpp"
#include "base/module.hpp"

namespace palpate {
namespace {

// A header as bytes, for the pipe between two processes of one program.
class Packer {
 public:
  template <class T>
  void add(const T& plain) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&plain), sizeof plain);
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

 private:
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw std::logic_error("the header of an image ends early");
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
  return pack.bytes();
}

ItkHeader unpacked(const std::string& bytes) {
  Reader read(bytes);
  ItkHeader header;
  header.components = read.next<unsigned>();
  header.dimensions.resize(read.next<std::size_t>());
  for (std::int64_t& size : header.dimensions) size = read.next<std::int64_t>();
  header.origin = read.next<decltype(header.origin)>();
  header.spacing = read.next<decltype(header.spacing)>();
  header.direction = read.next<decltype(header.direction)>();
  const bool has_type = read.next<bool>();
  const auto type = read.next<ValueType>();
  if (has_type) header.type = type;
  return header;
}

}  // namespace

ItkHeader readItkHeader(ItkReader reader, const std::string& path, const std::string& source) {
  const ItkModule& itk = loadModule<ItkModule>();  // here: it is not to be loaded after a fork
  const ChildLimits limits = limitsForFile(static_cast<double>(fileBytes(path, source)));
  // The file was opened a moment before, and a child begins with descriptors to spare (base/child_process.cpp): ITK,
  // which calls a file damaged that it cannot open, can.
  const ChildOutcome outcome =
      runInChild(source, 1, limits, [&](std::size_t) { return packed(*itk.open(reader, path)); });
  if (!outcome.trouble) return unpacked(outcome.results.at(0));
  if (outcome.trouble->error) throw Error(*outcome.trouble->error);
  refuse(source, "it cannot be read (" + outcome.trouble->words + ")",
         "the file may be cut short or damaged: copy or write it again");
}

}  // namespace palpate
