// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_history.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce = 65536;  // bricks in one Editor::replace

constexpr std::size_t kStepBytes = sizeof(std::vector<BrickContent>);  // also of an edit that changes nothing

// Includes the heap's overhead for each brick's vector: at least 32 bytes, and some beside a large one.
std::size_t bytesOfBrick(std::size_t values) {
  return sizeof(BrickContent) + std::max<std::size_t>(32, values * sizeof(float) + 16);
}

std::size_t bytesOf(const std::vector<BrickContent>& step) {
  std::size_t bytes = kStepBytes;
  for (const BrickContent& content : step) bytes += bytesOfBrick(content.values.size());
  return bytes;
}

}  // namespace

EditHistory::Step EditHistory::contentOf(std::span<const std::uint32_t> bricks) const {
  Step step;
  step.reserve(bricks.size());
  for (const std::uint32_t brick : bricks) step.push_back(engine_.content(brick));
  return step;
}

Engine::EditResult EditHistory::edit(std::span<const EditCommand> commands, std::int64_t now_ns) {
  // If engine_.edit() throws an Error nothing has changed, and nothing changes here. Once the volume has changed
  // nothing throws, since the caller must know of the change.
  if (budget_bytes_ == 0) {  // no copies would be kept, so none are taken
    Engine::EditResult result = engine_.edit(commands, now_ns);
    ++forgotten_;
    return result;
  }
  bool is_kept = false;
  const auto keep = [&](std::span<const std::uint32_t> bricks) {
    if (bytesToKeep(bricks) > budget_bytes_) return;
    steps_.push_back(contentOf(bricks));
    is_kept = true;
  };
  Engine::EditResult result;
  try {
    result = engine_.edit(commands, now_ns, keep);
  } catch (const Error&) {
    if (is_kept) steps_.pop_back();
    throw;
  } catch (...) {  // changed or not, an undo of this step restores the volume
    if (is_kept) keepLast();
    throw;
  }
  if (is_kept) {
    keepLast();
  } else {
    forgetAll();
    ++forgotten_;
  }
  return result;
}

std::size_t EditHistory::bytesToKeep(std::span<const std::uint32_t> bricks) const {
  std::size_t bytes = kStepBytes;
  for (const std::uint32_t brick : bricks) bytes += bytesOfBrick(engine_.isStored(brick) ? kBrickVoxels : 1);
  return bytes;
}

// Moves the newest step, the last of all, to the place of the undone steps and drops these.
void EditHistory::keepLast() noexcept {
  for (std::size_t i = done_; i + 1 < steps_.size(); ++i) bytes_ -= bytesOf(steps_[i]);
  bytes_ += bytesOf(steps_.back());
  std::swap(steps_[done_], steps_.back());
  steps_.resize(++done_);
  forgetBeyondBudget();
}

void EditHistory::forgetAll() noexcept {
  forgotten_ += done_;
  steps_.clear();
  done_ = bytes_ = 0;
}

// Drops the oldest edits first. When none is left, it drops undone edits, the newest first.
void EditHistory::forgetBeyondBudget() noexcept {
  while (bytes_ > budget_bytes_ && done_ > 0) {
    bytes_ -= bytesOf(steps_.front());
    steps_.pop_front();
    --done_;
    ++forgotten_;
  }
  while (bytes_ > budget_bytes_ && !steps_.empty()) {
    bytes_ -= bytesOf(steps_.back());
    steps_.pop_back();
  }
}

// Puts the step's bricks in place, all or none. Then the step holds what they replaced.
Engine::EditResult EditHistory::exchange(Step& step, std::int64_t now_ns) {
  std::vector<std::uint32_t> bricks;
  for (const BrickContent& content : step) bricks.push_back(content.brick);
  Step replaced = contentOf(bricks);
  Engine::EditResult result;
  result.version = engine_.editVersion();
  const auto part = [](const Step& of, std::size_t first) {
    return std::span(of).subspan(first, std::min(kMostAtOnce, of.size() - first));
  };
  std::size_t first = 0;
  try {
    for (; first < step.size(); first += kMostAtOnce) result = engine_.replace(part(step, first), now_ns);
  } catch (...) {
    if (engine_.broken()) throw;
    // Goes back through states that existed before, so none of them needs room that is not there.
    while (first > 0) engine_.replace(part(replaced, first -= kMostAtOnce), now_ns);
    throw;
  }
  bytes_ += bytesOf(replaced);
  bytes_ -= bytesOf(step);
  step = std::move(replaced);
  return result;
}

Engine::EditResult EditHistory::undo(std::int64_t now_ns) {
  if (!canUndo()) {
    throw Error(Error::Code::kBadInput, "undo", "there is no edit to undo",
                "edits from before the session, and those that the history's memory did not hold, stay");
  }
  Engine::EditResult result = exchange(steps_[done_ - 1], now_ns);
  --done_;
  forgetBeyondBudget();  // the replaced bricks may be larger than those put back
  return result;
}

Engine::EditResult EditHistory::redo(std::int64_t now_ns) {
  if (!canRedo()) throw Error(Error::Code::kBadInput, "redo", "nothing was undone", "undo an edit first");
  Engine::EditResult result = exchange(steps_[done_], now_ns);
  ++done_;
  forgetBeyondBudget();
  return result;
}

}  // namespace palpate
