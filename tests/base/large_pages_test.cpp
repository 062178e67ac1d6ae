// SPDX-License-Identifier: Apache-2.0
#include "base/large_pages.hpp"

#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace large_pages_test {

struct Range {
  std::uintptr_t begin = 0, end = 0;
  bool operator==(const Range&) const = default;
};

// Parts of [begin, end) for which large pages are wished ("hg"), joined where they meet; source: proc(5), smaps.
std::vector<Range> wishedIn(std::uintptr_t begin, std::uintptr_t end) {
  std::ifstream maps("/proc/self/smaps");
  std::vector<Range> wished;
  Range now;
  for (std::string line; std::getline(maps, line);) {
    unsigned long from = 0, to = 0;
    if (std::sscanf(line.c_str(), "%lx-%lx ", &from, &to) == 2) now = {from, to};
    if (!line.starts_with("VmFlags:") || line.find(" hg") == std::string::npos) continue;
    const Range part{std::max<std::uintptr_t>(now.begin, begin), std::min<std::uintptr_t>(now.end, end)};
    if (part.begin >= part.end) continue;
    if (!wished.empty() && wished.back().end == part.begin) {
      wished.back().end = part.end;
    } else {
      wished.push_back(part);
    }
  }
  return wished;
}

class LargePages : public testing::Test {
 protected:
  static constexpr std::size_t kBytes = 6 * kLargePageBytes;
  void SetUp() override {
    memory_ = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(memory_, MAP_FAILED);
    begin_ = reinterpret_cast<std::uintptr_t>(memory_);
    aligned_ = (begin_ + kLargePageBytes - 1) / kLargePageBytes * kLargePageBytes;
    if (madvise(memory_, kBytes, MADV_NOHUGEPAGE) != 0) GTEST_SKIP() << "this kernel has no large pages";
  }
  void TearDown() override { munmap(memory_, kBytes); }
  [[nodiscard]] std::vector<Range> wished() const { return wishedIn(begin_, begin_ + kBytes); }
  [[nodiscard]] char* at(std::size_t offset) const { return reinterpret_cast<char*>(aligned_ + offset); }

  void* memory_ = nullptr;
  std::uintptr_t begin_ = 0, aligned_ = 0;
};

TEST_F(LargePages, AreWishedWhereTheBlockHoldsThemAsAWhole) {
  wishLargePages(at(100), 3 * kLargePageBytes);
  EXPECT_EQ(wished(), (std::vector<Range>{{aligned_ + kLargePageBytes, aligned_ + 3 * kLargePageBytes}}));
}

TEST_F(LargePages, AreWishedToTheEndsOfABlockThatBeginsWithOne) {
  wishLargePages(at(0), 2 * kLargePageBytes);
  EXPECT_EQ(wished(), (std::vector<Range>{{aligned_, aligned_ + 2 * kLargePageBytes}}));
}

TEST_F(LargePages, AreNotWishedForABlockThatHoldsNone) {
  wishLargePages(at(1), 2 * kLargePageBytes - 2);
  wishLargePages(at(0), kLargePageBytes - 1);
  wishLargePages(at(0), 0);
  wishLargePages(nullptr, 0);
  EXPECT_TRUE(wished().empty());
}

TEST_F(LargePages, ChangeNoByte) {
  std::memset(memory_, 7, kBytes);
  wishLargePages(memory_, kBytes);
  const std::vector<char> sevens(kBytes, 7);
  EXPECT_EQ(std::memcmp(memory_, sevens.data(), kBytes), 0);
}

}  // namespace large_pages_test
}  // namespace palpate
