// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/local_servo.hpp: the servo of a rig in this process, on a thread of its own. As servo_side.hpp says.
#pragma once

#include <optional>

#include "apps/servo_side/servo_side.hpp"

namespace palpate {

class LocalServo final : public ServoSide {
 public:
  // Both outlive this.
  LocalServo(Device& device, WindowExchange& windows) noexcept : device_(device), windows_(windows) {}
  ~LocalServo() override;
  LocalServo(const LocalServo&) = delete;
  LocalServo& operator=(const LocalServo&) = delete;

  [[nodiscard]] const Device& device() const noexcept override { return device_; }
  [[nodiscard]] ToolPoseMailbox& tool() noexcept override { return tool_; }
  void makeLoop(const LoopParameters& loop, const RigSettings& settings, const RigVolume& volume,
                std::unique_ptr<Algorithm> algorithm) override;
  std::uint64_t give(ServoChange change, const RigSettings& settings) override;
  [[nodiscard]] bool ended(std::uint64_t number) const noexcept override { return changes_.ended(number); }
  [[nodiscard]] LoopResult runSimulated(const ServoLoop::Hook& before_tick) override;
  void start() override { loop_->start(); }
  [[nodiscard]] bool running() const noexcept override { return loop_->running(); }
  [[nodiscard]] LoopResult wait() override { return loop_->wait(); }
  void requestStop() noexcept override;
  void tellTicksTo(LiveTicks& live) override { loop_->tellTicksTo(live); }

 private:
  Device& device_;
  WindowExchange& windows_;
  ToolPoseMailbox tool_;
  ServoChanges changes_;
  std::unique_ptr<Algorithm> algorithm_;  // the first one
  std::optional<ServoLoop> loop_;         // uses what stands above
};

}  // namespace palpate
