// SPDX-License-Identifier: Apache-2.0
// engine/service/engine_thread.hpp: the engine's thread while the servo runs in real time. It follows the tool and
// publishes windows.
//
// If the thread fails, it stops confirming windows. The servo then fades its force out (fault: stale window), and
// stop() rethrows the failure. One thread makes and stops it; in between, the Engine belongs to this object's thread.
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
  // Starts the thread. `follow`, if given, is called in the thread with every pose that it reads; it may edit. `failed`
  // is called there if it fails, when it publishes no more, and may not throw; stop() then rethrows the failure.
  using Follow = std::function<void(const ToolPose& pose, std::int64_t now_ns)>;
  EngineThread(Engine& engine, ToolPoseMailbox& poses, Follow follow = {}, std::function<void()> failed = {});
  ~EngineThread();  // stops the thread; drops a failure that stop() has not rethrown
  EngineThread(const EngineThread&) = delete;
  EngineThread& operator=(const EngineThread&) = delete;

  void stop();  // waits for the thread's end; rethrows its failure
  [[nodiscard]] std::uint64_t publications() const noexcept { return publications_.load(); }

 private:
  void run();

  Engine& engine_;
  ToolPoseMailbox& poses_;
  Follow follow_;
  std::function<void()> tell_failure_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::uint64_t> publications_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate
