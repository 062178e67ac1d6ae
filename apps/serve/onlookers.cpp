// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/onlookers.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {

Onlooker& checkedOnlooker(const std::shared_ptr<Onlooker>& one) {
  if (!one) refuse("the question", "it is one of a client who looks on", "ask to look on first");
  return *one;
}

std::shared_ptr<Onlooker> Onlookers::add(const ViewMemory::Room& room) {
  auto one = std::make_shared<Onlooker>(room);
  const std::lock_guard lock(mutex_);
  if (list_.size() >= kMost)
    throw Error(Error::Code::kOutOfMemory, "the view", fmt::format("{} windows look on already", kMost),
                "close one of them");
  list_.push_back(one);
  return one;
}

void Onlookers::remove(const std::shared_ptr<Onlooker>& one) {
  const std::lock_guard lock(mutex_);
  std::erase(list_, one);
  if (last_ == one) last_.reset();
}

void Onlookers::show(Onlooker& one, ViewRequest wanted) {
  const std::size_t pixels =
      static_cast<std::size_t>(wanted.camera.width) * static_cast<std::size_t>(wanted.camera.height);
  if (pixels > one.memory_.room().pixels)
    refuse("the view", fmt::format("there is room for {} pixels", one.memory_.room().pixels),
           "make the window smaller");
  const std::lock_guard lock(mutex_);
  one.wanted_ = std::move(wanted);
  one.is_new_ = true;
  one.failure_.clear();
}

std::string Onlookers::failure(const Onlooker& one) const {
  const std::lock_guard lock(mutex_);
  return one.failure_;
}

bool Onlookers::waits(const Onlooker& one, std::uint64_t edit_version) {
  if (!one.wanted_) return false;
  return one.is_new_ || !one.is_whole_ || one.version_ != edit_version;
}

// The next after the one whose turn it was last, around the list; that one last.
std::shared_ptr<Onlooker> Onlookers::nextWaiting(std::uint64_t edit_version) const {
  const auto last = std::ranges::find(list_, last_);
  const auto from = last == list_.end() ? 0 : static_cast<std::size_t>(last - list_.begin()) + 1;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const std::shared_ptr<Onlooker>& one = list_[(from + i) % list_.size()];
    if (waits(*one, edit_version)) return one;
  }
  return nullptr;
}

void Onlookers::begin(LiveView& view, std::shared_ptr<Onlooker> one, std::int64_t now_ns) {
  current_ = last_ = std::move(one);
  since_ns_ = now_ns;
  has_drawn_ = false;
  showCurrent(view);
}

void Onlookers::showCurrent(LiveView& view) {
  request_ = view.show(*current_->wanted_);
  current_->is_new_ = current_->is_whole_ = false;
}

void Onlookers::hand(const ViewFrame& frame) {
  handed_ = frame.number;
  has_drawn_ = true;
  current_->is_whole_ = frame.whole;
  current_->version_ = frame.edit_version;
  current_->seen_ = current_->wanted_;
  // It has room: show() has looked.
  static_cast<void>(current_->memory_.put(frame.camera, frame.pixels, frame.edit_version, frame.fine, frame.whole));
}

// What cannot be drawn leaves what was seen before, which is kept up to date.
void Onlookers::heedFailure(LiveView& view) {
  const std::string failure = view.failure();
  if (failure.empty()) return;
  has_drawn_ = true;
  current_->failure_ = failure;
  current_->wanted_ = std::exchange(current_->seen_, std::nullopt);
  if (current_->wanted_) showCurrent(view);
}

bool Onlookers::drawOn(LiveView& view, std::uint64_t edit_version, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  if (current_ && std::ranges::find(list_, current_) == list_.end()) {
    current_.reset();
    view.rest();
  }
  if (!current_) {
    if (auto next = nextWaiting(edit_version)) begin(view, std::move(next), now_ns);
    return current_ != nullptr;
  }
  if (current_->is_new_) showCurrent(view);
  const ViewFrame& frame = view.latest();
  if (frame.request == request_ && frame.number != handed_) hand(frame);
  heedFailure(view);
  const bool waits_on = waits(*current_, edit_version);
  if (!waits_on || (has_drawn_ && now_ns - since_ns_ >= kTurn_ns)) {
    auto next = nextWaiting(edit_version);
    if (next && next != current_) begin(view, std::move(next), now_ns);
  }
  return waits(*current_, edit_version);
}

bool Onlookers::mayBeInterrupted(std::uint64_t edit_version) const {
  const std::lock_guard lock(mutex_);
  return current_ ? has_drawn_ : !nextWaiting(edit_version);
}

void Onlookers::interrupt() {
  const std::lock_guard lock(mutex_);
  current_.reset();
  handed_ = 0;
}

void Onlookers::pass(std::span<const TickRecord> ticks) {
  const std::lock_guard lock(mutex_);
  for (const auto& one : list_)
    for (const TickRecord& tick : ticks) one->ticks_.add(tick);
}

std::optional<PointerTarget> Onlookers::takeAim() {
  std::optional<PointerTarget> newest;
  const std::lock_guard lock(mutex_);
  for (const auto& one : list_) {
    const std::optional<PointerTarget> aim = one->aims_.take();
    // A pointer at rest leads nothing, though its tool would leap back.
    if (!aim || one->last_aim_ == aim->hip_W) continue;
    one->last_aim_ = aim->hip_W;
    newest = aim;
  }
  return newest;
}

}  // namespace palpate
