// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_history.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce = 65536;  // bricks in one Editor::replace

constexpr std::size_t kStepBytes = sizeof(std::vector<BrickContent>) + sizeof(UndoLabel);  // also without bricks

// Includes the heap's overhead for each brick's vector: at least 32 bytes, and some beside a large one.
std::size_t bytesOfBrick(std::size_t values) {
  return sizeof(BrickContent) + std::max<std::size_t>(32, values * sizeof(float) + 16);
}

std::size_t bytesOfBricks(const std::vector<BrickContent>& bricks) {
  std::size_t bytes = 0;
  for (const BrickContent& content : bricks) bytes += bytesOfBrick(content.values.size());
  return bytes;
}

bool isBefore(const BrickContent& a, const BrickContent& b) {
  return a.brick < b.brick;
}

// Those of `bricks` (ascending) that are not among `known` (ascending).
std::vector<std::uint32_t> newBricks(std::span<const std::uint32_t> bricks, const std::vector<BrickContent>& known) {
  std::vector<std::uint32_t> list;
  auto at = known.begin();
  for (const std::uint32_t brick : bricks) {
    while (at != known.end() && at->brick < brick) ++at;
    if (at == known.end() || at->brick != brick) list.push_back(brick);
  }
  return list;
}

}  // namespace

std::size_t EditHistory::bytesOf(const Step& step) {
  return kStepBytes + bytesOfBricks(step.bricks);
}

EditHistory::Contents EditHistory::contentOf(std::span<const std::uint32_t> bricks) const {
  Contents contents;
  contents.reserve(bricks.size());
  for (const std::uint32_t brick : bricks) contents.push_back(engine_->content(brick));
  return contents;
}

Engine::EditResult EditHistory::edit(std::span<const EditCommand> commands, std::int64_t now_ns, UndoStep step) {
  // If engine_->edit() throws an Error nothing has changed, and nothing changes here. Once the volume has changed
  // nothing throws, since the caller must know of the change.
  if (budget_bytes_ == 0) {  // no copies would be kept, so none are taken
    Engine::EditResult result = engine_->edit(commands, now_ns);
    ++forgotten_;
    return result;
  }
  const bool joins = step == UndoStep::kLast && done_ > 0 && done_ == steps_.size();
  bool is_kept = false;
  Contents added;  // to the last step
  const auto keep = [&](std::span<const std::uint32_t> bricks) {
    if (joins) {
      Step& last = steps_.back();
      const std::vector<std::uint32_t> more = newBricks(bricks, last.bricks);
      if (bytesOf(last) + bytesToKeep(more) - kStepBytes > budget_bytes_) return;
      added = contentOf(more);
      last.bricks.reserve(last.bricks.size() + added.size());  // so that join() needs no memory
    } else {
      if (bytesToKeep(bricks) > budget_bytes_) return;
      steps_.push_back({contentOf(bricks), {commands.empty() ? EditKind{} : commands.front().kind, 1}});
    }
    is_kept = true;
  };
  const auto keepIt = [&] { joins ? join(std::move(added)) : keepLast(); };
  Engine::EditResult result;
  try {
    result = engine_->edit(commands, now_ns, keep);
  } catch (const Error&) {
    if (is_kept && !joins) steps_.pop_back();
    throw;
  } catch (...) {  // changed or not, an undo of this step restores the volume
    if (is_kept) keepIt();
    throw;
  }
  if (is_kept) {
    keepIt();
  } else {
    forgetAll();
    ++forgotten_;
  }
  return result;
}

std::size_t EditHistory::bytesToKeep(std::span<const std::uint32_t> bricks) const {
  std::size_t bytes = kStepBytes;
  for (const std::uint32_t brick : bricks) bytes += bytesOfBrick(engine_->isStored(brick) ? kBrickVoxels : 1);
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

// What the last step's own bricks held before its first edit is known; of the others it is what they held before this.
void EditHistory::join(Contents added) noexcept {
  Step& last = steps_.back();
  bytes_ += bytesOfBricks(added);
  const auto middle = static_cast<std::ptrdiff_t>(last.bricks.size());
  std::move(added.begin(), added.end(), std::back_inserter(last.bricks));
  std::inplace_merge(last.bricks.begin(), last.bricks.begin() + middle, last.bricks.end(), isBefore);
  ++last.label.edits;
  forgetBeyondBudget();
}

std::size_t EditHistory::editsInEffect() const noexcept {
  std::size_t edits = forgotten_;
  for (std::size_t i = 0; i < done_; ++i) edits += steps_[i].label.edits;
  return edits;
}

std::vector<UndoLabel> EditHistory::labels() const {
  std::vector<UndoLabel> labels;
  labels.reserve(steps_.size());
  for (const Step& step : steps_) labels.push_back(step.label);
  return labels;
}

void EditHistory::forgetAll() noexcept {
  for (std::size_t i = 0; i < done_; ++i) forgotten_ += steps_[i].label.edits;
  steps_.clear();
  done_ = bytes_ = 0;
}

// Drops the oldest edits first. When none is left, it drops undone edits, the newest first.
void EditHistory::forgetBeyondBudget() noexcept {
  while (bytes_ > budget_bytes_ && done_ > 0) {
    bytes_ -= bytesOf(steps_.front());
    forgotten_ += steps_.front().label.edits;
    steps_.pop_front();
    --done_;
  }
  while (bytes_ > budget_bytes_ && !steps_.empty()) {
    bytes_ -= bytesOf(steps_.back());
    steps_.pop_back();
  }
}

// Puts the step's bricks in place, all or none. Then the step holds what they replaced.
Engine::EditResult EditHistory::exchange(Step& step, std::int64_t now_ns) {
  std::vector<std::uint32_t> bricks;
  for (const BrickContent& content : step.bricks) bricks.push_back(content.brick);
  Contents replaced = contentOf(bricks);
  Engine::EditResult result;
  result.version = engine_->editVersion();
  const auto part = [](const Contents& of, std::size_t first) {
    return std::span(of).subspan(first, std::min(kMostAtOnce, of.size() - first));
  };
  std::size_t first = 0;
  try {
    for (; first < step.bricks.size(); first += kMostAtOnce)
      result = engine_->replace(part(step.bricks, first), now_ns);
  } catch (...) {
    if (engine_->broken()) throw;
    // Goes back through states that existed before, so none of them needs room that is not there.
    while (first > 0) engine_->replace(part(replaced, first -= kMostAtOnce), now_ns);
    throw;
  }
  bytes_ += bytesOfBricks(replaced);
  bytes_ -= bytesOfBricks(step.bricks);
  step.bricks = std::move(replaced);
  return result;
}

std::span<const BrickContent> EditHistory::bricksToUndo() const noexcept {
  return canUndo() ? std::span<const BrickContent>(steps_[done_ - 1].bricks) : std::span<const BrickContent>();
}

std::span<const BrickContent> EditHistory::bricksToRedo() const noexcept {
  return canRedo() ? std::span<const BrickContent>(steps_[done_].bricks) : std::span<const BrickContent>();
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
