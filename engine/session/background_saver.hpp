// SPDX-License-Identifier: Apache-2.0
// engine/session/background_saver.hpp: writes the edited volume to disk while the session goes on.
//
// Threads: the saver's own thread owns the volume on the CPU from the constructor to close(); nobody else may look at
// it in between. It runs at a lower priority than the session's threads. The engine's thread hands over the bricks that
// changed, a batch at a time. A batch may name the edit version that it completes; then that version is saved.
//
// One batch is under way at a time. While the saver writes a file, ready() is false and it takes no batch; changed
// bricks wait in the editor's list. So nothing queues up and the engine's thread never waits. Cost of a batch there: a
// store and a wake-up, no lock.
//
// A save that fails leaves the file as it was and ends nothing; takeFailures() reports it. If memory for a batch runs
// out, the saver's volume is incomplete. That is reported once, and nothing is saved any more.
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

#include "engine/bricks/brick_grid.hpp"
#include "engine/field/volume.hpp"
#include "engine/service/brick_content.hpp"

namespace palpate {

struct SaveFigures {
  std::vector<double> seconds;           // how long each successful save took, in order [s]
  std::uint64_t failures = 0;            // saves that failed
  std::uint64_t bytes = 0;               // size of the newest file [byte]
  std::optional<std::uint64_t> version;  // edit version in the newest file; empty: no file yet
  std::string failure;                   // why the newest save failed, in words; empty: it did not
};

class BackgroundSaver {
 public:
  // Writes the volume, which holds edit version `version`, whole or not at all. Returns the file's size [byte]. Called
  // in the saver's thread; throws on failure.
  using Write = std::function<std::uint64_t(const Volume& volume, std::uint64_t version)>;

  // `volume` outlives this. It equals the engine's volume except for the bricks that the editor lists as changed.
  BackgroundSaver(Volume& volume, Write write);
  ~BackgroundSaver();  // as close()
  BackgroundSaver(const BackgroundSaver&) = delete;
  BackgroundSaver& operator=(const BackgroundSaver&) = delete;

  // Engine's thread. Whether the last batch has been taken in and its save, if any, is done.
  [[nodiscard]] bool ready() const noexcept { return batch_.load(std::memory_order_acquire) == nullptr; }
  // Engine's thread, only when ready(). `save_version`: the batch completes this edit version, which is then saved.
  void give(std::vector<BrickContent> bricks, std::optional<std::uint64_t> save_version);

  // Engine's thread, only when ready(). Changed bricks could not be handed over, so nothing is saved any more; that is
  // reported with `why`.
  void abandon(const std::string& why);

  // Engine's thread: waits until ready(). For the end of a session.
  void wait() const noexcept;
  // Waits for a save that is under way and ends the thread; then the volume belongs to the caller again.
  void close();

  // The edit version in the newest file; empty: no file yet. Any thread, no lock.
  [[nodiscard]] std::optional<std::uint64_t> savedVersion() const noexcept {
    const std::uint64_t version = saved_version_.load(std::memory_order_acquire);
    return version == kNone ? std::nullopt : std::optional(version);
  }
  [[nodiscard]] SaveFigures figures() const;
  // The failures since the last call, each in words.
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
  std::atomic<Batch*> batch_ = nullptr;  // owned; null: the last batch is done
  bool broken_ = false;                  // the volume is incomplete; used by the giver only when ready()
  mutable std::mutex mutex_;             // guards figures_, untold_ and wordless_
  SaveFigures figures_;
  std::vector<std::string> untold_;
  bool wordless_ = false;  // a failure for whose words there was no memory
  std::atomic<bool> has_untold_ = false;
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::atomic<std::uint64_t> saved_version_ = kNone;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace palpate
