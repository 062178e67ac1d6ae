// SPDX-License-Identifier: Apache-2.0
#include "engine/files/stored_values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

constexpr const char* kTooFew = "it has fewer voxels than its header asks for";
constexpr const char* kTooMany = "it has more voxels than its header asks for";

Unpacker open(const StoredValues& values, const StoredPart& part) {
  constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();
  return {part.path, part.offset, values.packing, values.packed_bytes.value_or(kAll)};
}

void skip(Unpacker& from, std::uint64_t bytes) {
  std::vector<char> dropped(std::min<std::uint64_t>(bytes, std::uint64_t{1} << 16));
  while (bytes > 0) {
    const std::size_t piece = std::min<std::uint64_t>(bytes, dropped.size());
    if (from.read(dropped.data(), piece) < piece) throw std::runtime_error(kTooFew);
    bytes -= piece;
  }
}

void readBytes(const StoredValues& values, const StoredPart& part, std::span<char> to) {
  Unpacker from = open(values, part);
  from.unpackWhole();
  skip(from, values.skip_bytes);
  if (from.read(to.data(), to.size()) < to.size()) throw std::runtime_error(kTooFew);
  if (from.drain() > 0) throw std::runtime_error(kTooMany);
}

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
}

// Words between blanks and commas.
class Words {
 public:
  explicit Words(Unpacker from) : from_(std::move(from)) {}

  // The next word; "" if there are no more.
  const std::string& next() {
    word_.clear();
    while (!atEnd()) {
      const char c = block_[at_++];
      if (!isBlank(c)) {
        word_ += c;
      } else if (!word_.empty()) {
        break;
      }
    }
    return word_;
  }

 private:
  bool atEnd() {
    if (at_ < block_.size()) return false;
    block_.resize(std::size_t{1} << 16);
    block_.resize(from_.read(block_.data(), block_.size()));
    at_ = 0;
    return block_.empty();
  }

  Unpacker from_;
  std::vector<char> block_;
  std::size_t at_ = 0;
  std::string word_;
};

template <class T>
T parsed(const std::string& word) {
  T number = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, code] = std::from_chars(word.data() + (word.starts_with('+') ? 1 : 0), end, number);
  if (code == std::errc() && stop == end) return number;
  if (word.empty()) throw std::runtime_error(kTooFew);
  if (code == std::errc::result_out_of_range && stop == end) {
    throw std::runtime_error(
        fmt::format("\"{}\" among its voxels is beyond the range of their type", word.substr(0, 40)));
  }
  throw std::runtime_error(fmt::format("\"{}\" among its voxels is no number of their type", word.substr(0, 40)));
}

void readWords(const StoredValues& values, const StoredPart& part, ValueType type, std::span<char> to) {
  Unpacker from = open(values, part);
  skip(from, values.skip_bytes);
  Words words(std::move(from));
  withType(type, [&](auto zero) {
    using T = decltype(zero);
    for (std::size_t at = 0; at + sizeof(T) <= to.size(); at += sizeof(T)) {
      const T number = parsed<T>(words.next());
      std::memcpy(to.data() + at, &number, sizeof number);
    }
  });
  if (!words.next().empty()) throw std::runtime_error(kTooMany);
}

// The value of a hexadecimal digit; -1 if it is not one.
int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

void readHex(const StoredValues& values, const StoredPart& part, std::span<char> to) {
  Unpacker from = open(values, part);
  skip(from, values.skip_bytes);
  std::size_t digits = 0;
  std::vector<char> block(std::size_t{1} << 16);
  for (std::size_t got = 0; (got = from.read(block.data(), block.size())) > 0;) {
    for (const char c : std::span(block).first(got)) {
      if (isBlank(c) && c != ',') continue;
      const int digit = hexDigit(c);
      if (digit < 0) throw std::runtime_error("among its voxels is what is no hexadecimal digit");
      if (digits / 2 == to.size()) throw std::runtime_error(kTooMany);
      char& byte = to[digits / 2];
      byte = static_cast<char>(digits % 2 == 0 ? digit : 16 * static_cast<unsigned char>(byte) + digit);
      ++digits;
    }
  }
  if (digits < 2 * to.size()) throw std::runtime_error(kTooFew);
}

void readPart(const StoredValues& values, const StoredPart& part, ValueType type, std::span<char> to) {
  switch (values.coding) {
    case Coding::kBinary:
      return readBytes(values, part, to);
    case Coding::kWords:
      return readWords(values, part, type, to);
    case Coding::kHex:
      return readHex(values, part, to);
  }
}

void checkPackedPart(const StoredValues& values, double stored, double wanted, const std::string& source) {
  if (values.packed_bytes && static_cast<double>(*values.packed_bytes) != stored) {
    refuseDamaged(source, fmt::format("its header says that its data are packed into {} bytes, and there are {:.0f}",
                                      *values.packed_bytes, stored));
  }
  checkStoredBytes(source, stored, wanted, true);
}

void checkPart(const StoredValues& values, StoredPart& part, double share, const std::string& source) {
  const double stored = static_cast<double>(fileBytes(part.path, source)) - static_cast<double>(part.offset);
  const double wanted = share + static_cast<double>(values.skip_bytes);
  if (values.packing != Packing::kNone) return checkPackedPart(values, stored, wanted, source);
  if (values.coding == Coding::kHex) {  // blanks may stand between the digits
    if (stored >= wanted + share) return;
    const std::string asked = fmt::format("its header asks for {:.0f} bytes of voxels, two digits each", share);
    refuseDamaged(source, fmt::format("{}, and {:.0f} bytes cannot hold them", asked, stored));
  }
  if (values.coding == Coding::kWords) {
    const double least_voxels = share / 8;                                 // if they have the largest type
    return checkStoredBytes(source, stored, 2 * least_voxels - 1, false);  // one digit each, and blanks between them
  }
  checkStoredBytes(source, stored, wanted, false);
  if (values.from_end) {
    part.offset += static_cast<std::uint64_t>(stored - wanted);
  } else if (stored > wanted) {
    refuseDamaged(source, fmt::format("its header asks for {:.0f} bytes of voxels, and there are {:.0f}", share,
                                      stored - static_cast<double>(values.skip_bytes)));
  }
}

}  // namespace

StoredValues checkedBySize(StoredValues values, double wanted_bytes, const std::string& source) {
  const double share = wanted_bytes / static_cast<double>(values.parts.size());
  for (StoredPart& part : values.parts) checkPart(values, part, share, source);
  values.from_end = false;
  return values;
}

std::optional<RawBlock> rawBlockOf(const StoredValues& values) {
  if (values.parts.size() != 1 || values.packing != Packing::kNone || values.coding != Coding::kBinary) return {};
  return RawBlock{values.parts[0].path, values.parts[0].offset + values.skip_bytes, values.swapped};
}

void readStored(const StoredValues& values, ValueType type, std::span<char> to) {
  const std::size_t share = to.size() / values.parts.size();
  if (share * values.parts.size() != to.size()) throw std::runtime_error("its voxels do not fill its files evenly");
  for (std::size_t n = 0; n < values.parts.size(); ++n) {
    readPart(values, values.parts[n], type, to.subspan(n * share, share));
  }
  if (values.swapped && values.coding != Coding::kWords) swapBytes(to, type);
}

}  // namespace palpate
