// SPDX-License-Identifier: Apache-2.0
// Carries the tests' precompiled header (cmake/PalpateTest.cmake); does nothing.
int main() {
  return 0;
}
