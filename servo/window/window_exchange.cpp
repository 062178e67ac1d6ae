// SPDX-License-Identifier: Apache-2.0
#include "servo/window/window_exchange.hpp"

#include <atomic>
#include <utility>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {

WindowStorage::WindowStorage(std::size_t capacity_samples) {
  for (std::vector<Sample>& samples : samples_) samples.resize(capacity_samples);
}

std::array<Sample*, 3> WindowStorage::pointers() noexcept {
  return {samples_[0].data(), samples_[1].data(), samples_[2].data()};
}

WindowExchange::WindowExchange(WindowBlock& shared, const std::array<Sample*, 3>& storages,
                               std::size_t capacity_samples, std::uint64_t first_version)
    : block_(shared),
      storages_(storages),
      capacity_samples_(capacity_samples),
      buffer_(shared.windows),
      version_(first_version - 1) {
  const bool distinct = storages[0] != storages[1] && storages[1] != storages[2] && storages[0] != storages[2];
  if (storages[0] == nullptr || storages[1] == nullptr || storages[2] == nullptr || !distinct || capacity_samples < 8) {
    throw Error(Error::Code::kBadInput, "window exchange",
                formatted("needs three storages of their own with at least 8 samples each, not {}", capacity_samples),
                "map one buffer for each slot");
  }
}

WindowExchange::WindowExchange(const std::array<Sample*, 3>& storages, std::size_t capacity_samples)
    : WindowExchange(std::make_unique<WindowBlock>(), storages, capacity_samples) {}

WindowExchange::WindowExchange(std::unique_ptr<WindowBlock> own, const std::array<Sample*, 3>& storages,
                               std::size_t capacity_samples)
    : WindowExchange(*own, storages, capacity_samples) {
  own_ = std::move(own);
}

void WindowExchange::publish() {
  const auto count = back_.size.cast<std::int64_t>().prod();
  if (back_.size.minCoeff() < 2 || count > static_cast<std::int64_t>(capacity_samples_)) {
    throw Error(Error::Code::kBadInput, "window",
                formatted("{} x {} x {} samples do not fit", back_.size.x(), back_.size.y(), back_.size.z()),
                formatted("use 2 or more along each axis and at most {} in all", capacity_samples_));
  }
  back_.version = ++version_;
  buffer_.back() = recordOf(back_);
  buffer_.publish();
  confirm(back_.stamp_ns);
}

void WindowExchange::takeFront() noexcept {
  const WindowRecord record = buffer_.front();
  std::atomic_signal_fence(std::memory_order_seq_cst);  // what is checked is this copy, not the memory read anew
  latest_ = windowOf(record, storages_[buffer_.frontIndex()], capacity_samples_);
}

}  // namespace palpate
