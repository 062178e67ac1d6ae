// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/service_client.hpp"

#include <algorithm>
#include <utility>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kAskLook_ms = 50;  // how long Ctrl-C may go unseen
constexpr int kLong_ms = 5000;   // then a line says that it is waited for
static_assert(kLong_ms % kAskLook_ms == 0);

}  // namespace

ServiceClient::ServiceClient(const std::string& socket, std::string program)
    : program_(std::move(program)), channel_(connectTo(socket), "the service") {}

// One that was turned away has been told why, perhaps before it has asked.
void ServiceClient::send(wire::AskT ask) {
  try {
    channel_.send(std::move(ask));
  } catch (const Error&) {
    static_cast<void>(channel_.receive(0));  // throws what it was told
    throw;
  }
}

ServiceAnswer ServiceClient::ask(wire::Verb verb, std::vector<std::string> words, int most_ms) {
  if (std::optional<ServiceAnswer> answer = tryToAsk(verb, std::move(words), most_ms)) return std::move(*answer);
  throw Error(Error::Code::kDevice, "the service", "it does not answer",
              "look at its messages; end it, and start it again");
}

std::optional<ServiceAnswer> ServiceClient::tryToAsk(wire::Verb verb, std::vector<std::string> words, int most_ms) {
  wire::AskT ask = asking(verb);
  ask.number = ++asked_;
  ask.words = std::move(words);
  send(std::move(ask));
  for (int waited_ms = 0; waited_ms < most_ms; waited_ms += kAskLook_ms) {
    throwIfInterrupted(program_, "the service may still do what it was asked for");
    if (waited_ms == kLong_ms)
      tellUser("the service has not answered yet; Ctrl-C ends the wait, and not what was asked for");
    std::optional<MessageChannel::Received> received = channel_.receive(kAskLook_ms);
    if (!received) continue;
    const auto* const answer = contentOf<wire::AnswerT>(received->body);
    if (answer == nullptr || answer->number != asked_) continue;
    if (answer->refusal) throw errorOf(*answer->refusal);
    ServiceAnswer told{.text = answer->text, .figures = {}};
    for (const auto& figure : answer->figures)
      if (figure) told.figures.emplace_back(figure->key, figure->value);
    return told;
  }
  return {};
}

}  // namespace palpate
