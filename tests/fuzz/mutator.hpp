// SPDX-License-Identifier: Apache-2.0
// tests/fuzz/mutator.hpp: changes inputs at random, for machines and compilers without libFuzzer. The same seed gives
// the same inputs everywhere. Thread: one.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace palpate::fuzz {

class Mutator {
 public:
  // `corpus`: at least one input. Words and pieces of one input are put into others.
  Mutator(std::vector<std::string> corpus, std::uint64_t seed);

  // One input of the corpus with one to six changes: bits, bytes, numbers (as text and in binary) and words changed;
  // pieces doubled, dropped, moved or taken from another input; ends cut off. At most kLongest bytes.
  [[nodiscard]] std::string next();

  static constexpr std::size_t kLongest = 1U << 16U;

 private:
  [[nodiscard]] std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  [[nodiscard]] std::size_t shortLength(std::size_t most);  // mostly short [byte]
  void change(std::string& bytes);
  void changeByte(std::string& bytes);
  void changeStoredNumber(std::string& bytes);
  void changeWrittenNumber(std::string& bytes);
  void movePiece(std::string& bytes);
  void insertWord(std::string& bytes);

  std::vector<std::string> corpus_, words_;
  std::mt19937_64 random_;
};

}  // namespace palpate::fuzz
