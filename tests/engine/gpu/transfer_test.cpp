// SPDX-License-Identifier: Apache-2.0
// Bytes go to the device and come back unchanged, in place and through the staging buffer.
#include "engine/gpu/transfer.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::gpu {
namespace transfer_test {

std::vector<std::byte> randomBytes(std::size_t count) {
  std::mt19937 random(7);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 0xffU);
  return bytes;
}

class TransferTest : public testing::TestWithParam<bool> {};

// The staging buffer holds 16 MiB: 16 MiB + 12 bytes needs a second, short part.
TEST_P(TransferTest, RoundTripAcrossSeveralParts) {
  Gpu gpu({});
  Transfer transfer(gpu, GetParam());
  const std::vector<std::byte> sent = randomBytes((16U << 20U) + 12);
  const Buffer buffer(gpu, "target", sent.size() + 8, MemoryKind::kDevice);
  transfer.upload(sent, buffer, 8);
  std::vector<std::byte> received(sent.size());
  transfer.download(buffer, received, 8);
  EXPECT_EQ(sent, received);
}

TEST_P(TransferTest, NothingIsNothing) {
  Gpu gpu({});
  Transfer transfer(gpu, GetParam());
  const Buffer buffer(gpu, "target", 16, MemoryKind::kDevice);
  transfer.upload({}, buffer);
  transfer.download(buffer, {});
}

INSTANTIATE_TEST_SUITE_P(InPlaceAndStaged, TransferTest, testing::Values(true, false));

}  // namespace transfer_test
}  // namespace palpate::gpu
