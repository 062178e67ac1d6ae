// SPDX-License-Identifier: Apache-2.0
#include "service/memory/sealed_memory.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include "tests/support/refusal.hpp"

namespace palpate {
namespace sealed_memory_test {

constexpr std::size_t kBytes = 10'000;

Descriptor copyOf(int number) {
  return Descriptor(fcntl(number, F_DUPFD_CLOEXEC, 0));
}

Descriptor plainMemory(std::size_t bytes, int seals) {
  Descriptor file(memfd_create("plain", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  EXPECT_EQ(ftruncate(file.get(), static_cast<off_t>(bytes)), 0);
  EXPECT_TRUE(seals == 0 || fcntl(file.get(), F_ADD_SEALS, seals) == 0);
  return file;
}

TEST(SealedMemory, IsOneForBothSides) {
  const SealedMemory mine("test", kBytes);
  const SealedMemory theirs(copyOf(mine.descriptor()), kBytes);
  EXPECT_NE(mine.data(), theirs.data());
  EXPECT_EQ(theirs.data()[kBytes - 1], std::byte{0});
  mine.data()[kBytes - 1] = std::byte{7};
  EXPECT_EQ(theirs.data()[kBytes - 1], std::byte{7});
  theirs.data()[0] = std::byte{9};
  EXPECT_EQ(mine.data()[0], std::byte{9});
}

TEST(SealedMemory, OutlivesWhoMadeIt) {
  SealedMemory theirs;
  {
    const SealedMemory mine("test", kBytes);
    mine.data()[5] = std::byte{3};
    theirs = SealedMemory(copyOf(mine.descriptor()), kBytes);
  }
  EXPECT_EQ(theirs.data()[5], std::byte{3});
  const SealedMemory moved(std::move(theirs));
  EXPECT_EQ(moved.data()[5], std::byte{3});
  EXPECT_EQ(moved.bytes(), kBytes);
}

// Who could shorten it would kill the other side at its next look.
TEST(SealedMemory, NobodyChangesItsSize) {
  const SealedMemory mine("test", kBytes);
  EXPECT_NE(ftruncate(mine.descriptor(), 1), 0);
  EXPECT_NE(ftruncate(mine.descriptor(), 2 * kBytes), 0);
  EXPECT_NE(fcntl(mine.descriptor(), F_ADD_SEALS, F_SEAL_WRITE), 0);  // nor makes the other side's writes fail
}

TEST(SealedMemory, MapsNothingElse) {
  constexpr int kAll = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  const auto refused = [](Descriptor given, std::size_t bytes) {
    EXPECT_THAT(refusalOf([&] { const SealedMemory none(std::move(given), bytes); }), testing::HasSubstr("sealed"));
  };
  refused(Descriptor(), kBytes);
  refused(Descriptor(open("/dev/zero", O_RDWR | O_CLOEXEC)), kBytes);
  refused(Descriptor(open("/proc/self/exe", O_RDONLY | O_CLOEXEC)), kBytes);
  refused(plainMemory(kBytes, 0), kBytes);
  for (const int seal : {F_SEAL_SHRINK, F_SEAL_GROW, F_SEAL_SEAL}) refused(plainMemory(kBytes, kAll & ~seal), kBytes);
  for (const std::size_t other : {kBytes - 1, kBytes + 1, std::size_t{0}}) refused(plainMemory(other, kAll), kBytes);
  EXPECT_NO_THROW(SealedMemory(plainMemory(kBytes, kAll), kBytes));
}

TEST(SealedMemory, SaysThatThereIsNoRoom) {
  const auto ask = [] { const SealedMemory none("test", std::size_t{1} << 60U); };
  EXPECT_THAT(refusalOf(ask, Error::Code::kOutOfMemory), testing::HasSubstr("1152921504606846976 bytes"));
}

}  // namespace sealed_memory_test
}  // namespace palpate
