// SPDX-License-Identifier: Apache-2.0
// apps/serve/client_desk.hpp: the socket of a service: who connects is a servo or a client, and clients ask for things.
//
// What clients ask for is done in the order in which it comes, and each gets the answers to its own questions
// (service/messages). A client that breaks the rules, asks too often, does not read its answers or says nothing for
// kSilence_s at first is dropped with a word; nobody waits for it. Of more clients than there are places, idle ones go
// (client_places.hpp). More than kMostOpen questions of one client at once are refused, so memory per client is
// bounded. A servo that connects is handed to the engine, and is no client, on another connection either. One thread
// makes it and calls round() and flush().
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "apps/serve/asking_rate.hpp"
#include "apps/serve/client_places.hpp"
#include "apps/serve/questions.hpp"
#include "apps/serve/served_volume.hpp"
#include "base/waker.hpp"
#include "service/channel/channel.hpp"
#include "service/messages/message.hpp"

namespace palpate {

class ClientDesk {
 public:
  static constexpr std::size_t kMostOpen = 64;                        // questions of one client that are not answered
  static constexpr double kSilence_s = 5;                             // until the first word [s]
  static constexpr double kMostPerSecond = 2000, kMostAtOnce = 4000;  // questions of one client
  static constexpr double kMostWordsPerSecond = 5;                    // told of clients that were dropped
  using Tell = std::function<void(const std::string&)>;

  // Throws Error(kIo) where the system has no means to wake it.
  ClientDesk(Listener listener, ServedVolume& served, Tell tell);
  ClientDesk(const ClientDesk&) = delete;
  ClientDesk& operator=(const ClientDesk&) = delete;

  // One round: takes in what has come, sends answers that are ready; waits for `most_ms` at most if there is nothing
  // [ms]. False: a client asked the service to end.
  [[nodiscard]] bool round(int most_ms);
  [[nodiscard]] std::size_t clients() const noexcept { return client_count_.load(); }  // any thread
  // For the end, when the engine has ended: finishes what is under way here, and sends what is ready.
  void flush();

 private:
  struct Client {
    std::uint64_t number = 0;
    Channel channel;
    std::int64_t process = 0;
    ClientPlaces::Guest guest = {};
    bool has_spoken = false;
    bool ends = false;  // it gets no more than the answers that are under way
    std::size_t open = 0;
    AskingRate rate{kMostPerSecond, kMostAtOnce};
    std::shared_ptr<Onlooker> onlooker = {};  // null: it does not look on
  };
  struct Ready {  // an answer
    std::uint64_t client = 0;
    std::uint64_t asked = 0;
    std::optional<Error> refusal;
    std::string text;
  };

  void accept();
  // One goes whose place another needs; false: nobody is idle.
  bool makeRoom();
  [[nodiscard]] std::vector<ClientPlaces::Guest> guests() const;
  void drop(std::list<Client>::iterator client);
  // With a word of why, which the other side reads before it finds itself alone.
  static void turnAway(Channel& channel, const Error& why);
  // Of a client that is not let in or let go; those beyond kMostWordsPerSecond are only counted.
  void tellOfClient(const std::string& words);
  // False: it is to be dropped, for `why`; empty: it has left.
  [[nodiscard]] bool listenTo(Client& client, std::string& why);
  // Of a client on trial, and of a servo: whether it is answered. If not it has been told why.
  [[nodiscard]] bool mayAsk(Client& client, const wire::AskT& ask, std::int64_t sender);
  void tellThatAllPlacesAreTaken(Client& client);
  void greet(Client& client, const wire::HelloT& hello);
  void take(Client& client, const wire::AskT& ask);
  [[nodiscard]] Questions::Done answerTo(Client& client, const wire::AskT& ask);
  void askForStatus(const wire::AskT& ask, Client& client);
  void answerNow(Client& client, wire::AnswerT answer, int attached = -1);
  // Those of a client who looks on; those that wait for edits or an isovalue are answered later.
  void letLookOn(const wire::AskT& ask, Client& client);
  void letGo(Client& client);
  void sendReady();
  [[nodiscard]] std::vector<std::byte> encodedAnswer(const Ready& one);

  ServedVolume& served_;
  const Tell tell_;
  Listener listener_;
  Waker waker_;  // when an answer is ready
  std::list<Client> clients_;
  std::atomic<std::size_t> client_count_{0};  // of clients_
  std::uint64_t count_ = 0;                   // of clients so far
  std::int64_t last_turned_away_ = 0;         // process of a servo
  AskingRate words_{kMostWordsPerSecond, 20};
  std::uint64_t untold_ = 0;
  std::mutex mutex_;  // guards the next
  std::deque<Ready> ready_;
  Questions questions_;  // last member: its threads use the others
};

}  // namespace palpate
