// SPDX-License-Identifier: Apache-2.0
// What is unpacked in one go, and what is left to a stream. That both give the same bytes is for unpacker_test.cpp.
#include "engine/files/whole_gzip.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace whole_gzip_test {

class WholeGzipTest : public testing::Test {
 protected:
  [[nodiscard]] std::string gzipped(const std::string& bytes) const {
    writeGzip(folder_.file("gz"), bytes);
    return readFile(folder_.file("gz"));
  }
  // Empty: it is left to a stream.
  [[nodiscard]] std::optional<std::string> whole(const std::string& file, std::uint64_t offset = 0) const {
    writeFile(path_, file);
    const int descriptor = open(path_.c_str(), O_RDONLY);
    lseek(descriptor, 1, SEEK_SET);
    const auto taken = wholeGzip(descriptor, offset);
    EXPECT_EQ(lseek(descriptor, 0, SEEK_CUR), 1);
    close(descriptor);
    if (!taken) return {};
    return std::string(taken->bytes.get(), taken->count);
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a");
};

TEST_F(WholeGzipTest, TakesOneMember) {
  for (const std::string& bytes : {std::string(), std::string("x"), std::string(3'000'000, 'a')}) {
    EXPECT_EQ(whole(gzipped(bytes)), bytes);
    EXPECT_EQ(whole("head" + gzipped(bytes), 4), bytes);
  }
}

TEST_F(WholeGzipTest, LeavesTheRestToAStream) {
  const std::string packed = gzipped("all of it");
  EXPECT_FALSE(whole(packed + packed));
  EXPECT_FALSE(whole(packed + std::string(4, '\0')));
  EXPECT_FALSE(whole(packed + "tail"));
  EXPECT_FALSE(whole(packed, 4));
  EXPECT_FALSE(whole(packed, packed.size()));
  EXPECT_FALSE(whole(packed, packed.size() + 100));
  EXPECT_FALSE(whole(""));
  for (std::size_t length = 0; length < packed.size(); ++length) EXPECT_FALSE(whole(packed.substr(0, length)));
}

// A length that is told as larger or smaller than it is, by one or by all that four bytes can say.
TEST_F(WholeGzipTest, BelievesNoToldLength) {
  const std::string packed = gzipped(std::string(1000, 'a'));
  for (const std::uint32_t told : {0U, 999U, 1001U, 1U << 24U, 0xFFFFFFFFU}) {
    std::string lying = packed;
    for (std::size_t byte = 0; byte < 4; ++byte) lying[lying.size() - 4 + byte] = static_cast<char>(told >> (8 * byte));
    EXPECT_FALSE(whole(lying)) << told;
  }
}

TEST_F(WholeGzipTest, LeavesWhatIsNoFileToAStream) {
  EXPECT_FALSE(wholeGzip(-1, 0));
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_FALSE(wholeGzip(ends[0], 0));
  close(ends[0]);
  close(ends[1]);
}

}  // namespace whole_gzip_test
}  // namespace palpate
