// SPDX-License-Identifier: Apache-2.0
#include "base/error.hpp"

#include "base/one_line.hpp"

namespace palpate {

// Names and values may hold anything; the message stays one line of text.
Error::Error(Code code, const std::string& input, const std::string& reason, const std::string& remedy)
    : std::runtime_error(oneLine(input + ": " + reason + "; " + remedy)),
      code_(code),
      parts_(std::make_shared<const Parts>(Parts{oneLine(input), oneLine(reason), oneLine(remedy)})) {}

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
