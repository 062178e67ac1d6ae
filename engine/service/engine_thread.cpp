// SPDX-License-Identifier: Apache-2.0
#include "engine/service/engine_thread.hpp"

#include <chrono>
#include <utility>

#include "base/thread_names.hpp"

namespace palpate {
namespace {

// Pause between two readings of the tool. At 1 m/s the tool moves half a millimetre in it, far less than a window's
// margin.
constexpr std::chrono::microseconds kPause{500};
constexpr std::chrono::microseconds kShortPause{100};  // while `follow` waits for the device

// The servo's clock is CLOCK_MONOTONIC, which steady_clock is on Linux.
std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

EngineThread::EngineThread(Engine& engine, ToolPoseMailbox& poses, Follow follow, std::function<void()> failed)
    : engine_(engine), poses_(poses), follow_(std::move(follow)), on_failure_(std::move(failed)) {
  thread_ = std::thread([this] { run(); });
  nameThread(thread_.native_handle(), "engine");
}

EngineThread::~EngineThread() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void EngineThread::stop() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void EngineThread::run() {
  try {
    while (!stopping_.load(std::memory_order_relaxed)) {
      const ToolPose& pose = poses_.latest();
      // Before the first tick, whose thread may take long to begin, the first window is as good as it was.
      if (pose.tick < 0) {
        engine_.confirmWindow(now_ns());
      } else if (engine_.publishFor(pose, now_ns())) {
        publications_.fetch_add(1, std::memory_order_relaxed);
      }
      const bool waits = follow_ && follow_(pose, now_ns());
      std::this_thread::sleep_for(waits ? kShortPause : kPause);
    }
  } catch (...) {
    failure_ = std::current_exception();
    failed_.store(true, std::memory_order_release);
    if (on_failure_) on_failure_();
  }
}

}  // namespace palpate
