// SPDX-License-Identifier: Apache-2.0
// What the child may take that unpacks DICOM files, and what is said where it does not finish.
#include "engine/files/gdcm_child.hpp"

#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace gdcm_child_test {

constexpr double kMiB = 1 << 20;

// Beside 512 MiB and 4 s: six times the words and twice the file; a second for each 4 MiB of either.
TEST(GdcmChild, MayTakeWhatTheWordsNeed) {
  const ChildLimits small = limitsForPacked(100, 200);
  EXPECT_EQ(small.memory_bytes, (std::size_t{512} << 20) + 2 * 100 + 6 * 200);
  EXPECT_EQ(small.cpu_s, 4);
  // A gigabyte of zeros packs to nearly nothing.
  const ChildLimits large = limitsForPacked(kMiB, 1024 * kMiB);
  EXPECT_EQ(large.memory_bytes, (std::size_t{512 + 2 + 6 * 1024} << 20));
  EXPECT_EQ(large.cpu_s, 4 + 256);
}

TEST(GdcmChild, IsSaidToLackMemoryOrTimeWhereItDoes) {
  const auto says = [](ChildTrouble::Kind kind, const std::string& words) {
    try {
      refuseTrouble({kind, {}, words}, "slice a.dcm", "folder");
    } catch (const Error& error) {
      EXPECT_EQ(error.input(), "folder");
      const bool memory = kind == ChildTrouble::Kind::kMemory;
      EXPECT_EQ(error.code(), memory ? Error::Code::kOutOfMemory : Error::Code::kBadInput);
      return error.reason() + "; " + error.remedy();
    }
  };
  using Kind = ChildTrouble::Kind;
  const std::string remedy = "; free memory, or unpack the series in another program";
  EXPECT_EQ(says(Kind::kMemory, "it asks for more"), "slice a.dcm cannot be unpacked (it asks for more)" + remedy);
  EXPECT_EQ(says(Kind::kTooLong, "it takes too long"),
            "slice a.dcm cannot be unpacked (it takes too long); unpack the series in another program");
  for (const Kind kind : {Kind::kException, Kind::kDied})
    EXPECT_EQ(says(kind, "a crash"), "slice a.dcm is damaged (a crash); copy the series again");
  const Error own(Error::Code::kIo, "folder", "slice b.dcm cannot be opened", "look");
  EXPECT_THROW(refuseTrouble({Kind::kError, own, ""}, "slice a.dcm", "folder"), Error);
}

}  // namespace gdcm_child_test
}  // namespace palpate
