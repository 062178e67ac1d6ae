// SPDX-License-Identifier: Apache-2.0
#include "base/byte_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace {

TEST(ByteSize, KnowsItsUnits) {
  const std::pair<const char*, std::uint64_t> cases[] = {{"1", 1},
                                                         {"65536", 65536},
                                                         {"10B", 10},
                                                         {"3KiB", 3072},
                                                         {"512MiB", 536870912},
                                                         {"2GiB", 2147483648},
                                                         {"2 GiB", 2147483648},
                                                         {"1.5gib", 1610612736},
                                                         {"2G", 2147483648},
                                                         {"2GB", 2147483648},
                                                         {"8192TiB", 9007199254740992}};
  for (const auto& [text, bytes] : cases) EXPECT_EQ(byteSize(text, "--gpu-memory"), bytes) << text;
}

TEST(ByteSize, RefusesWhatIsNoSize) {
  for (const char* text : {"", " ", "0", "0GiB", "-1GiB", "nan", "inf", "GiB", "2XiB", "2iB", "2GiBs", "2 G i B", "0.1",
                           "1e300GiB", "8193TiB", "2,5GiB", "+1GiB"}) {
    try {
      static_cast<void>(byteSize(text, "--gpu-memory"));
      ADD_FAILURE() << "no error: '" << text << "'";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_THAT(error.what(), testing::StartsWith("--gpu-memory: '" + std::string(text) + "' is no size"));
      EXPECT_THAT(error.what(), testing::HasSubstr("512MiB"));
    }
  }
}

TEST(ByteSize, ComesBackFromItsText) {
  for (const std::uint64_t bytes : {1ULL, 1023ULL, 1024ULL, 1536ULL << 20U, 2ULL << 30U, 9007199254740992ULL}) {
    EXPECT_EQ(byteSize(byteSizeText(bytes), ""), bytes);
  }
  EXPECT_EQ(byteSizeText(2ULL << 30U), "2GiB");
  EXPECT_EQ(byteSizeText(1536ULL << 20U), "1536MiB");
}

}  // namespace
}  // namespace palpate
