// SPDX-License-Identifier: Apache-2.0
#include "engine/files/unpacker.hpp"

#include <array>
#include <stdexcept>
#include <system_error>

#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace unpacker_test {

// Bytes that pack, but not to nothing, so that a stream has several blocks of the file.
std::string content(std::size_t count) {
  std::string bytes(count, '\0');
  std::uint32_t random = 1;
  for (char& byte : bytes) byte = "haptics "[(random = random * 1664525U + 1013904223U) >> 29];
  return bytes;
}

class Unpacking : public testing::Test {
 protected:
  [[nodiscard]] std::string gzipped(const std::string& bytes) const {
    writeGzip(folder_.file("gz"), bytes);
    return readFile(folder_.file("gz"));
  }
  struct Outcome {
    std::string bytes, failure;
    bool operator==(const Outcome&) const = default;
  };
  [[nodiscard]] Outcome outcomeOf(Packing packing, std::size_t piece, std::uint64_t offset, bool whole) const {
    Unpacker from(path_, offset, packing);
    if (whole) from.unpackWhole();
    Outcome outcome;
    std::string block(piece, '\0');
    try {
      for (std::size_t got = 0; (got = from.read(block.data(), block.size())) > 0;)
        outcome.bytes += block.substr(0, got);
    } catch (const std::runtime_error& error) {
      outcome.failure = error.what();
    }
    return outcome;
  }
  // In one go it is the same as block by block.
  [[nodiscard]] std::string unpacked(const std::string& bytes, Packing packing, std::size_t piece = 1000,
                                     std::uint64_t offset = 0) const {
    writeFile(path_, bytes);
    const Outcome outcome = outcomeOf(packing, piece, offset, false);
    EXPECT_TRUE(outcomeOf(packing, piece, offset, true) == outcome) << outcome.failure;
    if (!outcome.failure.empty()) throw std::runtime_error(outcome.failure);
    return outcome.bytes;
  }
  void refuses(const std::string& bytes, Packing packing, const std::string& why) const {
    try {
      static_cast<void>(unpacked(bytes, packing));
      ADD_FAILURE() << "no error; expected: " << why;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(why));
    }
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a");
};

TEST_F(Unpacking, SaysWhatTheSystemSays) {
  char byte = 0;
  EXPECT_THROW(Unpacker(folder_.file("none"), 0, Packing::kNone), std::system_error);
  EXPECT_THROW(static_cast<void>(Unpacker(folder_.path(), 0, Packing::kNone).read(&byte, 1)), std::system_error);
}

// The last block of the first stream unpacks to far more than it takes, so that nothing is left to read long before
// all has come out.
TEST(Inflated, IsAllOrNothing) {
  for (const std::string& bytes : {content(1'000'000), std::string(3'000'000, 'a'), std::string()}) {
    const std::string packed = deflated(bytes);
    EXPECT_EQ(inflated(packed, bytes.size()), bytes);
    EXPECT_EQ(inflated(packed + std::string(1, '\0'), bytes.size()), bytes);
    for (const std::string& more : {std::string("x"), std::string(2, '\0'), packed}) {
      EXPECT_FALSE(inflated(packed + more, bytes.size()));
    }
    for (const std::size_t lost : {std::size_t{1}, std::size_t{2}, packed.size() / 2, packed.size()}) {
      EXPECT_FALSE(
          inflated(std::string_view(packed).substr(0, packed.size() - std::min(lost, packed.size())), bytes.size()));
    }
    if (!bytes.empty()) {
      EXPECT_FALSE(inflated(packed, bytes.size() - 1));
    }
  }
  EXPECT_FALSE(inflated("no stream", 100));
}

TEST_F(Unpacking, GivesWhatWasPacked) {
  const std::string bytes = content(1'000'000);
  const std::string packed = gzipped(bytes);
  ASSERT_GT(packed.size(), std::size_t{1} << 18);  // more than one block of the reader's
  for (const std::size_t piece : {1000U, 999'999U, 1'000'000U, 2'000'000U}) {
    EXPECT_EQ(unpacked(packed, Packing::kGzip, piece), bytes);
    EXPECT_EQ(unpacked(packed, Packing::kZlib, piece), bytes);  // MetaIO takes gzip too
    EXPECT_EQ(unpacked(packed, Packing::kNone, piece), packed);
  }
  EXPECT_EQ(unpacked("head" + packed, Packing::kGzip, 1000, 4), bytes);
  writeFile(path_, "head" + packed + "tail");
  EXPECT_EQ(Unpacker(path_, 4, Packing::kZlib, packed.size()).drain(), bytes.size());
}

TEST_F(Unpacking, ReadsMembersAsOneStreamAndPassesOverPadding) {
  const std::string two = gzipped("first ") + gzipped("second") + gzipped("");
  EXPECT_EQ(unpacked(two, Packing::kGzip), "first second");
  EXPECT_EQ(unpacked(two + std::string(300'000, '\0'), Packing::kGzip), "first second");
}

// One member to the end of its file; anything else goes block by block.
TEST_F(Unpacking, UnpacksWholeWhatIsWhole) {
  const std::string packed = gzipped("all");
  writeFile(path_, "head" + packed);
  EXPECT_TRUE(Unpacker(path_, 4, Packing::kGzip).unpackWhole());
  EXPECT_FALSE(Unpacker(path_, 4, Packing::kGzip, packed.size()).unpackWhole());
  EXPECT_FALSE(Unpacker(path_, 4, Packing::kZlib).unpackWhole());
  EXPECT_FALSE(Unpacker(path_, 4, Packing::kNone).unpackWhole());
  EXPECT_FALSE(Unpacker(path_, 0, Packing::kGzip).unpackWhole());
}

TEST_F(Unpacking, RefusesWhatFollowsTheEnd) {
  const std::string packed = gzipped("all");
  refuses(packed + "more", Packing::kGzip, "bytes follow");
  refuses(packed + std::string(300'000, '\0') + "more", Packing::kGzip, "bytes follow");
  refuses(packed + std::string(1, '\0'), Packing::kZlib, "bytes follow");
  refuses(packed + gzipped("x").substr(0, 15), Packing::kGzip, "end early");
}

// Every byte of a stream, each cut and each bit of each byte: refused, or the same content. The header's time, system
// and flag for text carry no content, nor do the bits that fill up the last byte before the checksum.
TEST_F(Unpacking, RefusesEveryCutAndEveryChangedBit) {
  const std::string bytes = content(100);
  const std::string packed = gzipped(bytes);
  for (std::size_t length = 0; length < packed.size(); ++length) {
    refuses(packed.substr(0, length), Packing::kGzip, "end early");
  }
  std::size_t harmless = 0;
  for (std::size_t bit = 0; bit < 8 * packed.size(); ++bit) {
    std::string damaged = packed;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    try {
      EXPECT_EQ(unpacked(damaged, Packing::kGzip), bytes) << "bit " << bit % 8 << " of byte " << bit / 8;
      ++harmless;
      EXPECT_TRUE(bit / 8 < 10 || bit / 8 == packed.size() - 9) << bit / 8 << " of " << packed.size();
    } catch (const std::runtime_error&) {
    }
  }
  EXPECT_LE(harmless, 8U * 6U + 1U + 7U);  // time, extra flags, system; a flag; what fills up a byte
}

TEST_F(Unpacking, SaysWhyAFileCannotBeOpened) {
  EXPECT_THROW(Unpacker(folder_.file("missing"), 0, Packing::kGzip), std::runtime_error);
}

TEST_F(Unpacking, KnowsGzipByItsFirstBytes) {
  writeGzip(path_, "x");
  EXPECT_TRUE(isGzip(path_));
  writeFile(path_, "\x1f");
  EXPECT_FALSE(isGzip(path_));
  EXPECT_FALSE(isGzip(folder_.file("missing")));
}

}  // namespace unpacker_test
}  // namespace palpate
