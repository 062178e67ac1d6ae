// SPDX-License-Identifier: Apache-2.0
#include "apps/console/remark.hpp"

#include "apps/console/message.hpp"

namespace palpate {

void tellRemark(const std::string& source, const std::string& remark) noexcept {
  if (!remark.empty()) tellUser(source + ": " + remark);
}

}  // namespace palpate
