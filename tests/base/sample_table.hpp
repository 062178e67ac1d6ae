// SPDX-License-Identifier: Apache-2.0
// tests/base/sample_table.hpp: the table of a module that is there for the test of modules alone.
#pragma once

#include <string>

namespace palpate {

struct SampleModule {
  static constexpr const char* kModule = "sample";
  static constexpr const char* kTable = "palpate_sample";
  int (*twice)(int number);
  void (*refuseIt)(const std::string& input);  // throws Error(kOutOfMemory)
};

}  // namespace palpate
