// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/served_session.hpp: a volume of a running service, as a window sees, touches and edits it. As
// sculpt_side.hpp says.
//
// The service draws, keeps the journal and has the servo; here is no engine. When the service goes it is waited for,
// and what the window shows stays. Closing the window loses nothing.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/onlook/onlook_link.hpp"
#include "apps/sculpt/sculpt_side.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/loop/live_ticks.hpp"

namespace palpate {

class ServedSession final : public SculptSide {
 public:
  // Throws Error as OnlookLink does.
  ServedSession(const std::string& socket, Progress& progress);

  [[nodiscard]] const SeenVolume& volume() const noexcept override { return joined_->facts.volume; }
  [[nodiscard]] const std::string& device() const noexcept override { return joined_->facts.device; }
  [[nodiscard]] bool deviceIsHeld() const noexcept override { return joined_->facts.device_is_held; }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return force_off_; }
  [[nodiscard]] const std::vector<PlanLine>& plan() const noexcept override { return joined_->facts.plan; }
  [[nodiscard]] bool keepsJournal() const noexcept override { return joined_->facts.keeps_journal; }
  [[nodiscard]] bool canBeReplaced() const noexcept override { return false; }

  void start() override {}
  void show(const ViewRequest& wanted) override { link_.show(wanted); }
  [[nodiscard]] const ViewFrame& frame() override;
  void aim(const PointerTarget& target) noexcept override;
  [[nodiscard]] const TickRecord& tick() override;
  void takeTicks(std::vector<TickRecord>& records) override;

  void press(const ToolBrushSpec& brush) override;
  void release() override;
  [[nodiscard]] const std::string& heldBrush() const noexcept override { return held_; }
  void undo() override { link_.ask(wire::Verb::Undo, {}, "undo"); }
  void redo() override { link_.ask(wire::Verb::Redo, {}, "redo"); }
  void goTo(std::size_t done) override;

  void change(const RigSettings& settings) override { link_.change(settings); }
  [[nodiscard]] RigSettings settings() const override { return link_.settings(); }

  // The service writes the file: it needs the right to.
  void save(const std::string& file) override;
  [[nodiscard]] SculptState look() override;
  void close() override;  // what is still being written is the service's, and goes on

 private:
  void take(std::shared_ptr<OnlookLink::Joined> joined);

  OnlookLink link_;
  std::shared_ptr<OnlookLink::Joined> joined_;
  std::optional<LiveTicks> ticks_;
  std::optional<PointerAim> aim_;
  TickRecord tick_{.tick = -1};
  ViewFrame frame_;  // what was seen last of a service that went
  std::uint64_t frames_before_ = 0;
  ForceOff force_off_ = ForceOff::kNone;
  std::string held_;
};

}  // namespace palpate
