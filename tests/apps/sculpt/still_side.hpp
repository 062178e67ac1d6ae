// SPDX-License-Identifier: Apache-2.0
// tests/apps/sculpt/still_side.hpp: a session that shows what its members hold and does nothing. A test overrides what
// it looks at.
#pragma once

#include <string>
#include <vector>

#include "apps/sculpt/sculpt_side.hpp"

namespace palpate {

class StillSide : public SculptSide {
 public:
  [[nodiscard]] const SeenVolume& volume() const noexcept override { return volume_; }
  [[nodiscard]] const std::string& device() const noexcept override { return none_; }
  [[nodiscard]] bool deviceIsHeld() const noexcept override { return false; }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return ForceOff::kNone; }
  [[nodiscard]] const std::vector<PlanLine>& plan() const noexcept override { return plan_; }
  [[nodiscard]] bool keepsJournal() const noexcept override { return true; }
  void start() override {}
  void show(const ViewRequest&) override {}
  [[nodiscard]] const ViewFrame& frame() override { return frame_; }
  void aim(const PointerTarget&) noexcept override {}
  [[nodiscard]] const TickRecord& tick() override { return tick_; }
  void takeTicks(std::vector<TickRecord>&) override {}
  void press(const ToolBrushSpec&) override {}
  void release() override {}
  [[nodiscard]] const std::string& heldBrush() const noexcept override { return none_; }
  void undo() override {}
  void redo() override {}
  void goTo(std::size_t) override {}
  void change(const RigSettings&) override {}
  [[nodiscard]] RigSettings settings() const override { return {}; }
  void save(const std::string&) override {}
  [[nodiscard]] SculptState look() override { return {}; }
  void close() override {}

 protected:
  SeenVolume volume_;
  ViewFrame frame_;
  TickRecord tick_{.tick = -1};

 private:
  std::string none_;
  std::vector<PlanLine> plan_;
};

}  // namespace palpate
