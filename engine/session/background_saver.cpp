// SPDX-License-Identifier: Apache-2.0
#include "engine/session/background_saver.hpp"

#include <exception>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

#include "base/stopwatch.hpp"
#include "base/thread_names.hpp"
#include "engine/field/brick_values.hpp"

namespace palpate {
namespace {

constexpr int kNiceness = 10;
constexpr const char* kNoMemory = "out of memory";  // short enough for a std::string to hold without the heap

std::string savedNoMore(const std::string& why) {
  return fmt::format("the volume is saved no more: the copy of it to save is incomplete ({})", why);
}

// The message of what `work` threw, never empty. Empty: it threw nothing.
template <typename Work>
std::string failureOf(const Work& work) {
  std::string words;
  try {
    work();
    return {};
  } catch (const std::exception& error) {
    words = error.what();
  } catch (...) {
  }
  return words.empty() ? "for an unknown reason" : words;
}

}  // namespace

BackgroundSaver::BackgroundSaver(Volume& volume, Write write)
    : volume_(volume), write_(std::move(write)), grid_{volume.size(), volume.lattice().spacing_m}, thread_([this] {
        work();
      }) {}

BackgroundSaver::~BackgroundSaver() {
  close();
}

void BackgroundSaver::send(std::unique_ptr<Batch> batch) {
  batch_.store(batch.release(), std::memory_order_release);
  batch_.notify_all();
}

void BackgroundSaver::give(std::vector<BrickContent> bricks, Completes completes) {
  send(std::make_unique<Batch>(Batch{std::move(bricks), completes}));
}

void BackgroundSaver::give(std::vector<BrickContent> bricks, std::uint64_t save_version) {
  send(std::make_unique<Batch>(Batch{std::move(bricks), Completes::kVersion, save_version}));
}

void BackgroundSaver::give(std::vector<BrickContent> bricks, std::uint64_t version, Errand errand) {
  send(std::make_unique<Batch>(Batch{std::move(bricks), Completes::kVersion, version, std::move(errand)}));
}

Volume* BackgroundSaver::lend() noexcept {
  waiting_.clear();
  return broken_ ? nullptr : &volume_;
}

// The thread reads broken_ when the next batch arrives, so after this write.
void BackgroundSaver::abandon(const std::string& why) {
  broken_ = true;
  reportBroken(why);
}

void BackgroundSaver::wait() const noexcept {
  for (Batch* batch = batch_.load(); batch != nullptr; batch = batch_.load()) batch_.wait(batch);
}

void BackgroundSaver::close() {
  if (!thread_.joinable()) return;
  wait();
  auto last = std::make_unique<Batch>();
  last->last = true;
  send(std::move(last));
  thread_.join();
}

void BackgroundSaver::work() {
  nameThisThread("saver");
  // On Linux this applies to the calling thread alone. If it is refused, saving only disturbs the session a little
  // more.
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kNiceness));
  for (bool last = false; !last;) {
    batch_.wait(nullptr, std::memory_order_acquire);
    const std::unique_ptr<Batch> batch(batch_.load(std::memory_order_acquire));
    if (!broken_) takeAndSave(*batch);
    last = batch->last;
    batch_.store(nullptr, std::memory_order_release);
    batch_.notify_all();
  }
}

// A copy with half a batch is the volume at no version. So it is never written.
void BackgroundSaver::takeAndSave(Batch& batch) noexcept {
  broken_ = true;
  try {
    const std::string failure = failureOf([&] { takeIn(batch); });
    if (!failure.empty()) {
      reportBroken(failure);
      return;
    }
    if (batch.errand) {
      doErrand(batch.errand, *batch.save_version);
    } else if (batch.save_version) {
      save(*batch.save_version);
    }
    broken_ = false;
  } catch (...) {  // no memory even for the text; takeFailures() makes it
    const std::lock_guard lock(mutex_);
    ++figures_.failures;
    figures_.failure = kNoMemory;
    failure_without_text_ = true;
    has_unreported_.store(true, std::memory_order_release);
  }
}

void BackgroundSaver::takeIn(Batch& batch) {
  if (keeps_whole_ && batch.completes == Completes::kNothing) {
    waiting_.insert(waiting_.end(), std::make_move_iterator(batch.bricks.begin()),
                    std::make_move_iterator(batch.bricks.end()));
    return;
  }
  const auto put = [this](const std::vector<BrickContent>& bricks) {
    for (const BrickContent& content : bricks) putBrick(volume_, grid_.brick(content.brick), content.values);
  };
  put(std::exchange(waiting_, {}));
  put(batch.bricks);
}

void BackgroundSaver::save(std::uint64_t version) {
  const Stopwatch watch;
  std::uint64_t bytes = 0;
  const std::string failure = failureOf([&] { bytes = write_(volume_, version); });
  if (!failure.empty()) {
    report(fmt::format("edit {} was not saved: {}", version, failure), failure);
    return;
  }
  const double seconds = watch.seconds();
  const std::lock_guard lock(mutex_);
  figures_.failure.clear();
  ++figures_.saves;
  save_s_.add(seconds);
  figures_.bytes = bytes;
  figures_.version = version;
  saved_version_.store(version, std::memory_order_release);
}

// Its failure is no failed save: the newest file is as it was.
void BackgroundSaver::doErrand(const Errand& errand, std::uint64_t version) {
  const std::string failure = failureOf([&] { errand(volume_, version); });
  if (failure.empty()) return;
  const std::lock_guard lock(mutex_);
  unreported_.push_back(failure);
  has_unreported_.store(true, std::memory_order_release);
}

void BackgroundSaver::reportBroken(const std::string& why) {
  report(savedNoMore(why), why);
}

void BackgroundSaver::report(std::string text, std::string failure) {
  const std::lock_guard lock(mutex_);
  figures_.failure = std::move(failure);
  ++figures_.failures;
  unreported_.push_back(std::move(text));
  has_unreported_.store(true, std::memory_order_release);
}

SaveFigures BackgroundSaver::figures() const {
  const std::lock_guard lock(mutex_);
  SaveFigures figures = figures_;
  figures.seconds = save_s_.inOrder();
  return figures;
}

std::vector<std::string> BackgroundSaver::takeFailures() {
  if (!has_unreported_.exchange(false, std::memory_order_acq_rel)) return {};
  const std::lock_guard lock(mutex_);
  if (std::exchange(failure_without_text_, false)) unreported_.push_back(savedNoMore(kNoMemory));
  return std::exchange(unreported_, {});
}

}  // namespace palpate
