// SPDX-License-Identifier: Apache-2.0
// tests/support/tell_skipped.hpp: ctest counts a file whose cases were skipped as passed. So each skipped case goes to
// a list that `./dev test` prints.
#pragma once

namespace palpate {

// Call it after InitGoogleTest(). Where PALPATE_SKIPPED names a file, each skipped case adds "SUITE.NAME: MESSAGE" to
// it.
void tellSkipped();

}  // namespace palpate
