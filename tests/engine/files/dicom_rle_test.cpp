// SPDX-License-Identifier: Apache-2.0
// Frames packed as RLE, by hand (PS3.5, annex G). Which frames are complete is in dicom_structure_test.cpp.
#include "engine/files/dicom_rle.hpp"

#include "tests/engine/files/dicom_writer.hpp"

namespace palpate {
namespace dicom_rle_test {

using Words = std::vector<std::uint16_t>;

std::string frameOf(const std::string& high, const std::string& low) {
  std::vector<double> head = {2, 64, static_cast<double>(64 + high.size())};
  head.resize(16);
  return bytesOf<std::uint32_t>(head) + high + low;
}
bool unpacks(const std::string& frame, Words& words) {
  return unpackRle(frame, 2, {reinterpret_cast<char*>(words.data()), 2 * words.size()});
}

// High bytes: two as they are, a head that means nothing, one three times (257 - 254). Low bytes: one five times.
TEST(DicomRle, UnpacksRunsOfEveryKind) {
  Words words(5);
  ASSERT_TRUE(unpacks(frameOf(std::string("\x01\x01\x02\x80\xfe\x07", 6), std::string("\xfc\x10", 2)), words));
  EXPECT_EQ(words, (Words{0x0110, 0x0210, 0x0710, 0x0710, 0x0710}));
}

TEST(DicomRle, IsRefusedWithTooFewOrTooManyBytes) {
  const std::string low("\xfc\x10", 2);
  for (const std::size_t pixels : {4U, 6U}) {
    Words words(pixels);
    EXPECT_FALSE(unpacks(frameOf(std::string("\x01\x01\x02\x80\xfe\x07", 6), low), words)) << pixels;
  }
  Words words(5);
  EXPECT_FALSE(unpacks(frameOf(std::string("\x04\x01\x02", 3), low), words));  // fewer than its head says
  EXPECT_FALSE(unpacks(std::string(63, '\0'), words));
  EXPECT_FALSE(unpackRle(frameOf(low, low), 4, {reinterpret_cast<char*>(words.data()), 8}));  // two planes, not four
}

// The frames that the tests of whole files write.
TEST(DicomRle, UnpacksWhatTheTestsWrite) {
  std::vector<std::int64_t> stored;
  for (int n = 0; n < 300; ++n) stored.push_back(n * 217 % 65536);  // more than two runs
  Words words(300);
  ASSERT_TRUE(unpacks(rleFrame(stored, 2), words));
  EXPECT_EQ(words, Words(stored.begin(), stored.end()));
}

}  // namespace dicom_rle_test
}  // namespace palpate
