// SPDX-License-Identifier: Apache-2.0
// servo/window/window_exchange.hpp: hands windows from the engine to the servo, with the engine's word that they still
// hold.
//
// The three windows lie over three sample storages with another owner: the engine maps GPU buffers, tests use
// WindowStorage. Threads: the engine makes the writer's calls, the servo the reader's. All are wait-free
// (triple_buffer.hpp). Times are on the servo's clock [ns].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "servo/window/confirmation.hpp"
#include "servo/window/sample_window.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

// Plain memory for the three slots of an exchange.
class WindowStorage {
 public:
  explicit WindowStorage(std::size_t capacity_samples);
  [[nodiscard]] std::array<Sample*, 3> pointers() noexcept;
  [[nodiscard]] std::size_t capacity() const noexcept { return samples_[0].size(); }

 private:
  std::array<std::vector<Sample>, 3> samples_;
};

class WindowExchange {
 public:
  // `storages`: three blocks of `capacity_samples` samples each, which outlive the exchange.
  // Throws Error(kBadInput) on a null or shared storage and on a capacity below 8 samples.
  WindowExchange(const std::array<Sample*, 3>& storages, std::size_t capacity_samples);
  explicit WindowExchange(WindowStorage& storage) : WindowExchange(storage.pointers(), storage.capacity()) {}

  // Writer. Fill every field of back() except `samples` and `version`, and size.x * size.y * size.z samples at
  // backSamples(), i fastest. Both hold the content of an older window and are valid until publish().
  [[nodiscard]] SampleWindow& back() noexcept { return buffer_.back(); }
  [[nodiscard]] Sample* backSamples() noexcept { return storages_[buffer_.backIndex()]; }
  // Writer: the number of the storage behind backSamples(): 0, 1 or 2.
  [[nodiscard]] unsigned backIndex() const noexcept { return buffer_.backIndex(); }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_samples_; }
  // Writer: the version of the next window to be published; the first is 1.
  [[nodiscard]] std::uint64_t nextVersion() const noexcept { return version_ + 1; }

  // Writer: sets `samples` and `version` (one more than the last) of back(), hands it over, and confirms it at its
  // stamp_ns. Throws Error(kBadInput) if a side is below 2 samples or the window exceeds the capacity; then nothing is
  // published.
  void publish();

  // Writer: the engine's heartbeat. It says that at `now_ns` the newest published window still shows the volume.
  void confirm(std::int64_t now_ns) noexcept { confirmation_.confirm(now_ns); }

  // Reader: the newest window; valid and constant until the next call. Version 0: nothing published yet.
  [[nodiscard]] const SampleWindow& latest() noexcept { return buffer_.latest(); }

  // Reader: when the newest window was last confirmed. Call it before latest(). Then latest() gives the confirmed
  // window or a newer one, never an older one (confirmation.hpp).
  [[nodiscard]] std::int64_t confirmedAt_ns() const noexcept { return confirmation_.at_ns(); }

 private:
  std::array<Sample*, 3> storages_;
  std::size_t capacity_samples_;
  std::uint64_t version_ = 0;  // writer's
  TripleBuffer<SampleWindow> buffer_;
  Confirmation<> confirmation_;
};

}  // namespace palpate
