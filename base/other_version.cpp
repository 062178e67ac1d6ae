// SPDX-License-Identifier: Apache-2.0
#include "base/other_version.hpp"

namespace palpate {

Error otherVersion(const std::string& input, const std::string& reason) {
  return {Error::Code::kBadInput, input, reason, "start programs of the same version of Palpate"};
}

void refuseOtherVersion(const std::string& input, const std::string& reason) {
  throw otherVersion(input, reason);
}

}  // namespace palpate
