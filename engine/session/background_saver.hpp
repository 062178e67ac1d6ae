// SPDX-License-Identifier: Apache-2.0
// engine/session/background_saver.hpp: writes the edited volume to disk while the session goes on.
//
// Threads: the saver's own thread owns the volume on the CPU from the constructor to close(). Nobody else may touch it
// in between. That thread runs at a lower priority than the session's threads. The engine's thread hands over the
// bricks that changed, a batch at a time. A batch may name the edit version that it completes; then that version is
// saved.
//
// One batch is under way at a time. While the saver writes a file, ready() is false and it takes no batch; changed
// bricks wait in the editor's list. So nothing queues up and the engine's thread never waits. Cost of a batch on that
// thread: a store and a wake-up, no lock.
//
// Between two batches that complete a version the volume is at no version. Whoever may have to go on from the copy
// alone keeps it whole: then a batch waits, beside the volume, for the one that completes it.
//
// If a save fails, the old file stays as it was, and saving goes on. takeFailures() reports the failure. If memory for
// a batch runs out, the saver's volume is incomplete. That is reported once, and nothing is saved any more.
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

#include "base/newest_values.hpp"
#include "engine/bricks/brick_grid.hpp"
#include "engine/field/volume.hpp"
#include "engine/service/brick_content.hpp"

namespace palpate {

struct SaveFigures {
  static constexpr std::size_t kMostTimes = std::size_t{1} << 14U;
  std::uint64_t saves = 0;               // that succeeded
  std::vector<double> seconds;           // how long the newest kMostTimes of them took, in order [s]
  std::uint64_t failures = 0;            // saves that failed
  std::uint64_t bytes = 0;               // size of the newest file [byte]
  std::optional<std::uint64_t> version;  // edit version in the newest file; empty: no file yet
  std::string failure;                   // why the newest save failed; empty: it did not
};

class BackgroundSaver {
 public:
  // Writes the volume, which is at edit version `version`, as a whole file or not at all. Returns the file's size
  // [byte]. Called in the saver's thread. Throws on failure.
  using Write = std::function<std::uint64_t(const Volume& volume, std::uint64_t version)>;
  // Anything else to be done with the whole volume at a version: a file of another name, a mesh. Called in the saver's
  // thread. What it throws is a failure like that of a save.
  using Errand = std::function<void(const Volume& volume, std::uint64_t version)>;

  // `volume` must outlive this. It equals the engine's volume except for the bricks that the editor lists as changed.
  BackgroundSaver(Volume& volume, Write write);
  ~BackgroundSaver();  // as close()
  BackgroundSaver(const BackgroundSaver&) = delete;
  BackgroundSaver& operator=(const BackgroundSaver&) = delete;

  // Engine's thread. Whether the last batch has been taken in and its save, if it had one, is done.
  [[nodiscard]] bool ready() const noexcept { return batch_.load(std::memory_order_acquire) == nullptr; }
  // Before the first batch: the volume goes from one whole version to another, and is at none in between. Memory: what
  // one version changes.
  void keepWhole() noexcept { keeps_whole_ = true; }

  // Engine's thread, only when ready().
  enum class Completes { kNothing, kVersion };
  void give(std::vector<BrickContent> bricks, Completes completes);
  // The batch completes this edit version, which is then saved.
  void give(std::vector<BrickContent> bricks, std::uint64_t save_version);
  // The same, and instead of the save this errand is done with that version.
  void give(std::vector<BrickContent> bricks, std::uint64_t version, Errand errand);

  // Engine's thread, only when ready(), of a volume that is kept whole: what no batch will complete is dropped. Until
  // the next batch the volume is the caller's. Null: it is incomplete.
  [[nodiscard]] Volume* lend() noexcept;

  // Engine's thread, only when ready(). For changed bricks that could not be handed over: reports `why` and saves
  // nothing more.
  void abandon(const std::string& why);

  // Engine's thread, at the end of a session: waits until ready().
  void wait() const noexcept;
  // Waits for a save that is under way and ends the thread. Then the volume belongs to the caller again.
  void close();

  // The edit version in the newest file; empty: no file yet. Any thread, no lock.
  [[nodiscard]] std::optional<std::uint64_t> savedVersion() const noexcept {
    const std::uint64_t version = saved_version_.load(std::memory_order_acquire);
    return version == kNone ? std::nullopt : std::optional(version);
  }
  [[nodiscard]] SaveFigures figures() const;
  // The failures since the last call, each as text.
  [[nodiscard]] std::vector<std::string> takeFailures();

 private:
  struct Batch {
    std::vector<BrickContent> bricks;
    Completes completes = Completes::kNothing;
    std::optional<std::uint64_t> save_version{};
    Errand errand{};  // empty: the usual save
    bool last = false;
  };
  void send(std::unique_ptr<Batch> batch);
  void work();
  void takeAndSave(Batch& batch) noexcept;
  void takeIn(Batch& batch);
  void save(std::uint64_t version);
  void doErrand(const Errand& errand, std::uint64_t version);
  void report(std::string text, std::string failure);
  void reportBroken(const std::string& why);

  Volume& volume_;
  Write write_;
  BrickGrid grid_;
  bool keeps_whole_ = false;
  std::vector<BrickContent> waiting_;    // for the batch that completes a version; as broken_
  std::atomic<Batch*> batch_ = nullptr;  // owned; null: the saver is idle
  bool broken_ = false;                  // the volume is incomplete; the engine's thread uses this only when ready()
  mutable std::mutex mutex_;             // guards figures_, save_s_, unreported_ and failure_without_text_
  SaveFigures figures_;
  NewestValues save_s_{SaveFigures::kMostTimes};
  std::vector<std::string> unreported_;
  bool failure_without_text_ = false;  // a failure whose text found no memory
  std::atomic<bool> has_unreported_ = false;
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::atomic<std::uint64_t> saved_version_ = kNone;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace palpate
