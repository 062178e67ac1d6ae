// SPDX-License-Identifier: Apache-2.0
// Messages of a client, or of a servo, that means harm: bytes that are none, messages with changed bytes, messages
// where none may be, and questions that must be refused. None of them may change a volume, a setting or a file. The
// same seed gives the same ones.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/mutator.hpp"

namespace palpate {

class HostileMessages {
 public:
  explicit HostileMessages(std::uint64_t seed);

  [[nodiscard]] std::vector<std::byte> next();
  // What a servo says after its Hello.
  [[nodiscard]] std::vector<std::byte> nextOfAServo();
  [[nodiscard]] std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }

 private:
  [[nodiscard]] std::vector<std::byte> refusedQuestion();
  [[nodiscard]] std::vector<std::byte> refusedView();
  [[nodiscard]] std::vector<std::byte> refusedSettings();
  [[nodiscard]] std::vector<std::byte> changedMessage();
  [[nodiscard]] std::vector<std::byte> noise();
  [[nodiscard]] std::string word();

  std::mt19937_64 random_;
  fuzz::Mutator mutator_;
};

}  // namespace palpate
