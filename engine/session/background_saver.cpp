// SPDX-License-Identifier: Apache-2.0
#include "engine/session/background_saver.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

namespace palpate {
namespace {

constexpr int kNiceness = 10;

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

void BackgroundSaver::give(std::vector<Editor::BrickContent> bricks, std::optional<std::uint64_t> save_version) {
  send(std::make_unique<Batch>(Batch{std::move(bricks), save_version}));
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
  // Of this thread alone, as Linux has it; where it is refused the save is in the session's way a little more.
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kNiceness));
  for (bool last = false; !last;) {
    batch_.wait(nullptr, std::memory_order_acquire);
    const std::unique_ptr<Batch> batch(batch_.load(std::memory_order_acquire));
    takeIn(*batch);
    if (batch->save_version) save(*batch->save_version);
    last = batch->last;
    batch_.store(nullptr, std::memory_order_release);
    batch_.notify_all();
  }
}

void BackgroundSaver::takeIn(const Batch& batch) {
  for (const Editor::BrickContent& content : batch.bricks) {
    const Vec3i at = grid_.brick(content.brick);
    if (content.values.size() == 1) {
      volume_.setConstantBrick(at, content.values[0]);
    } else {
      volume_.setBrick(at, content.values.data());
    }
  }
}

void BackgroundSaver::save(std::uint64_t version) {
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t bytes = 0;
  std::string failure;
  try {
    bytes = write_(volume_, version);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::lock_guard lock(mutex_);
  figures_.failure = failure;
  if (failure.empty()) {
    figures_.seconds.push_back(seconds);
    figures_.bytes = bytes;
    figures_.version = version;
    return;
  }
  ++figures_.failures;
  untold_.push_back(fmt::format("edit {} was not saved: {}", version, failure));
  has_untold_.store(true, std::memory_order_release);
}

SaveFigures BackgroundSaver::figures() const {
  const std::lock_guard lock(mutex_);
  return figures_;
}

std::vector<std::string> BackgroundSaver::takeFailures() {
  if (!has_untold_.exchange(false, std::memory_order_acq_rel)) return {};
  const std::lock_guard lock(mutex_);
  return std::exchange(untold_, {});
}

}  // namespace palpate
