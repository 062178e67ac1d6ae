// SPDX-License-Identifier: Apache-2.0
#include "apps/console/remark.hpp"

#include <cstdio>
#include <exception>

#include "apps/console/one_line.hpp"

namespace palpate {

void tellRemark(const std::string& source, const std::string& remark) noexcept {
  if (remark.empty()) return;
  try {
    static_cast<void>(std::fputs(("palpate: " + oneLine(source + ": " + remark) + "\n").c_str(), stderr));
  } catch (const std::exception&) {  // no memory for it
  }
}

}  // namespace palpate
