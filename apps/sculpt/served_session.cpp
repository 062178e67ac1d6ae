// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/served_session.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "apps/convert/convert_job.hpp"
#include "apps/servo_side/attachments.hpp"
#include "service/messages/message.hpp"

namespace palpate {

ServedSession::ServedSession(const std::string& socket, Progress& progress) : link_(socket, progress) {
  take(link_.look().joined);
}

void ServedSession::take(std::shared_ptr<OnlookLink::Joined> joined) {
  if (joined_) {  // the pictures of another engine count from 1 again
    frame_ = frame();
    frames_before_ = frame_.number;
  }
  joined_ = std::move(joined);
  ViewMemory& memory = *joined_->memory;
  ticks_.emplace(memory.ticks(), memory.tickRing(), memory.room().ticks);
  aim_.emplace(memory.aims());
  held_.clear();  // with the service before
}

const ViewFrame& ServedSession::frame() {
  const ViewFrame& newest = joined_->memory->latest();
  if (newest.number == 0) return frame_;
  if (frames_before_ == 0) return newest;
  if (newest.number + frames_before_ != frame_.number) {
    frame_ = newest;
    frame_.number += frames_before_;
  }
  return frame_;
}

void ServedSession::aim(const PointerTarget& target) noexcept {
  if (!deviceIsHeld()) aim_->aim(target);
}

const TickRecord& ServedSession::tick() {
  TickRecord newest = ticks_->latest();
  if (makeSound(newest)) tick_ = newest;
  return tick_;
}

void ServedSession::takeTicks(std::vector<TickRecord>& records) {
  const std::size_t before = records.size();
  ticks_->take(records);
  const auto unsound = [](TickRecord& tick) { return !makeSound(tick); };
  records.erase(std::remove_if(records.begin() + static_cast<std::ptrdiff_t>(before), records.end(), unsound),
                records.end());
}

void ServedSession::press(const ToolBrushSpec& brush) {
  held_ = toolBrushText(brush);
  link_.ask(wire::Verb::Hold, {held_}, "the brush");
}

void ServedSession::release() {
  if (std::exchange(held_, {}).empty()) return;
  link_.ask(wire::Verb::Release, {}, "letting go of the brush");
}

void ServedSession::goTo(std::size_t done) {
  link_.ask(wire::Verb::GoTo, {std::to_string(done)}, "a place in the list of edits");
}

void ServedSession::save(const std::string& file) {
  const std::string whole = std::filesystem::absolute(file).lexically_normal().string();
  checkOutput({.in = volume().name, .out = whole});
  link_.ask(wire::Verb::Save, {whole}, whole, OnlookLink::Errand::kYes);
}

SculptState ServedSession::look() {
  OnlookLink::News news = link_.look();
  if (news.joined) take(std::move(news.joined));
  if (!news.is_there) held_.clear();
  Looked& looked = news.looked;
  force_off_ = looked.force_off;
  SculptState state{.edits = std::move(looked.edits),
                    .older_steps = looked.older_steps,
                    .running = news.is_there && looked.has_servo,
                    .missing_servo = news.is_there ? "no servo is connected to the service: start 'palpate servo'"
                                                   : "the service does not answer: start it again, or look at its log",
                    .can_edit = news.is_there && looked.can_edit,
                    .force_off = looked.force_off,
                    .unsaved = false,
                    .errands = news.errands,
                    .drawing_failure = std::move(looked.drawing_failure),
                    .journal_failure = std::move(looked.journal_failure),
                    .messages = std::move(news.messages)};
  return state;
}

void ServedSession::close() {
  release();
}

}  // namespace palpate
