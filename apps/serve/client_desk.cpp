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
  std::vector<pollfd> waits = {{listener_.descriptor(), POLLIN, 0}, {waker_.descriptor(), POLLIN, 0}};
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
    letGo(*client);
    client = clients_.erase(client);
  }
  accept();
  client_count_.store(clients_.size());
  sendReady();
  return !questions_.endIsAsked();
}

void ClientDesk::accept() {
  for (Channel channel = listener_.accept(); channel.open(); channel = listener_.accept()) {
    if (clients_.size() >= kMostClients) {
      tellOfClient(
          fmt::format("a client (process {}) is turned away: {} are here", channel.peer().process, clients_.size()));
      turnAway(channel, Error(Error::Code::kOutOfMemory, "the service",
                              fmt::format("{} clients are connected, and no more are served at once", kMostClients),
                              "end one of them, and ask again"));
      continue;
    }
    const std::int64_t process = channel.peer().process;
    clients_.push_back(
        {.number = ++count_, .channel = std::move(channel), .process = process, .since_ns = monotonicNow_ns()});
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
      take(client, *ask);
    }
  } catch (const std::exception& error) {
    why = error.what();
    return false;
  }
  const double silent_s = static_cast<double>(monotonicNow_ns() - client.since_ns) / kNanosecondsPerSecond;
  if (!client.has_spoken && silent_s > kSilence_s) why = "it says nothing";
  if (!client.channel.open()) why = "it does not read its answers";
  return why.empty();
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
