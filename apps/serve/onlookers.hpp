// SPDX-License-Identifier: Apache-2.0
// apps/serve/onlookers.hpp: clients who look on: each has a picture of its own, sees every tick of the servo, and may
// lead the tool with a pointer (service/memory/view_memory.hpp).
//
// The engine draws one picture at a time, so they take turns: an onlooker's turn lasts until its picture is whole, or
// for kTurn_ns if others wait; one picture alone is kept up to date by parts. The pointer that moved last leads the
// tool.
// Threads: add(), remove(), show() and failure() by any; the rest by the engine's.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/rig/live_view.hpp"
#include "apps/serve/brush_holders.hpp"
#include "service/memory/view_memory.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/loop/live_ticks.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

class Onlooker : public BrushHand {
 public:
  explicit Onlooker(const ViewMemory::Room& room)
      : memory_(room), ticks_(memory_.ticks(), memory_.tickRing(), memory_.room().ticks), aims_(memory_.aims()) {}
  [[nodiscard]] int descriptor() const noexcept { return memory_.descriptor(); }  // of the memory; stays this object's

 private:
  friend class Onlookers;
  ViewMemory memory_;
  LiveTicks ticks_;
  PointerTargets aims_;
  std::optional<Vec3> last_aim_;  // where its pointer was
  // Guarded by the list's lock:
  std::optional<ViewRequest> wanted_, seen_;  // the newest request, and the newest that could be drawn
  bool is_new_ = false;                       // it was not shown yet
  std::string failure_;
  bool is_whole_ = false;  // its newest picture, of what was wanted
  std::uint64_t version_ = 0;
};

// Throws Error(kBadInput) for a client that does not look on, which is null.
Onlooker& checkedOnlooker(const std::shared_ptr<Onlooker>& one);

class Onlookers {
 public:
  static constexpr std::size_t kMost = 4;
  static constexpr std::int64_t kTurn_ns = 100'000'000;

  // Throws Error(kOutOfMemory) if kMost are here, and as ViewMemory does.
  [[nodiscard]] std::shared_ptr<Onlooker> add(const ViewMemory::Room& room);
  void remove(const std::shared_ptr<Onlooker>& one);
  // What it sees from now on. Throws Error(kBadInput) if there is no room for so many pixels.
  void show(Onlooker& one, ViewRequest wanted);
  // Why its picture is not the one that was asked for last, but the one before; empty: it is, or is on its way.
  [[nodiscard]] std::string failure(const Onlooker& one) const;

  // At every look at the tool, after that of the view, which nobody else uses: hands out pictures with the edits up to
  // `edit_version`. Whether there is more to draw.
  bool drawOn(LiveView& view, std::uint64_t edit_version, std::int64_t now_ns);
  // Whether somebody else may use the view: not before somebody who waits has had a turn.
  [[nodiscard]] bool mayBeInterrupted(std::uint64_t edit_version) const;
  // Somebody else uses the view, or it is another one.
  void interrupt();
  void pass(std::span<const TickRecord> ticks);
  // Where a pointer leads the tool, if one has moved since the last call.
  [[nodiscard]] std::optional<PointerTarget> takeAim();

 private:
  [[nodiscard]] static bool waits(const Onlooker& one, std::uint64_t edit_version);
  [[nodiscard]] std::shared_ptr<Onlooker> nextWaiting(std::uint64_t edit_version) const;
  void begin(LiveView& view, std::shared_ptr<Onlooker> one, std::int64_t now_ns);
  void showCurrent(LiveView& view);
  void hand(const ViewFrame& frame);
  void heedFailure(LiveView& view);

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Onlooker>> list_;
  std::shared_ptr<Onlooker> current_;  // whose picture the view draws; null: none
  std::shared_ptr<Onlooker> last_;     // whose turn it was last
  std::uint64_t request_ = 0;          // its number in the view
  std::uint64_t handed_ = 0;           // number of the view's last frame that was handed out
  std::int64_t since_ns_ = 0;          // of the turn
  bool has_drawn_ = false;             // in this turn
};

}  // namespace palpate
