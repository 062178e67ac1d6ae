// SPDX-License-Identifier: Apache-2.0
// tests/support/long_run.hpp: what `./dev test` leaves to `./dev test-long`, so that it ends within 20 minutes on two
// cores: cases that differ little from others that stay.
#pragma once

#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>

namespace palpate {

inline bool isLongRun() {
  const char* text = std::getenv("PALPATE_LONG");
  return text != nullptr && std::strcmp(text, "1") == 0;
}

}  // namespace palpate

#define PALPATE_LONG_ONLY() \
  if (!palpate::isLongRun()) GTEST_SKIP() << "a long test: ./dev test-long runs it"
