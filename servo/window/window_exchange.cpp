// SPDX-License-Identifier: Apache-2.0
#include "servo/window/window_exchange.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {

WindowStorage::WindowStorage(std::size_t capacity_samples) {
  for (std::vector<Sample>& samples : samples_) samples.resize(capacity_samples);
}

std::array<Sample*, 3> WindowStorage::pointers() noexcept {
  return {samples_[0].data(), samples_[1].data(), samples_[2].data()};
}

WindowExchange::WindowExchange(const std::array<Sample*, 3>& storages, std::size_t capacity_samples)
    : storages_(storages), capacity_samples_(capacity_samples) {
  const bool distinct = storages[0] != storages[1] && storages[1] != storages[2] && storages[0] != storages[2];
  if (storages[0] == nullptr || storages[1] == nullptr || storages[2] == nullptr || !distinct || capacity_samples < 8) {
    throw Error(Error::Code::kBadInput, "window exchange",
                formatted("needs three storages of their own with at least 8 samples each, not {}", capacity_samples),
                "map one buffer for each slot");
  }
}

void WindowExchange::publish() {
  SampleWindow& window = buffer_.back();
  const auto count = window.size.cast<std::int64_t>().prod();
  if (window.size.minCoeff() < 2 || count > static_cast<std::int64_t>(capacity_samples_)) {
    throw Error(Error::Code::kBadInput, "window",
                formatted("{} x {} x {} samples do not fit", window.size.x(), window.size.y(), window.size.z()),
                formatted("use 2 or more along each axis and at most {} in all", capacity_samples_));
  }
  window.samples = storages_[buffer_.backIndex()];
  window.version = ++version_;
  const std::int64_t stamp_ns = window.stamp_ns;  // the slot is the reader's as soon as it is published
  buffer_.publish();
  confirm(stamp_ns);
}

}  // namespace palpate
