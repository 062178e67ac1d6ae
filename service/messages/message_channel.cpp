// SPDX-License-Identifier: Apache-2.0
#include "service/messages/message_channel.hpp"

#include <fmt/format.h>

#include "base/other_version.hpp"

namespace palpate {

void MessageChannel::sendBytes(const std::vector<std::byte>& bytes, int attached, int patience_ms) {
  const std::lock_guard lock(senders_);
  if (!channel_.send(bytes, patience_ms, attached)) refuseGone();
}

std::optional<MessageChannel::Received> MessageChannel::receive(int most_ms) {
  const Channel::Got got = channel_.receive(packet_, most_ms);
  if (got == Channel::Got::kNothing) return {};
  if (got == Channel::Got::kClosed) refuseGone();
  Received received{decoded(packet_.bytes, other_), std::move(packet_.attached)};
  if (const auto* refusal = contentOf<wire::RefusalT>(received.body)) throw errorOf(*refusal);
  return received;
}

void MessageChannel::refuseGone() const {
  throw Error(Error::Code::kDevice, other_, "its process has ended, or does not listen any more",
              "look for its last message, and start again");
}

void MessageChannel::refuseSilence() const {
  throw Error(Error::Code::kDevice, other_, "its process does not answer", "end it, and start again");
}

void MessageChannel::refuseKind(const wire::BodyUnion& body) const {
  refuseOtherVersion(other_, fmt::format("it sent a message {} where none may be", kindOf(body)));
}

}  // namespace palpate
