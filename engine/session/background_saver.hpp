// SPDX-License-Identifier: Apache-2.0
// engine/session/background_saver.hpp: writes the edited volume to disk beside a session that goes on.
//
// The saver's own thread has the volume on the CPU from the constructor to close(); nobody else may look at it in
// between. The engine's thread hands over what changed, a batch of bricks at a time, and says with a batch which edit
// version it completes and that this one is to be saved. One batch is on its way at a time: while the thread writes a
// file it takes none (ready() is false), and what changes meanwhile waits in the editor's list. So nothing queues up,
// and the engine's thread never waits: no lock, a store and a wake-up. A save that fails leaves the file as it was, is
// told (takeFailures) and ends nothing. Where what changed could not be taken in (no memory), the volume is incomplete:
// that is told once, and nothing is saved any more. The thread runs at a lower priority than the session's.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/edit/brick_grid.hpp"
#include "engine/service/brick_content.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

struct SaveFigures {
  std::vector<double> seconds;           // of each save that is on disk, in order [s]
  std::uint64_t failures = 0;            // saves that are not
  std::uint64_t bytes = 0;               // of the newest file [byte]
  std::optional<std::uint64_t> version;  // edit version that the newest file holds
  std::string failure;                   // of the newest save, in words; empty: it succeeded, or there was none
};

class BackgroundSaver {
 public:
  // Writes the volume, which holds edit version `version`, whole or not at all; returns the file's size [byte]. Called
  // in the saver's thread; throws where it fails.
  using Write = std::function<std::uint64_t(const Volume& volume, std::uint64_t version)>;

  // `volume` outlives this and equals the engine's, but for what the editor still lists as changed.
  BackgroundSaver(Volume& volume, Write write);
  ~BackgroundSaver();  // as close()
  BackgroundSaver(const BackgroundSaver&) = delete;
  BackgroundSaver& operator=(const BackgroundSaver&) = delete;

  // By the engine's thread. Whether the last batch was taken in, and its save is done.
  [[nodiscard]] bool ready() const noexcept { return batch_.load(std::memory_order_acquire) == nullptr; }
  // Only when ready(). `save_version`: with this batch the volume is that of this edit version; save it now.
  void give(std::vector<BrickContent> bricks, std::optional<std::uint64_t> save_version);

  // Only when ready(). Something that changed is lost on the way here: nothing is saved any more, and that is told.
  void abandon(const std::string& why);

  // By the engine's thread: waits until ready(). For the end of a session.
  void wait() const noexcept;
  // Waits for a save that is on its way and ends the thread; the volume is the caller's again.
  void close();

  // Any thread. The edit version that the newest file holds, without a lock.
  [[nodiscard]] std::optional<std::uint64_t> savedVersion() const noexcept {
    const std::uint64_t version = saved_version_.load(std::memory_order_acquire);
    return version == kNone ? std::nullopt : std::optional(version);
  }
  [[nodiscard]] SaveFigures figures() const;
  // What failed since the last call, each in words.
  [[nodiscard]] std::vector<std::string> takeFailures();

 private:
  struct Batch {
    std::vector<BrickContent> bricks;
    std::optional<std::uint64_t> save_version;
    bool last = false;
  };
  void send(std::unique_ptr<Batch> batch);
  void work();
  void takeAndSave(const Batch& batch) noexcept;
  void takeIn(const Batch& batch);
  void save(std::uint64_t version);
  void tell(std::string text, std::string failure);
  void tellBroken(const std::string& why);

  Volume& volume_;
  Write write_;
  BrickGrid grid_;
  std::atomic<Batch*> batch_ = nullptr;  // owned; null: taken in
  bool broken_ = false;                  // the volume misses something; the thread's, and the giver's when ready()
  mutable std::mutex mutex_;             // of the two below
  SaveFigures figures_;
  std::vector<std::string> untold_;
  std::atomic<bool> has_untold_ = false;
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::atomic<std::uint64_t> saved_version_ = kNone;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace palpate
