// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/support/only_file.hpp"
#include "tests/support/tell_skipped.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  palpate::tellSkipped();
  return palpate::takeOnlyFile(argc, argv) ? RUN_ALL_TESTS() : 1;
}
