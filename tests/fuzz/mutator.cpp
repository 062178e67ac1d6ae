// SPDX-License-Identifier: Apache-2.0
#include "mutator.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <limits>
#include <set>
#include <string_view>

namespace palpate::fuzz {
namespace {

using namespace std::string_view_literals;

constexpr std::array<std::string_view, 28> kNumbers = {"0",
                                                       "-0",
                                                       "1",
                                                       "-1",
                                                       "2",
                                                       "3",
                                                       "7",
                                                       "1e-3",
                                                       "0.1",
                                                       "1e308",
                                                       "-1e308",
                                                       "1e309",
                                                       "5e-324",
                                                       "1e-320",
                                                       "nan",
                                                       "-nan",
                                                       "inf",
                                                       "-inf",
                                                       "3.4e38",
                                                       "3e38",
                                                       "2147483647",
                                                       "2147483648",
                                                       "-2147483649",
                                                       "4294967296",
                                                       "9223372036854775807",
                                                       "18446744073709551616",
                                                       "0x10",
                                                       "1.7976931348623157e308"};
constexpr std::string_view kBytes = "\0\xff\x7f\x80 \t\r\n\v:;,.=#?&%/\\\"'[]{}()<>+-0123456789eExXmMnN"sv;

bool isWordByte(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

bool isNumberByte(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.';
}

template <typename Number>
void put(std::string& bytes, std::size_t at, Number number) {
  if (at + sizeof number <= bytes.size()) std::memcpy(bytes.data() + at, &number, sizeof number);
}

}  // namespace

Mutator::Mutator(std::vector<std::string> corpus, std::uint64_t seed) : corpus_(std::move(corpus)), random_(seed) {
  std::set<std::string> words;
  for (const std::string& input : corpus_) {
    std::string word;
    for (const char c : input + ' ') {
      if (isWordByte(c) && word.size() < 64) {
        word += c;
      } else if (!word.empty()) {
        words.insert(word);
        word.clear();
      }
    }
  }
  words_.assign(words.begin(), words.end());
  words_.insert(words_.end(), kNumbers.begin(), kNumbers.end());
}

std::string Mutator::next() {
  std::string bytes = corpus_[below(corpus_.size())];
  const std::size_t changes = 1 + below(6);
  for (std::size_t n = 0; n < changes; ++n) change(bytes);
  if (bytes.size() > kLongest) bytes.resize(kLongest);
  return bytes;
}

std::size_t Mutator::shortLength(std::size_t most) {
  const std::size_t wish = below(8) == 0 ? most : std::min<std::size_t>(most, 16);
  return wish == 0 ? 0 : 1 + below(wish);
}

void Mutator::change(std::string& bytes) {
  if (bytes.empty()) bytes = std::string(1, static_cast<char>(random_()));
  const std::size_t at = below(bytes.size());
  switch (below(10)) {
    case 0:
    case 1:
      changeByte(bytes);
      break;
    case 2:
      changeStoredNumber(bytes);
      break;
    case 3:
    case 4:
      changeWrittenNumber(bytes);
      break;
    case 5:
      insertWord(bytes);
      break;
    case 6:
      bytes.erase(at, shortLength(bytes.size() - at));
      break;
    case 7:
      bytes.insert(at, bytes.substr(at, shortLength(bytes.size() - at)));
      break;
    case 8:
      movePiece(bytes);
      break;
    default:
      if (below(4) == 0) {
        bytes.resize(at);
      } else {
        bytes.insert(at, shortLength(1200), kBytes[below(kBytes.size())]);
      }
  }
}

void Mutator::changeByte(std::string& bytes) {
  char& byte = bytes[below(bytes.size())];
  byte = below(2) == 0 ? static_cast<char>(byte ^ (1 << below(8))) : kBytes[below(kBytes.size())];
}

void Mutator::changeStoredNumber(std::string& bytes) {
  const std::size_t at = below(bytes.size());
  constexpr std::array<std::int64_t, 10> kIntegers = {
      0, 1, -1, 2, 255, 32767, -32768, 2147483647, -2147483648LL, 1LL << 40U};
  const std::int64_t integer =
      below(3) == 0 ? static_cast<std::int64_t>(random_()) : kIntegers[below(kIntegers.size())];
  constexpr std::array<double, 6> kReals = {
      std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0, 3e38, 1e-320, 1e308};
  switch (below(5)) {
    case 0:
      return put(bytes, at, static_cast<std::int16_t>(integer));
    case 1:
      return put(bytes, at, static_cast<std::int32_t>(integer));
    case 2:
      return put(bytes, at, integer);
    case 3:
      return put(bytes, at, kReals[below(kReals.size())]);
    default:
      return put(bytes, at,
                 below(2) == 0 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::max());
  }
}

// Replaces the first number after a random place, or changes one of its digits.
void Mutator::changeWrittenNumber(std::string& bytes) {
  const auto begin =
      std::find_if(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), bytes.end(), isNumberByte);
  if (begin == bytes.end()) return changeByte(bytes);
  const auto end = std::find_if_not(begin, bytes.end(), isNumberByte);
  if (below(3) == 0) {
    *begin = static_cast<char>('0' + below(10));
  } else {
    bytes.replace(begin, end, kNumbers[below(kNumbers.size())]);
  }
}

void Mutator::movePiece(std::string& bytes) {
  const std::string& from = below(2) == 0 ? corpus_[below(corpus_.size())] : bytes;
  if (from.empty()) return;
  const std::size_t first = below(from.size());
  const std::string piece = from.substr(first, shortLength(from.size() - first));
  const std::size_t at = below(bytes.size());
  if (below(2) == 0) {
    bytes.insert(at, piece);
  } else {
    bytes.replace(at, piece.size(), piece);
  }
}

void Mutator::insertWord(std::string& bytes) {
  const std::string& word = words_[below(words_.size())];
  const std::size_t at = below(bytes.size());
  const auto end = std::find_if_not(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), isWordByte);
  const auto length = static_cast<std::size_t>(end - bytes.begin()) - at;
  bytes.replace(at, below(2) == 0 ? length : 0, word);
}

}  // namespace palpate::fuzz
