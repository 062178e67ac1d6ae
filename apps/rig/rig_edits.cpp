// SPDX-License-Identifier: Apache-2.0
#include "apps/rig/rig_edits.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {

RigEdits::RigEdits(EditSession& session, const Vec3i& size, const Lattice& lattice, Tell tell)
    : session_(session),
      outlives_its_engine_(session.keepsAbreast()),
      size_(size),
      lattice_(lattice),
      tell_(std::move(tell)) {
  noteState();  // of what the session began with
}

// Of a request: whoever asked is told what became of it, also where nobody gets to it any more.
class RigEdits::Promise {
 public:
  explicit Promise(Done done) : done_(std::move(done)) {}
  ~Promise() {
    keep(Error(Error::Code::kCancelled, "the edit", "it was not made: editing has ended", "start the program again"));
  }
  Promise(const Promise&) = delete;
  Promise& operator=(const Promise&) = delete;
  [[nodiscard]] bool isAwaited() const noexcept { return static_cast<bool>(done_); }
  void keep(const std::optional<Error>& refusal) {
    if (done_) std::exchange(done_, {})(refusal);
  }

 private:
  Done done_;
};

bool RigEdits::askFor(const char* what, Done done, std::function<void(std::int64_t now_ns)> change) {
  const auto promise = std::make_shared<Promise>(std::move(done));
  const bool asked = ask([this, what, promise, change = std::move(change)](std::int64_t now_ns) {
    in_a_stroke_ = false;
    if (tryTo(
            what, [&] { change(now_ns); }, promise.get()))
      promise->keep({});
  });
  if (!asked && counts().waiting >= kMostWaiting)
    promise->keep(Error(Error::Code::kOutOfMemory, what, "too many edits wait", "ask again when others are done"));
  return asked;
}

bool RigEdits::edit(std::vector<EditCommand> commands, Done done) {
  return askFor("an edit", std::move(done), [this, commands = std::move(commands)](std::int64_t now_ns) {
    static_cast<void>(session_.edit(commands, now_ns));
  });
}
bool RigEdits::undo(Done done) {
  return askFor("undo", std::move(done), [this](std::int64_t now_ns) { static_cast<void>(session_.undo(now_ns)); });
}
bool RigEdits::redo(Done done) {
  return askFor("redo", std::move(done), [this](std::int64_t now_ns) { static_cast<void>(session_.redo(now_ns)); });
}
bool RigEdits::goTo(std::size_t done) {
  return ask([this, done](std::int64_t now_ns) { stepTowards(done, now_ns); });
}
bool RigEdits::setBrush(const ToolBrushSpec& brush) {
  return ask([this, brush](std::int64_t) { hold(brush, Pauses::kBelongToIt); });
}
bool RigEdits::dropBrush() {
  return ask([this](std::int64_t) { brush_.reset(); }, Room::kAlways);
}
bool RigEdits::errand(BackgroundSaver::Errand errand) {
  return ask([this, errand = std::move(errand)](std::int64_t) mutable { session_.ask(std::move(errand)); });
}

void RigEdits::follow(std::vector<ScheduledBrush> brushes) {
  scheduled_.assign(brushes.begin(), brushes.end());
}

void RigEdits::hold(const std::optional<ToolBrushSpec>& brush, Pauses pauses) {
  pauses_ = pauses;
  away_since_ns_.reset();
  in_a_stroke_ = false;
  brush_.reset();
  if (brush) brush_.emplace(*brush, size_, lattice_);
}

void RigEdits::stepTowards(std::size_t done, std::int64_t now_ns) {
  brush_.reset();
  in_a_stroke_ = false;
  const EditHistory& history = session_.history();
  if (done == history.done()) return;
  const bool stepped = done < history.done() ? tryTo("undo", [&] { session_.undo(now_ns); })
                                             : tryTo("redo", [&] { session_.redo(now_ns); });
  if (!stepped || history.done() == done) return;
  const std::lock_guard lock(mutex_);
  waiting_.emplace_front([this, done](std::int64_t later_ns) { stepTowards(done, later_ns); });
}

// A busy engine looks seldom: the time between two looks, or two edits, at the surface is no pause.
bool RigEdits::endsAStroke(const ToolPose& pose, std::int64_t now_ns) {
  if (pauses_ == Pauses::kBelongToIt) return false;
  const bool was_long_away =
      away_since_ns_ && static_cast<double>(now_ns - *away_since_ns_) >= kStrokePause_s * kNanosecondsPerSecond;
  if (!pose.normal_W.isZero(0)) {
    away_since_ns_.reset();
  } else if (!away_since_ns_) {
    away_since_ns_ = now_ns;
  }
  return was_long_away;
}

void RigEdits::stroke(const ToolPose& pose, std::int64_t now_ns) {
  if (endsAStroke(pose, now_ns)) in_a_stroke_ = false;
  const std::vector<EditCommand> commands = brush_->dueStroke(pose, now_ns);
  if (commands.empty()) return;
  const UndoStep step = in_a_stroke_ ? UndoStep::kLast : UndoStep::kNew;
  if (tryTo("an edit", [&] { session_.edit(commands, now_ns, step); })) {
    in_a_stroke_ = true;
  } else {
    brush_->refused();
  }
}

bool RigEdits::ask(Request request, Room room) {
  const std::lock_guard lock(mutex_);
  if (has_ended_ || (!state_.editing && !outlives_its_engine_)) return false;
  if (waiting_.size() >= kMostWaiting && room == Room::kAsUsual) return false;
  waiting_.push_back(std::move(request));
  return true;
}

void RigEdits::goOn() {
  const std::lock_guard lock(mutex_);
  state_.editing = true;
}

void RigEdits::end() {
  std::deque<Request> given_up;  // told when the lock is free again
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  given_up.swap(waiting_);
}

RigEdits::Counts RigEdits::counts() const {
  const std::lock_guard lock(mutex_);
  Counts counts = static_cast<const Counts&>(state_);
  counts.waiting = waiting_.size();
  return counts;
}

RigEdits::State RigEdits::state() const {
  const std::lock_guard lock(mutex_);
  State state = state_;
  state.waiting = waiting_.size();
  return state;
}

RigEdits::Request RigEdits::next() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty() || !state_.editing) return {};
  Request request = std::move(waiting_.front());
  waiting_.pop_front();
  return request;
}

void RigEdits::doWaiting(std::int64_t now_ns) {
  while (const Request request = next()) request(now_ns);
  const std::lock_guard lock(mutex_);
  noteState();
}

void RigEdits::look(const ToolPose& pose, std::int64_t now_ns) {
  if (const Request request = next()) request(now_ns);
  for (; !scheduled_.empty() && pose.tick >= scheduled_.front().tick; scheduled_.pop_front())
    hold(scheduled_.front().brush, Pauses::kEndAStroke);
  if (brush_ && pose.tick >= 0) stroke(pose, now_ns);
  if (brush_ && pose.tick < 0) brush_->lift();  // no tool is there: what comes next begins where it is then
  session_.feedSaver(now_ns);
  listen();
  const std::lock_guard lock(mutex_);
  noteState();
}

void RigEdits::noteState() {
  if (state_.edits != session_.edits()) state_.steps = session_.history().labels();
  state_.done = session_.history().done();
  state_.undone = state_.steps.size() - state_.done;
  state_.forgotten = session_.history().forgotten();
  state_.edits = session_.edits();
  state_.content_version = session_.contentVersion();
}

// An edit for which there is no memory, or which is invalid at its place, is refused, and editing goes on: there may be
// memory for the next edit. Any other error is the device's, and ends the editing.
template <typename Change>
bool RigEdits::tryTo(const char* what, const Change& change, Promise* promise) {
  if (!counts().editing) return false;
  try {
    change();
    return true;
  } catch (const Error& error) {
    const bool refused = error.code() == Error::Code::kOutOfMemory || error.code() == Error::Code::kBadInput;
    std::deque<Request> given_up;  // told outside the lock
    {
      const std::lock_guard lock(mutex_);
      if (refused) {
        ++state_.refused;
      } else {
        state_.editing = false;
        if (!outlives_its_engine_) given_up.swap(waiting_);
      }
    }
    const bool is_awaited = promise != nullptr && promise->isAwaited();
    if (promise != nullptr) promise->keep(error);
    if (refused && is_awaited) return false;
    if (refused) {
      tell(fmt::format("{} was refused: {}", what, error.what()), Again::kCountOnly);
    } else {
      tell(fmt::format("editing has ended: {}", error.what()), Again::kTell);
    }
    return false;
  }
}

void RigEdits::tell(const std::string& text, Again again) {
  std::string reason;
  std::copy_if(text.begin(), text.end(), std::back_inserter(reason), [](char c) { return c < '0' || c > '9'; });
  const auto known =
      std::find_if(troubles_.begin(), troubles_.end(), [&](const Trouble& t) { return t.reason == reason; });
  if (known == troubles_.end()) {
    if (troubles_.size() < kMostTroubles) troubles_.push_back({std::move(reason), text});
  } else {
    ++known->count;
    if (again == Again::kCountOnly) return;
  }
  tell_(text);
}

void RigEdits::listen() {
  if (BackgroundSaver* saver = session_.saver(); saver != nullptr) {
    for (const std::string& failure : saver->takeFailures()) tell(failure, Again::kTell);
  }
  const JournalWriter* journal = session_.journal();
  if (journal == nullptr) return;
  if (journal->timesMended() != journal_mended_) {
    journal_mended_ = journal->timesMended();
    journal_failed_ = false;
    tell("the journal is kept again, and holds every edit made until now", Again::kTell);
  }
  if (journal_failed_ || !journal->failed()) return;
  const std::string failure = journal->failure();
  if (failure.empty()) return;  // it has just begun anew
  journal_failed_ = true;
  tell(failure, Again::kTell);
}

std::vector<std::string> RigEdits::troubles() const {
  std::vector<std::string> all;
  for (const Trouble& trouble : troubles_)
    all.push_back(trouble.count > 1 ? fmt::format("{} times, first: {}", trouble.count, trouble.text) : trouble.text);
  return all;
}

}  // namespace palpate
