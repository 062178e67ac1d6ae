// SPDX-License-Identifier: Apache-2.0
// apps/onlook/onlook_link.hpp: a window's connection to a service: asks, hears how it goes, and finds it again when it
// was gone.
//
// A thread of its own sends and receives, so that nobody else waits, whatever the service does. Of views and settings
// only the newest is sent, and not before the last one is answered. What was asked for and not answered when the
// service goes is told as lost.
// Threads: one makes it and calls everything.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/onlook/onlook_messages.hpp"
#include "base/waker.hpp"
#include "service/messages/message_channel.hpp"

namespace palpate {

class OnlookLink {
 public:
  // With one engine's process, from its first answer on.
  struct Joined {
    ServedFacts facts;
    std::unique_ptr<ViewMemory> memory;
  };
  // Throws Error: as connectTo() does; kBadInput for a service of another version; what the service refuses; what
  // `progress` throws while it waits for a service that is still loading.
  OnlookLink(std::string socket, Progress& progress);
  ~OnlookLink();
  OnlookLink(const OnlookLink&) = delete;
  OnlookLink& operator=(const OnlookLink&) = delete;

  void show(const ViewRequest& wanted);
  // The service changes what differs from settings(), and nothing else.
  void change(const RigSettings& wanted);
  // What was asked for last, or is in effect.
  [[nodiscard]] RigSettings settings() const;
  // `what`: for messages, if it is refused or lost: "undo". The answer's text is told, if there is any.
  enum class Errand : std::uint8_t { kNo, kYes };  // a file that is being written
  void ask(wire::Verb verb, std::vector<std::string> words, std::string what, Errand errand = Errand::kNo);

  struct News {
    std::shared_ptr<Joined> joined;  // null: none that was not told before
    bool is_there = false;           // the service, and it answers
    Looked looked;                   // with the newest list of steps
    std::size_t errands = 0;
    std::vector<std::string> messages;
  };
  [[nodiscard]] News look();

 private:
  struct Open {  // a question that is not answered
    wire::Verb verb = wire::Verb::Look;
    std::string what;
    Errand errand = Errand::kNo;
  };
  struct Waiting {
    wire::AskT ask;
    Open open;
  };
  void run(std::unique_ptr<MessageChannel> channel);
  [[nodiscard]] std::unique_ptr<MessageChannel> join(const std::function<void()>& while_waiting);
  void talk(MessageChannel& channel);
  void sendWaiting(MessageChannel& channel);
  void send(MessageChannel& channel, wire::AskT ask, Open open);
  void enter(wire::AskT& ask, Open open);  // with the lock: gives it a number, and it is open
  void hear(const wire::AnswerT& answer);
  void lose(const std::string& why);
  [[nodiscard]] bool isOpen(wire::Verb verb) const;
  [[nodiscard]] RigSettings settingsNow() const;  // with the lock

  const std::string socket_;
  Waker waker_;  // when there is something to send, or it ends
  std::uint64_t asked_ = 0;
  std::optional<std::uint64_t> known_steps_;  // State::edits of the list that looked_ has

  mutable std::mutex mutex_;  // guards what follows
  bool ends_ = false, is_there_ = false;
  std::int64_t looked_at_ns_ = 0;  // when it was asked last how it goes
  std::map<std::uint64_t, Open> open_;
  std::deque<Waiting> waiting_;
  std::optional<ViewRequest> view_;       // to be sent
  std::optional<ViewRequest> last_view_;  // that was asked for; a service that comes anew is told
  struct Change {
    RigSettings before, wanted;
  };
  std::optional<Change> next_;  // to be sent
  std::optional<Change> sent_;  // and what is not answered
  Looked looked_;
  std::shared_ptr<Joined> joined_, untold_;
  std::vector<std::string> messages_;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
