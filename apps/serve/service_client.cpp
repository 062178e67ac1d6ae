// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/service_client.hpp"

#include <algorithm>
#include <utility>

#include "apps/console/interrupt.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kAskLook_ms = 50;  // how long Ctrl-C may go unseen

}  // namespace

ServiceClient::ServiceClient(const std::string& socket) : channel_(connectTo(socket), "the service") {}

ServiceAnswer ServiceClient::ask(wire::Verb verb, std::vector<std::string> words, int most_ms) {
  if (std::optional<ServiceAnswer> answer = tryToAsk(verb, std::move(words), most_ms)) return std::move(*answer);
  throw Error(Error::Code::kDevice, "the service", "it does not answer",
              "look at its messages; end it, and start it again");
}

std::optional<ServiceAnswer> ServiceClient::tryToAsk(wire::Verb verb, std::vector<std::string> words, int most_ms) {
  wire::AskT ask = asking(verb);
  ask.number = ++asked_;
  ask.words = std::move(words);
  channel_.send(std::move(ask));
  for (int waited_ms = 0; waited_ms < most_ms; waited_ms += kAskLook_ms) {
    throwIfInterrupted("palpate ctl", "the service may still do it");
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
