// SPDX-License-Identifier: Apache-2.0
// apps/serve/service_client.hpp: asks a service and waits for its answer, for `palpate ctl` and `palpate top`. One
// thread; blocks.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/messages/message_channel.hpp"

namespace palpate {

struct ServiceAnswer {
  std::string text;
  std::vector<std::pair<std::string, double>> figures;
};

class ServiceClient {
 public:
  // `program`: who asks, for the word that Ctrl-C ended it. Throws Error as connectTo() does.
  explicit ServiceClient(const std::string& socket, std::string program = "palpate ctl");

  // Throws Error: what the service refuses; kDevice if it ends or does not answer within `most_ms` [ms]; kBadInput as
  // MessageChannel does; kCancelled on Ctrl-C, when the service may still do what was asked. After 5 s without an
  // answer the user is told so.
  [[nodiscard]] ServiceAnswer ask(wire::Verb verb, std::vector<std::string> words = {}, int most_ms = 60'000);

  // The same; empty: it does not answer within `most_ms` [ms].
  [[nodiscard]] std::optional<ServiceAnswer> tryToAsk(wire::Verb verb, std::vector<std::string> words, int most_ms);

 private:
  void send(wire::AskT ask);

  const std::string program_;
  MessageChannel channel_;
  std::uint64_t asked_ = 0;
};

}  // namespace palpate
