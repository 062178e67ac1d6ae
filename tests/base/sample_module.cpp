// SPDX-License-Identifier: Apache-2.0
// The module "sample" of module_test.cpp.
#include "base/error.hpp"
#include "sample_table.hpp"

namespace {

int twice(int number) {
  return 2 * number;
}

void refuseIt(const std::string& input) {
  throw palpate::Error(palpate::Error::Code::kOutOfMemory, input, "it is refused", "go on");
}

}  // namespace

extern "C" const palpate::SampleModule palpate_sample = {twice, refuseIt};
