// SPDX-License-Identifier: Apache-2.0
#include "service/memory/link_memory.hpp"

#include <cstring>
#include <new>
#include <utility>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

constexpr std::size_t wholePages(std::size_t bytes) {
  return (bytes + LinkMemory::kPage - 1) / LinkMemory::kPage * LinkMemory::kPage;
}

std::size_t bytesFor(std::size_t capacity_samples) {
  if (capacity_samples < 8 || capacity_samples > LinkMemory::kMostWindowSamples) {
    throw Error(Error::Code::kBadInput, "shared memory",
                formatted("windows of {} samples are none; they have 8 to {}", capacity_samples,
                          LinkMemory::kMostWindowSamples),
                "start programs of the same version of Palpate");
  }
  return wholePages(sizeof(LinkBlock)) + 3 * wholePages(capacity_samples * sizeof(Sample));
}

LinkHeader headerFor(std::size_t capacity_samples) {
  LinkHeader header;
  header.block_bytes = sizeof(LinkBlock);
  header.capacity_samples = capacity_samples;
  return header;
}

}  // namespace

LinkMemory::LinkMemory(std::size_t capacity_samples)
    : capacity_samples_(capacity_samples), memory_("palpate-link", bytesFor(capacity_samples)) {
  auto* const made = new (memory_.data()) LinkBlock{};
  made->header = headerFor(capacity_samples);
}

LinkMemory::LinkMemory(Descriptor given, std::size_t capacity_samples)
    : capacity_samples_(capacity_samples), memory_(std::move(given), bytesFor(capacity_samples)) {
  const LinkHeader header = block().header, expected = headerFor(capacity_samples);
  if (std::memcmp(&header, &expected, sizeof header) != 0) {
    throw Error(Error::Code::kBadInput, "shared memory",
                formatted("its layout is not number {}, which this program knows", kLinkLayout),
                "start programs of the same version of Palpate");
  }
}

LinkBlock& LinkMemory::block() noexcept {
  return *std::launder(reinterpret_cast<LinkBlock*>(memory_.data()));
}

std::size_t LinkMemory::windowBytes() const noexcept {
  return wholePages(capacity_samples_ * sizeof(Sample));
}

std::array<Sample*, 3> LinkMemory::samples() noexcept {
  std::array<Sample*, 3> samples{};
  for (std::size_t slot = 0; slot < 3; ++slot)
    samples[slot] = reinterpret_cast<Sample*>(memory_.data() + wholePages(sizeof(LinkBlock)) + slot * windowBytes());
  return samples;
}

}  // namespace palpate
