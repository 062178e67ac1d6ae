// SPDX-License-Identifier: Apache-2.0
#include "base/byte_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace {

TEST(ByteSize, ReadsNumbersAndUnits) {
  const std::pair<const char*, std::uint64_t> cases[] = {{"0", 0},
                                                         {"1024", 1024},
                                                         {"1B", 1},
                                                         {"512MiB", 536870912},
                                                         {"2GiB", 2147483648},
                                                         {"1GB", 1000000000},
                                                         {"1.5kB", 1500},
                                                         {"3KiB", 3072},
                                                         {"0.5gib", 536870912},
                                                         {"1TB", 1000000000000},
                                                         {"1TiB", 1099511627776},
                                                         {"7.9", 7}};
  for (const auto& [text, bytes] : cases) EXPECT_EQ(byteSize(text, "--memory"), bytes) << text;
}

TEST(ByteSize, RefusesWhatIsNoSize) {
  for (const char* text :
       {"", "GiB", "-1", "-1MiB", "nan", "inf", "1 MiB", "1MiBs", "1furlong", "1e30", "8388608TiB"}) {
    try {
      static_cast<void>(byteSize(text, "--memory"));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_THAT(error.what(),
                  testing::StartsWith("--memory: '" + std::string(text) + "' is no size of memory; give"));
    }
  }
}

}  // namespace
}  // namespace palpate
