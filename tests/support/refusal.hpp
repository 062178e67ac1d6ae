// SPDX-License-Identifier: Apache-2.0
// tests/support/refusal.hpp: the words with which a piece of work is refused.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {

inline constexpr const char* kNoRefusal = "accepted";

template <class Work>
std::string refusalOf(const Work& work, Error::Code code = Error::Code::kBadInput) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  return kNoRefusal;
}

}  // namespace palpate
