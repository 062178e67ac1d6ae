// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/client_desk.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>

#include "apps/serve/asked_words.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/other_version.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

// So that an answer fits a packet, whatever was asked.
wire::AnswerT shortened(wire::AnswerT words) {
  constexpr std::size_t kMostText = 32'000, kMostPart = 4000;
  if (words.text.size() > kMostText) words.text.resize(kMostText);
  if (words.refusal) {
    for (std::string* const part : {&words.refusal->input, &words.refusal->reason, &words.refusal->remedy})
      if (part->size() > kMostPart) part->resize(kMostPart);
  }
  return words;
}

wire::AnswerT answerOf(std::uint64_t number, const std::optional<Error>& refusal, const std::string& text) {
  wire::AnswerT words;
  words.number = number;
  words.text = text;
  if (refusal) words.refusal = std::make_unique<wire::RefusalT>(refusalMessage(*refusal));
  return words;
}

}  // namespace

ClientDesk::ClientDesk(Listener listener, ServedVolume& served, Tell tell)
    : served_(served),
      tell_(std::move(tell)),
      listener_(std::move(listener)),
      waker_(listener_.path()),
      questions_(served) {}

bool ClientDesk::round(int most_ms) {
  // Who may not come in yet ends no wait.
  const bool is_full = ClientPlaces::entryOf(guests()) == ClientPlaces::Entry::kNotYet;
  std::vector<pollfd> waits = {{is_full ? -1 : listener_.descriptor(), POLLIN, 0}, {waker_.descriptor(), POLLIN, 0}};
  for (const Client& client : clients_) waits.push_back({client.channel.descriptor(), POLLIN, 0});
  static_cast<void>(poll(waits.data(), waits.size(), most_ms));
  waker_.sleepAgain();
  sendReady();
  for (auto client = clients_.begin(); client != clients_.end();) {
    std::string why;
    if (listenTo(*client, why)) {
      ++client;
      continue;
    }
    if (!why.empty())
      tellOfClient(fmt::format("client {} (process {}) is dropped: {}", client->number, client->process, why));
    const auto gone = client++;
    drop(gone);
  }
  accept();
  client_count_.store(clients_.size());
  sendReady();
  return !questions_.endIsAsked();
}

std::vector<ClientPlaces::Guest> ClientDesk::guests() const {
  std::vector<ClientPlaces::Guest> all;
  for (const Client& client : clients_) {
    all.push_back(client.guest);
    all.back().is_busy = client.open > 0 || client.onlooker != nullptr;
  }
  return all;
}

void ClientDesk::drop(std::list<Client>::iterator client) {
  letGo(*client);
  clients_.erase(client);
}

bool ClientDesk::makeRoom() {
  const std::int64_t now_ns = monotonicNow_ns();
  const auto idlest = ClientPlaces::outstayed(guests(), now_ns);
  if (!idlest) return false;
  const auto client = std::next(clients_.begin(), static_cast<std::ptrdiff_t>(*idlest));
  const double idle_s = ClientPlaces::secondsSince(client->guest.heard_ns, now_ns);
  tellOfClient(fmt::format("client {} (process {}) makes room for another: it asked nothing for {:.0f} s",
                           client->number, client->process, idle_s));
  turnAway(client->channel,
           Error(Error::Code::kDevice, "the service",
                 fmt::format("this client asked nothing for {:.0f} s, and others waited for its place", idle_s),
                 "ask again"));
  drop(client);
  return true;
}

// Who says nothing and who floods are let in a few at a time, so a round ends.
void ClientDesk::accept() {
  for (std::size_t taken = 0; taken < ClientPlaces::kPlaces; ++taken) {
    ClientPlaces::Entry entry = ClientPlaces::entryOf(guests());
    if (entry == ClientPlaces::Entry::kNotYet) return;
    Channel channel = listener_.accept();
    if (listener_.lacksDescriptors()) tellOfClient("nobody is let in: this process has no file descriptor left");
    if (!channel.open()) return;
    if (entry == ClientPlaces::Entry::kOnTrial && makeRoom()) entry = ClientPlaces::Entry::kWithAPlace;
    const std::int64_t process = channel.peer().process;
    clients_.push_back({.number = ++count_,
                        .channel = std::move(channel),
                        .process = process,
                        .guest = {.heard_ns = monotonicNow_ns(), .on_trial = entry == ClientPlaces::Entry::kOnTrial}});
  }
}

void ClientDesk::turnAway(Channel& channel, const Error& why) {
  static_cast<void>(channel.send(encoded(refusalMessage(why)), 0));
}

void ClientDesk::tellOfClient(const std::string& words) {
  if (!words_.mayAsk(monotonicNow_ns())) {
    ++untold_;
    return;
  }
  const std::uint64_t untold = std::exchange(untold_, 0);
  tell_(untold == 0 ? words : fmt::format("{} ({} more like that were not told)", words, untold));
}

bool ClientDesk::listenTo(Client& client, std::string& why) {
  try {
    for (std::size_t taken = 0; taken < kMostOpen && client.channel.open(); ++taken) {
      Packet packet;
      const Channel::Got got = client.channel.receive(packet, 0);
      if (got == Channel::Got::kClosed) return false;
      if (got == Channel::Got::kNothing) break;
      if (!client.rate.mayAsk(monotonicNow_ns())) {
        why = fmt::format("it asks more often than {:g} times a second", kMostPerSecond);
        return false;
      }
      wire::BodyUnion body = decoded(packet.bytes, "a client");
      const bool is_first = !std::exchange(client.has_spoken, true);
      if (const auto* const hello = contentOf<wire::HelloT>(body); is_first && hello != nullptr) {
        greet(client, *hello);
        return false;
      }
      const auto* const ask = contentOf<wire::AskT>(body);
      if (ask == nullptr) {
        why = fmt::format("it sent a message {} where none may be", kindOf(body));
        return false;
      }
      if (!mayAsk(client, *ask, packet.sender)) return false;
      client.guest.heard_ns = monotonicNow_ns();
      take(client, *ask);
    }
  } catch (const std::exception& error) {
    why = error.what();
    return false;
  }
  const std::int64_t now_ns = monotonicNow_ns();
  if (client.ends && client.open == 0) return false;
  ClientPlaces::Guest guest = client.guest;
  guest.is_busy = client.open > 0;
  if (ClientPlaces::trialIsOver(guest, now_ns)) {
    tellThatAllPlacesAreTaken(client);
    return false;
  }
  if (!client.has_spoken && ClientPlaces::secondsSince(client.guest.heard_ns, now_ns) > kSilence_s)
    why = "it says nothing";
  if (!client.channel.open()) why = "it does not read its answers";
  return why.empty();
}

void ClientDesk::tellThatAllPlacesAreTaken(Client& client) {
  tellOfClient(fmt::format("a client (process {}) is turned away: {} are here", client.process, ClientPlaces::kPlaces));
  turnAway(client.channel,
           Error(Error::Code::kOutOfMemory, "the service",
                 fmt::format("{} clients are connected, and no more are served at once", ClientPlaces::kPlaces),
                 "end one of them, and ask again"));
}

// Somebody may have left, or become idle, since it came.
bool ClientDesk::mayAsk(Client& client, const wire::AskT& ask, std::int64_t sender) {
  const bool sender_is_servo = served_.isServo(sender);
  if (sender_is_servo || served_.isServo(client.process)) {
    const std::int64_t servo = sender_is_servo ? sender : client.process;  // that one connected, and this one sent
    tellOfClient(fmt::format("client {} (process {}) is turned away: it is a servo", client.number, servo));
    turnAway(client.channel, Error(Error::Code::kBadInput, "the service",
                                   fmt::format("process {} is its servo, which asks for nothing", servo),
                                   "ask from a program of your own, as palpate ctl"));
    return false;
  }
  if (!client.guest.on_trial) return true;
  const bool has_room = ClientPlaces::entryOf(guests()) == ClientPlaces::Entry::kWithAPlace || makeRoom();
  if (has_room) {
    client.guest.on_trial = false;
    return true;
  }
  if (ask.verb == wire::Verb::Status || ask.verb == wire::Verb::Leave) {
    client.ends = true;
    return true;
  }
  tellThatAllPlacesAreTaken(client);
  return false;
}

// It is no client: the engine talks with it from now on.
void ClientDesk::greet(Client& client, const wire::HelloT& hello) {
  if (served_.attach(std::move(client.channel), hello)) return;
  turnAway(client.channel, Error(Error::Code::kIo, "the service", "another servo touches its volume already",
                                 "end that one, or name another service's socket with --connect"));
  // It tries again every second.
  if (std::exchange(last_turned_away_, client.process) != client.process)
    tellOfClient(fmt::format("a second servo (process {}) is turned away", client.process));
}

void ClientDesk::take(Client& client, const wire::AskT& ask) {
  if (ask.protocol != kProtocol) {
    const Error other = otherVersion(
        "the question", fmt::format("its program speaks number {} of the protocol, not {}", ask.protocol, kProtocol));
    return answerNow(client, answerOf(ask.number, other, {}));
  }
  if (ask.verb == wire::Verb::Status) return askForStatus(ask, client);
  if (ask.verb == wire::Verb::LookOn || ask.verb == wire::Verb::Look) return letLookOn(ask, client);
  const Questions::Done done = answerTo(client, ask);
  if (client.open > kMostOpen) {
    done(Error(Error::Code::kOutOfMemory, "the question", fmt::format("{} others are not answered yet", kMostOpen),
               "wait for answers"),
         {});
    return;
  }
  questions_.ask(ask, client.onlooker, done);
}

Questions::Done ClientDesk::answerTo(Client& client, const wire::AskT& ask) {
  ++client.open;
  // What memory was lacking for may be refused by who was asked, and once more by who asked.
  auto is_answered = std::make_shared<std::atomic_flag>();
  return [this, client = client.number, asked = ask.number, is_answered](const std::optional<Error>& refusal,
                                                                         const std::string& text) {
    if (is_answered->test_and_set()) return;
    {
      const std::lock_guard lock(mutex_);
      ready_.push_back({client, asked, refusal, text});
    }
    waker_.wake();
  };
}

// Nobody is waited for: a client whose socket is full has not read.
void ClientDesk::sendReady() {
  std::deque<Ready> ready;
  {
    const std::lock_guard lock(mutex_);
    ready.swap(ready_);
  }
  for (const Ready& one : ready) {
    const std::vector<std::byte> bytes = encodedAnswer(one);
    const auto client = std::ranges::find(clients_, one.client, &Client::number);
    if (client == clients_.end()) continue;
    if (client->open > 0) --client->open;
    if (!client->channel.send(bytes, 0)) client->channel.close();
  }
}

// What went wrong with one answer is no matter for the others.
std::vector<std::byte> ClientDesk::encodedAnswer(const Ready& one) {
  try {
    return encoded(shortened(answerOf(one.asked, one.refusal, one.text)));
  } catch (const std::exception& error) {
    tell_(fmt::format("an answer to client {} could not be made: {}", one.client, error.what()));
    return encoded(answerOf(
        one.asked, Error(Error::Code::kOutOfMemory, "the answer", "it could not be made", "ask for less"), {}));
  }
}

void ClientDesk::flush() {
  questions_.finish();
  sendReady();
}

void ClientDesk::askForStatus(const wire::AskT& ask, Client& client) {
  ServedStatus status = served_.status();
  status.clients = clients_.size();
  wire::AnswerT words;
  words.number = ask.number;
  for (const auto& [key, value] : figuresOf(status, monotonicNow_ns())) {
    words.figures.push_back(std::make_unique<wire::FigureT>());
    words.figures.back()->key = key;
    words.figures.back()->value = value;
  }
  words.text = status.journal_failure;
  answerNow(client, std::move(words));
}

void ClientDesk::answerNow(Client& client, wire::AnswerT answer, int attached) {
  if (!client.channel.send(encoded(std::move(answer)), 0, attached)) client.channel.close();
}

void ClientDesk::letLookOn(const wire::AskT& ask, Client& client) {
  wire::AnswerT answer;
  answer.number = ask.number;
  try {
    if (ask.verb == wire::Verb::LookOn) {
      checkWords(ask, 0, 0);
      letGo(client);
      client.onlooker = served_.lookOn();
      answer.facts = wireOf(served_.facts());
      return answerNow(client, std::move(answer), client.onlooker->descriptor());
    }
    checkWords(ask, 0, 1);
    std::optional<std::uint64_t> known;
    if (!ask.words.empty()) known = countOf(ask.words[0]);
    answer.looked = wireOf(served_.looked(checkedOnlooker(client.onlooker), known));
  } catch (const Error& error) {
    answer = answerOf(ask.number, error, {});
  }
  answerNow(client, std::move(answer));
}

void ClientDesk::letGo(Client& client) {
  if (client.onlooker) served_.leave(std::exchange(client.onlooker, nullptr));
}

}  // namespace palpate
