// SPDX-License-Identifier: Apache-2.0
// servo/window/window_exchange.hpp: hands windows from the engine to the servo, with the engine's word that they still
// hold.
//
// The three windows lie over three sample storages with another owner: the engine maps GPU buffers, tests use
// WindowStorage. Engine and servo use one exchange, or, as two processes, one each over memory that they share
// (window_record.hpp). Threads: the engine makes the writer's calls, the servo the reader's. All are wait-free
// (triple_buffer.hpp). Times are on the servo's clock [ns].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "servo/window/sample_window.hpp"
#include "servo/window/triple_buffer.hpp"
#include "servo/window/window_record.hpp"

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
  // One side of an exchange over a `shared` block that neither side has used, with storages in this process that are
  // the other side's, too. Both outlive it. Its windows are numbered from `first_version` on: a servo that gets another
  // exchange must never take a window for one that it had.
  WindowExchange(WindowBlock& shared, const std::array<Sample*, 3>& storages, std::size_t capacity_samples,
                 std::uint64_t first_version = 1);

  // Writer. Fill every field of back() except `samples` and `version`, and size.x * size.y * size.z samples at
  // backSamples(), i fastest. Both hold the content of an older window and are valid until publish().
  [[nodiscard]] SampleWindow& back() noexcept { return back_; }
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
  void confirm(std::int64_t now_ns) noexcept { block_.confirmation.confirm(now_ns); }

  // Reader: the newest window; valid and constant until the next call. Version 0: nothing published yet. What no engine
  // writes is not usable().
  [[nodiscard]] const SampleWindow& latest() noexcept {
    if (buffer_.renew()) takeFront();
    return latest_;
  }

  // Reader: when the newest window was last confirmed. Call it before latest(). Then latest() gives the confirmed
  // window or a newer one, never an older one (confirmation.hpp).
  [[nodiscard]] std::int64_t confirmedAt_ns() const noexcept { return block_.confirmation.at_ns(); }

 private:
  WindowExchange(std::unique_ptr<WindowBlock> own, const std::array<Sample*, 3>& storages,
                 std::size_t capacity_samples);
  void takeFront() noexcept;

  std::unique_ptr<WindowBlock> own_;  // null: the block is shared
  WindowBlock& block_;
  std::array<Sample*, 3> storages_;
  std::size_t capacity_samples_;
  TripleBuffer<WindowRecord> buffer_;
  std::uint64_t version_;            // writer's
  SampleWindow back_;                // writer's
  alignas(64) SampleWindow latest_;  // reader's, on lines of its own
};

}  // namespace palpate
