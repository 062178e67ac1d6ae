// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/support/only_file.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return palpate::takeOnlyFile(argc, argv) ? RUN_ALL_TESTS() : 1;
}
