// SPDX-License-Identifier: Apache-2.0
// tests/support/only_file.hpp: one program holds the tests of many files; "--only x_test.cpp" runs those of one.
#pragma once

namespace palpate {

// Call it after InitGoogleTest(). Sets gtest's filter, unless one was given. False, and a message: no test is in that
// file.
[[nodiscard]] bool takeOnlyFile(int argc, char** argv);

}  // namespace palpate
