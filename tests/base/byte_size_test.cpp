// SPDX-License-Identifier: Apache-2.0
#include "base/byte_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace byte_size_test {

TEST(ByteSize, ReadsNumbersAndUnits) {
  const std::pair<const char*, std::uint64_t> cases[] = {{"0", 0},
                                                         {"1024", 1024},
                                                         {"1B", 1},
                                                         {"512MiB", 536870912},
                                                         {"2GiB", 2147483648},
                                                         {"1GB", 1000000000},
                                                         {"2mb", 2000000},
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

TEST(ByteSize, ComesBackFromItsText) {
  for (const std::uint64_t bytes : {1ULL, 1023ULL, 1024ULL, 1536ULL << 20U, 2ULL << 30U, 9007199254740992ULL}) {
    EXPECT_EQ(byteSize(byteSizeText(bytes), ""), bytes);
  }
  EXPECT_EQ(byteSizeText(2ULL << 30U), "2GiB");
  EXPECT_EQ(byteSizeText(1536ULL << 20U), "1536MiB");
  EXPECT_EQ(byteSizeText(0), "0B");
  EXPECT_EQ(byteSizeText(1ULL << 40U), "1TiB");
  EXPECT_EQ(byteSizeText(1ULL << 50U), "1024TiB");  // there is no larger unit
}

TEST(ByteSize, InWords) {
  EXPECT_EQ(bytesInWords(0), "0 B");
  EXPECT_EQ(bytesInWords(512), "512 B");
  EXPECT_EQ(bytesInWords(1536ULL * 1024), "1.5 MiB");
  EXPECT_EQ(bytesInWords(1048575), "1 MiB");  // not 1024 KiB
  EXPECT_EQ(bytesInWords(1000ULL << 20U), "1000 MiB");
  EXPECT_EQ(bytesInWords(7870000000ULL), "7.33 GiB");
  EXPECT_EQ(bytesInWords(1ULL << 40U), "1 TiB");
  EXPECT_EQ(bytesInWords(1ULL << 50U), "1024 TiB");
  EXPECT_EQ(inMiB(1536ULL << 20U), "1536.0 MiB");
  EXPECT_EQ(inMiB(100000), "0.1 MiB");
}

// What is told as enough is enough.
TEST(ByteSize, WholeIsNeverLess) {
  EXPECT_EQ(wholeMiB(16ULL << 20U), "16MiB");
  EXPECT_EQ(wholeMiB((16ULL << 20U) + 1), "17MiB");
  EXPECT_GE(byteSize(wholeMiB(123456789), ""), 123456789U);
}

}  // namespace byte_size_test
}  // namespace palpate
