// SPDX-License-Identifier: Apache-2.0
#include "apps/onlook/onlook_link.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <poll.h>

#include "apps/servo_setup/scene_settings.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/other_version.hpp"
#include "base/thread_names.hpp"
#include "service/channel/channel.hpp"

namespace palpate {
namespace {

constexpr std::int64_t kLook_ns = 50'000'000;        // between two questions how it goes
constexpr std::int64_t kSilence_ns = 2'000'000'000;  // after which a service that does not answer counts as gone
constexpr int kPoll_ms = 20;
constexpr std::chrono::milliseconds kAgain{100};  // between two looks for a service that is gone
constexpr std::size_t kMostWaiting = 256;

// What the window asks by itself, again and again.
bool isOfTheWindow(wire::Verb verb) {
  return verb == wire::Verb::Show || verb == wire::Verb::Change || verb == wire::Verb::Look;
}

bool isSame(const SeenVolume& a, const SeenVolume& b) {
  return a.name == b.name && a.size == b.size && a.lattice.origin_W == b.lattice.origin_W &&
         a.lattice.R_WL == b.lattice.R_WL && a.lattice.spacing_m == b.lattice.spacing_m;
}

}  // namespace

OnlookLink::OnlookLink(std::string socket, Progress& progress) : socket_(std::move(socket)), waker_(socket_) {
  auto channel = join([&] { progress.stage("waiting for the service"); });
  thread_ = std::jthread([this, channel = std::move(channel)]() mutable { run(std::move(channel)); });
}

OnlookLink::~OnlookLink() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  waker_.wake();
}

void OnlookLink::show(const ViewRequest& wanted) {
  {
    const std::lock_guard lock(mutex_);
    view_ = last_view_ = wanted;
  }
  waker_.wake();
}

void OnlookLink::change(const RigSettings& wanted) {
  {
    const std::lock_guard lock(mutex_);
    next_ = {next_ ? next_->before : settingsNow(), wanted};
  }
  waker_.wake();
}

RigSettings OnlookLink::settings() const {
  const std::lock_guard lock(mutex_);
  return settingsNow();
}

RigSettings OnlookLink::settingsNow() const {
  return next_ ? next_->wanted : sent_ ? sent_->wanted : looked_.settings;
}

void OnlookLink::ask(wire::Verb verb, std::vector<std::string> words, std::string what, Errand errand) {
  {
    const std::lock_guard lock(mutex_);
    if (!is_there_ || waiting_.size() >= kMostWaiting) {
      messages_.push_back(fmt::format("{}: the service does not answer; ask again when it does", what));
      return;
    }
    Waiting one{.ask = asking(verb), .open = {verb, std::move(what), errand}};
    one.ask.words = std::move(words);
    waiting_.push_back(std::move(one));
  }
  waker_.wake();
}

OnlookLink::News OnlookLink::look() {
  const std::lock_guard lock(mutex_);
  News news{.joined = std::exchange(untold_, nullptr),
            .is_there = is_there_ && monotonicNow_ns() - looked_at_ns_ < kSilence_ns,
            .looked = looked_,
            .errands = 0,
            .messages = std::exchange(messages_, {})};
  const auto isErrand = [](const Open& one) { return one.errand == Errand::kYes; };
  for (const auto& [number, one] : open_) news.errands += isErrand(one) ? 1U : 0U;
  for (const Waiting& one : waiting_) news.errands += isErrand(one.open) ? 1U : 0U;
  return news;
}

// A service that has just been started listens, and answers when its volume is there.
std::unique_ptr<MessageChannel> OnlookLink::join(const std::function<void()>& while_waiting) {
  auto channel = std::make_unique<MessageChannel>(connectTo(socket_), "the service");
  wire::AskT ask = asking(wire::Verb::LookOn);
  ask.number = ++asked_;
  channel->send(std::move(ask));
  std::optional<MessageChannel::Received> received;
  while (!received) {
    while_waiting();
    received = channel->receive(kPoll_ms);
  }
  const auto* const answer = contentOf<wire::AnswerT>(received->body);
  if (answer == nullptr) refuseOtherVersion("the service", "it answers with a message of another kind");
  if (answer->refusal) throw errorOf(*answer->refusal);
  auto joined = std::make_shared<Joined>();
  joined->facts = factsOf(answer->facts);
  joined->memory = std::make_unique<ViewMemory>(std::move(received->attached), kOnlookRoom);
  const std::lock_guard lock(mutex_);
  if (joined_ && !isSame(joined_->facts.volume, joined->facts.volume))
    refuse(joined->facts.volume.name, fmt::format("it is served now, and not {}", joined_->facts.volume.name),
           "close this window and open another one");
  looked_.settings = joined->facts.settings;
  known_steps_.reset();
  looked_at_ns_ = monotonicNow_ns() - kLook_ns;  // soon
  joined_ = untold_ = std::move(joined);
  view_ = last_view_;
  is_there_ = true;
  return channel;
}

void OnlookLink::run(std::unique_ptr<MessageChannel> channel) {
  nameThisThread("onlook");
  const auto ends = [this] {
    const std::lock_guard lock(mutex_);
    return ends_;
  };
  const auto check = [&] {
    if (ends()) throw Error(Error::Code::kCancelled, "the service", "the window closes", "");
  };
  std::string refusal;
  while (!ends()) {
    try {
      if (!channel) {
        channel = join(check);
        refusal.clear();
        const std::lock_guard lock(mutex_);
        messages_.emplace_back("the service is back");
      }
      talk(*channel);
    } catch (const std::exception& error) {
      if (std::exchange(channel, nullptr)) {
        lose(error.what());
      } else if (const auto* const known = dynamic_cast<const Error*>(&error);
                 known != nullptr && known->code() != Error::Code::kNotFound && refusal != error.what()) {
        refusal = error.what();
        const std::lock_guard lock(mutex_);
        messages_.push_back(refusal);
      }
      if (!ends()) std::this_thread::sleep_for(kAgain);
    }
  }
}

void OnlookLink::lose(const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (ends_) return;
  is_there_ = looked_.can_edit = looked_.has_servo = false;  // as far as is known
  messages_.push_back(fmt::format("the service is gone ({}); its edits are in its journal, and it is waited for", why));
  for (const auto& [number, one] : open_) {
    if (one.errand == Errand::kYes)
      messages_.push_back(fmt::format("{}: the service went before it was written; save again", one.what));
    else if (!isOfTheWindow(one.verb))
      messages_.push_back(fmt::format("{}: the service went before it answered", one.what));
  }
  for (const Waiting& one : waiting_)
    messages_.push_back(fmt::format("{}: the service went before it was asked", one.open.what));
  open_.clear();
  waiting_.clear();
  next_.reset();
  sent_.reset();
}

bool OnlookLink::isOpen(wire::Verb verb) const {
  return std::ranges::any_of(open_, [&](const auto& one) { return one.second.verb == verb; });
}

void OnlookLink::talk(MessageChannel& channel) {
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (ends_) return;
    }
    sendWaiting(channel);
    pollfd waits[] = {{channel.descriptor(), POLLIN, 0}, {waker_.descriptor(), POLLIN, 0}};
    static_cast<void>(poll(waits, std::size(waits), kPoll_ms));
    waker_.sleepAgain();
    while (std::optional<MessageChannel::Received> received = channel.receive(0)) {
      if (const auto* const answer = contentOf<wire::AnswerT>(received->body)) hear(*answer);
    }
  }
}

void OnlookLink::send(MessageChannel& channel, wire::AskT ask, Open open) {
  {
    const std::lock_guard lock(mutex_);
    enter(ask, std::move(open));
  }
  channel.send(std::move(ask));
}

void OnlookLink::enter(wire::AskT& ask, Open open) {
  ask.number = ++asked_;
  open_.emplace(ask.number, std::move(open));
}

void OnlookLink::sendWaiting(MessageChannel& channel) {
  std::deque<Waiting> waiting;
  std::optional<ViewRequest> view;
  std::optional<Change> change;
  bool looks = false;
  {
    const std::lock_guard lock(mutex_);
    waiting.swap(waiting_);
    for (Waiting& one : waiting) enter(one.ask, std::move(one.open));  // an errand is never out of sight of look()
    if (!isOpen(wire::Verb::Show)) view = std::exchange(view_, std::nullopt);
    if (next_ && !sent_) change = sent_ = std::exchange(next_, std::nullopt);
    looks = !isOpen(wire::Verb::Look) && monotonicNow_ns() - looked_at_ns_ >= kLook_ns;
    if (looks) looked_at_ns_ = monotonicNow_ns();
  }
  for (Waiting& one : waiting) channel.send(std::move(one.ask));
  if (view) {
    wire::AskT ask = asking(wire::Verb::Show);
    ask.view = wireOf(*view);
    send(channel, std::move(ask), {wire::Verb::Show, "the view"});
  }
  if (change) {
    wire::AskT ask = asking(wire::Verb::Change);
    ask.before = wireOf(change->before);
    ask.settings = wireOf(change->wanted);
    send(channel, std::move(ask), {wire::Verb::Change, "the settings"});
  }
  if (!looks) return;
  wire::AskT ask = asking(wire::Verb::Look);
  if (known_steps_) ask.words.push_back(std::to_string(*known_steps_));
  send(channel, std::move(ask), {wire::Verb::Look, "how it goes"});
}

void OnlookLink::hear(const wire::AnswerT& answer) {
  std::optional<Looked> looked;
  if (answer.looked) looked = lookedOf(answer.looked);
  const std::lock_guard lock(mutex_);
  const auto open = open_.find(answer.number);
  if (open == open_.end()) return;
  const Open asked = std::move(open->second);
  open_.erase(open);
  if (answer.refusal) messages_.emplace_back(errorOf(*answer.refusal).what());
  if (asked.verb == wire::Verb::Change) {
    if (!answer.refusal) looked_.settings = withChanges(looked_.settings, sent_->before, sent_->wanted);
    sent_.reset();
  }
  if (asked.errand == Errand::kYes && !answer.text.empty()) messages_.push_back(answer.text);
  if (!looked) return;
  if (looked->has_steps) {
    known_steps_ = looked->edits.edits;
  } else {
    looked->edits.steps = std::move(looked_.edits.steps);
    looked->older_steps = looked_.older_steps;
  }
  looked_ = std::move(*looked);
}

}  // namespace palpate
