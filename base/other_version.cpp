// SPDX-License-Identifier: Apache-2.0
#include "base/other_version.hpp"

#include "base/error.hpp"

namespace palpate {

void refuseOtherVersion(const std::string& input, const std::string& reason) {
  refuse(input, reason, "start programs of the same version of Palpate");
}

}  // namespace palpate
