// SPDX-License-Identifier: Apache-2.0
#include "base/crc32c.hpp"

#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace crc32c_test {

// RFC 3720, B.4, and the check value of the catalogue of CRCs.
TEST(Crc32c, KnowsThePublishedValues) {
  EXPECT_EQ(crc32c("123456789"), 0xe3069283U);
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aaU);
  EXPECT_EQ(crc32c(std::string(32, '\xff')), 0x62a8ab43U);
  EXPECT_EQ(crc32c(""), 0U);
}

TEST(Crc32c, GoesOnFromWhatCameBefore) {
  EXPECT_EQ(crc32c("6789", crc32c("12345")), crc32c("123456789"));
}

// Every length up to some words, from every place in a word.
TEST(Crc32c, IsTheSameByTableAndByInstruction) {
  std::string bytes(64, '\0');
  std::uint32_t random = 1;
  for (char& byte : bytes) byte = static_cast<char>((random = random * 1664525U + 1013904223U) >> 24);
  for (std::size_t begin = 0; begin < 8; ++begin) {
    for (std::size_t length = 0; begin + length <= bytes.size(); ++length) {
      const std::string_view part = std::string_view(bytes).substr(begin, length);
      ASSERT_EQ(crc32c(part, 77), crc32cByTable(part, 77)) << begin << " " << length;
    }
  }
}

}  // namespace crc32c_test
}  // namespace palpate
