// SPDX-License-Identifier: Apache-2.0
// engine/service/engine_thread.hpp: the engine's thread while the servo runs in real time: it follows the tool and
// publishes.
//
// If it fails it stops confirming windows; the servo then fades its force out (stale window), and stop() throws what
// happened. Made and stopped by one thread; between the two the Engine belongs to this thread.
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
  // Starts. `follow`, if there is one, is called in the thread with every look at the tool: it may edit.
  using Follow = std::function<void(const ToolPose& pose, std::int64_t now_ns)>;
  EngineThread(Engine& engine, ToolPoseMailbox& poses, Follow follow = {});
  ~EngineThread();  // stops; whatever went wrong is lost unless stop() was called
  EngineThread(const EngineThread&) = delete;
  EngineThread& operator=(const EngineThread&) = delete;

  void stop();  // waits for the thread's end; rethrows what it died of
  [[nodiscard]] bool failed() const noexcept { return failed_.load(); }  // stop() will say of what
  [[nodiscard]] std::uint64_t publications() const noexcept { return publications_.load(); }

 private:
  void run();

  Engine& engine_;
  ToolPoseMailbox& poses_;
  Follow follow_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::uint64_t> publications_ = 0;
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate
