// SPDX-License-Identifier: Apache-2.0
#include "tests/damage/damage.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

namespace palpate::damage {
namespace {

class Damager {
 public:
  Damager(const WholeFile& file, std::mt19937_64& random) : file_(file), random_(random) {}

  void apply(Damage damage, std::string& bytes) {
    const std::size_t header = std::min(file_.header_bytes, bytes.size());
    switch (damage) {
      case Damage::kValueByte:
        return changeByte(bytes, header, bytes.size());
      case Damage::kCut:
        return cut(bytes, header);
      case Damage::kSurplus:
        bytes += std::string(1 + below(100), static_cast<char>(1 + below(255)));
        return;
      case Damage::kMiddleLost:
        return loseMiddle(bytes, header);
      case Damage::kHeaderByte:
        return changeByte(bytes, 0, header > 0 ? header : bytes.size());
      case Damage::kHeaderValue:
        return file_.header_is_text ? replaceWord(bytes, header) : replaceNumber(bytes, header);
      case Damage::kLineLost:
      case Damage::kLineTwice:
      case Damage::kLineEmpty:
        return changeLine(damage, bytes, header);
      case Damage::kMany:
        break;
    }
    for (std::size_t left = 2 + below(4); left > 0 && !bytes.empty(); --left) {
      const Damage one = kDamages[below(kDamages.size())];
      if (applies(one, file_)) apply(one, bytes);
    }
  }

 private:
  std::size_t below(std::size_t count) { return count == 0 ? 0 : static_cast<std::size_t>(random_() % count); }

  void changeByte(std::string& bytes, std::size_t begin, std::size_t end) {
    if (begin >= end) return;
    const std::size_t at = begin + below(end - begin);
    const bool is_digit = std::isdigit(static_cast<unsigned char>(bytes[at])) != 0;
    if (file_.values_are_text && is_digit && below(2) == 0) {
      bytes[at] = static_cast<char>('0' + (bytes[at] - '0' + 1 + static_cast<int>(below(9))) % 10);
      return;
    }
    bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + below(255)));
  }

  // Half of the cuts are within the last few bytes.
  void cut(std::string& bytes, std::size_t header) {
    const std::size_t values = bytes.size() - std::min(header, bytes.size());
    const std::size_t most = below(2) == 0 ? std::min<std::size_t>(values, 8) : values;
    bytes.resize(bytes.size() - std::min(bytes.size(), 1 + below(most)));
  }

  void loseMiddle(std::string& bytes, std::size_t header) {
    if (header >= bytes.size()) return;
    const std::size_t most = file_.values_are_text && below(2) == 0 ? 2 : 40;
    bytes.erase(header + below(bytes.size() - header), 1 + below(most));
  }

  // Of four bytes, or two: as a float or an integer.
  void replaceNumber(std::string& bytes, std::size_t header) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    static const std::vector<float> kFloats = {std::nanf(""), kInfinity, -kInfinity, 3e38F, -3e38F, 0, -1, 1e-38F};
    static const std::vector<std::uint32_t> kWholes = {0, 1, 0x7fffffffU, 0x80000000U, 0xffffffffU, 0x00ffffffU};
    const std::size_t end = header > 0 ? header : bytes.size();
    if (end < 4) return;
    const std::size_t at = below(end / 2 - 1) * 2;
    const std::uint32_t number =
        below(2) == 0 ? std::bit_cast<std::uint32_t>(kFloats[below(kFloats.size())]) : kWholes[below(kWholes.size())];
    std::memcpy(bytes.data() + at, &number, below(3) == 0 ? 2 : 4);
  }

  // Begin and end of one of the header's lines, its end mark included.
  std::pair<std::size_t, std::size_t> line(const std::string& bytes, std::size_t header) {
    const std::size_t end = header > 0 ? header : bytes.size();
    const std::size_t inside = below(end);
    std::size_t begin = inside == 0 ? std::string::npos : bytes.rfind('\n', inside - 1);
    begin = begin == std::string::npos ? 0 : begin + 1;
    const std::size_t stop = bytes.find('\n', inside);
    return {begin, stop == std::string::npos ? bytes.size() : stop + 1};
  }

  void replaceWord(std::string& bytes, std::size_t header) {
    static const std::vector<std::string> kWords = {"nan",
                                                    "inf",
                                                    "-inf",
                                                    "3e38",
                                                    "-3e38",
                                                    "1e400",
                                                    "0",
                                                    "-1",
                                                    "99999999999999999999",
                                                    "4294967295",
                                                    "",
                                                    "LIST",
                                                    std::string(1000, '9'),
                                                    std::string(1000, 'x'),
                                                    "1 2",
                                                    "%d",
                                                    "0.0000000001"};
    const auto [begin, end] = line(bytes, header);
    std::size_t at = bytes.find(file_.separator, begin);
    at = at == std::string::npos || at >= end ? begin : at + 1;
    std::size_t stop = end - (end > begin && bytes[end - 1] == '\n' ? 1 : 0);
    if (below(2) == 0 && at < stop) {  // one word of several
      const std::size_t word = at + below(stop - at);
      const std::size_t from = bytes.find_last_of(" (,", word), to = bytes.find_first_of(" ),\n", word + 1);
      if (from != std::string::npos && from >= at) at = from + 1;
      if (to != std::string::npos && to < stop) stop = to;
    }
    bytes.replace(at, stop - std::min(at, stop), kWords[below(kWords.size())]);
  }

  void changeLine(Damage damage, std::string& bytes, std::size_t header) {
    const auto [begin, end] = line(bytes, header);
    if (damage == Damage::kLineLost) {
      bytes.erase(begin, end - begin);
    } else if (damage == Damage::kLineTwice) {
      bytes.insert(end, bytes.substr(begin, end - begin));
    } else {
      bytes.insert(begin, "\n");
    }
  }

  const WholeFile& file_;
  std::mt19937_64& random_;
};

}  // namespace

const char* nameOf(Damage damage) {
  switch (damage) {
    case Damage::kValueByte:
      return "a byte of the values";
    case Damage::kCut:
      return "cut short";
    case Damage::kSurplus:
      return "bytes too many";
    case Damage::kMiddleLost:
      return "bytes lost within";
    case Damage::kHeaderByte:
      return "a byte of the header";
    case Damage::kHeaderValue:
      return "a header value";
    case Damage::kLineLost:
      return "a line lost";
    case Damage::kLineTwice:
      return "a line twice";
    case Damage::kLineEmpty:
      return "an empty line";
    case Damage::kMany:
      return "several of them";
  }
  return "";
}

bool applies(Damage damage, const WholeFile& file) {
  if (!file.has_values && (damage == Damage::kValueByte || damage == Damage::kMiddleLost)) return false;
  if (!file.has_header && (damage == Damage::kHeaderByte || damage == Damage::kHeaderValue)) return false;
  const bool of_lines = damage == Damage::kLineLost || damage == Damage::kLineTwice || damage == Damage::kLineEmpty;
  return file.header_is_text || !of_lines;
}

bool mustBeSeen(Damage damage, const WholeFile& file) {
  const Promise& promise = file.promise;
  switch (damage) {
    case Damage::kValueByte:
      return promise.values;
    case Damage::kCut:
    case Damage::kSurplus:
      return promise.length || promise.ends;
    case Damage::kMiddleLost:
      return promise.length;
    case Damage::kLineTwice:
      return promise.lines_once;
    case Damage::kMany:
      return promise.header && !promise.can_be_lost;
    default:
      return promise.header;
  }
}

std::string damaged(const std::string& whole, Damage damage, const WholeFile& file, std::mt19937_64& random) {
  Damager damager(file, random);
  for (int n = 0; n < 10'000; ++n) {
    std::string bytes = whole;
    damager.apply(damage, bytes);
    if (bytes != whole) return bytes;
  }
  throw std::logic_error(std::string("there is no way to damage it: ") + nameOf(damage) + ", " + file.name);
}

}  // namespace palpate::damage
