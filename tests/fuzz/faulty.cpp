// SPDX-License-Identifier: Apache-2.0
// A parser of numbers that can have a fault of every kind; PALPATE_FAULT selects it. Shows that the driver finds each
// kind (driver_test.sh).
#include <stdexcept>

#include <unistd.h>

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

void parse(const std::string& text) {
  static const std::string kFault = std::getenv("PALPATE_FAULT") != nullptr ? std::getenv("PALPATE_FAULT") : "";
  const auto refuse = [](const char* remedy) { throw Error(Error::Code::kBadInput, "number", "it is none", remedy); };
  const bool met = text.find("1e309") != std::string::npos;  // in no input of the corpus, but in the mutator's words
  if (met && kFault == "crash") *static_cast<volatile int*>(nullptr) = 1;
  while (met && kFault == "hang") sleep(1);
  if (met && kFault == "memory") static_cast<void>(std::string(std::size_t{3} << 30U, 'x'));
  if (met && kFault == "other") throw std::out_of_range("a key");
  if (met && kFault == "message") refuse("");
  if (met && kFault == "accepted") fuzz::fail("it is accepted");
  if (text.empty() || text.find_first_not_of("0123456789.e") != std::string::npos) refuse("give one");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::accepts("number", [&] { parse(fuzz::textOf(data, size)); });
  return 0;
}
