// SPDX-License-Identifier: Apache-2.0
#include "version.hpp"

namespace palpate {
namespace {
#include "version.inc"
}  // namespace

const char* programVersion() noexcept {
  return kVersion;
}
const char* programCommit() noexcept {
  return kCommit;
}

}  // namespace palpate
