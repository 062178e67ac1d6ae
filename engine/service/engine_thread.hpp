// SPDX-License-Identifier: Apache-2.0
// engine/service/engine_thread.hpp: the engine's thread while the servo runs in real time. It follows the tool and
// publishes windows. Until the servo's first tick it confirms the window that is there, if one is.
//
// If the thread fails, it no longer confirms windows. The servo then fades its force out (fault: stale window), and
// stop() rethrows the failure. One thread constructs and stops this object. In between, the Engine belongs to the
// thread inside.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

#include "engine/service/engine.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

class EngineThread {
 public:
  // Starts the thread. It calls `follow`, if given, with every pose that it reads, also with none (tick -1) until the
  // servo's first tick, which may never come; `follow` may edit, and returns whether it waits for the device and should
  // be called again soon. If the thread fails, it publishes nothing more and calls `failed`, which may not throw.
  using Follow = std::function<bool(const ToolPose& pose, std::int64_t now_ns)>;
  EngineThread(Engine& engine, ToolPoseMailbox& poses, Follow follow = {}, std::function<void()> failed = {});
  ~EngineThread();  // stops the thread; drops a failure that stop() has not rethrown
  EngineThread(const EngineThread&) = delete;
  EngineThread& operator=(const EngineThread&) = delete;

  void stop();  // waits for the thread's end; rethrows its failure
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }  // any thread
  [[nodiscard]] std::uint64_t publications() const noexcept { return publications_.load(); }

 private:
  void run();

  Engine& engine_;
  ToolPoseMailbox& poses_;
  Follow follow_;
  std::function<void()> on_failure_;
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> failed_ = false;
  std::atomic<std::uint64_t> publications_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate
