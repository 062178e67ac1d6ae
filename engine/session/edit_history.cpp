// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_history.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostAtOnce = 65536;  // bricks in one Editor::replace

std::size_t bytesOf(const std::vector<Editor::BrickContent>& step) {
  std::size_t bytes = sizeof step + step.size() * sizeof(Editor::BrickContent);  // of an edit that changes nothing, too
  for (const Editor::BrickContent& content : step) bytes += content.values.size() * sizeof(float);
  return bytes;
}

}  // namespace

EditHistory::Step EditHistory::contentOf(const std::vector<std::uint32_t>& bricks) const {
  Step step;
  step.reserve(bricks.size());
  for (const std::uint32_t brick : bricks) step.push_back(engine_.editor().content(brick));
  return step;
}

Engine::EditResult EditHistory::edit(std::span<const EditCommand> commands, std::int64_t now_ns) {
  if (budget_bytes_ == 0) {  // nothing would be kept
    ++forgotten_;
    return engine_.edit(commands, now_ns);
  }
  Step before = contentOf(engine_.editor().bricksToChange(commands));
  Engine::EditResult result = engine_.edit(commands, now_ns);  // throws with nothing changed, here neither
  while (steps_.size() > done_) {
    bytes_ -= bytesOf(steps_.back());
    steps_.pop_back();
  }
  bytes_ += bytesOf(before);
  steps_.push_back(std::move(before));
  ++done_;
  forgetBeyondBudget();
  return result;
}

void EditHistory::forgetBeyondBudget() {
  while (bytes_ > budget_bytes_ && done_ > 0) {
    bytes_ -= bytesOf(steps_.front());
    steps_.pop_front();
    --done_;
    ++forgotten_;
  }
}

// Puts the step's bricks in place and keeps in it what they replace.
Engine::EditResult EditHistory::exchange(Step& step, std::int64_t now_ns) {
  std::vector<std::uint32_t> bricks;
  for (const Editor::BrickContent& content : step) bricks.push_back(content.brick);
  Step replaced = contentOf(bricks);
  Engine::EditResult result;
  result.version = engine_.editVersion();
  for (std::size_t first = 0; first < step.size(); first += kMostAtOnce) {
    const std::size_t count = std::min(kMostAtOnce, step.size() - first);
    result = engine_.replace(std::span(step).subspan(first, count), now_ns);
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
  return result;
}

Engine::EditResult EditHistory::redo(std::int64_t now_ns) {
  if (!canRedo()) throw Error(Error::Code::kBadInput, "redo", "nothing was undone", "undo an edit first");
  Engine::EditResult result = exchange(steps_[done_], now_ns);
  ++done_;
  return result;
}

}  // namespace palpate
