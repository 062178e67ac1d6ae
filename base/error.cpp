// SPDX-License-Identifier: Apache-2.0
#include "base/error.hpp"

#include <cmath>

#include "base/formatted.hpp"
#include "base/outside_text.hpp"

namespace palpate {

// Names and values may contain anything, so control characters are replaced: the message stays one line.
Error::Error(Code code, const std::string& input, const std::string& reason, const std::string& remedy)
    : std::runtime_error(oneLine(input + ": " + reason + "; " + remedy)),
      code_(code),
      parts_(std::make_shared<const Parts>(Parts{oneLine(input), oneLine(reason), oneLine(remedy)})) {}

void refuse(const std::string& input, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, input, reason, remedy);
}

void refuseDamaged(const std::string& file, const std::string& reason) {
  refuse(file, reason, "the file may be cut short or damaged: copy or write it again");
}

void checkSetting(bool good, const std::string& name, double value, const std::string& remedy) {
  if (!good || !std::isfinite(value)) refuse(name, formatted("{} cannot be used", value), remedy);
}

int exitStatus(Error::Code code) noexcept {
  switch (code) {
    case Error::Code::kBadInput:
      return 2;
    case Error::Code::kNotFound:
      return 3;
    case Error::Code::kIo:
      return 4;
    case Error::Code::kOutOfMemory:
      return 5;
    case Error::Code::kDevice:
      return 6;
    case Error::Code::kCancelled:
      return 130;
  }
  return 1;
}

}  // namespace palpate
