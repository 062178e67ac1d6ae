// SPDX-License-Identifier: Apache-2.0
// service/messages/message_channel.hpp: messages over a channel, from one process of a service to another.
//
// Threads: any may send, one at a time receives. Blocks as it is told; not for the servo's thread.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "service/channel/channel.hpp"
#include "service/messages/message.hpp"

namespace palpate {

class MessageChannel {
 public:
  // `other`: who is at the other end, for messages: "the servo".
  MessageChannel(Channel channel, std::string other) : other_(std::move(other)), channel_(std::move(channel)) {}

  static constexpr int kPatience_ms = 5000;
  // Throws Error(kDevice) if the other side is gone, or does not read for so long.
  template <class Content>
  void send(Content content, int attached = -1, int patience_ms = kPatience_ms) {
    sendBytes(encoded(std::move(content)), attached, patience_ms);
  }

  struct Received {
    wire::BodyUnion body;
    Descriptor attached;
  };
  // Waits for `most_ms` at most; below 0: without an end. Empty: nothing came. Throws Error: kDevice if the other side
  // is gone, kBadInput for what is no message, and what a wire::Refusal says.
  [[nodiscard]] std::optional<Received> receive(int most_ms);

  // The next message, which must be of this kind. Throws as receive() does, and kBadInput for another one.
  template <class Content>
  [[nodiscard]] std::pair<Content, Descriptor> expect(int most_ms) {
    std::optional<Received> received = receive(most_ms);
    if (!received) refuseSilence();
    Content* const content = contentOf<Content>(received->body);
    if (content == nullptr) refuseKind(received->body);
    return {std::move(*content), std::move(received->attached)};
  }

  // Of the last message, as the kernel says; 0: not known (Channel::knowSenders()).
  [[nodiscard]] std::int64_t lastSender() const noexcept { return packet_.sender; }
  [[nodiscard]] int descriptor() const noexcept { return channel_.descriptor(); }
  // The other side then finds that this one is gone. While nobody receives.
  void close() noexcept { channel_.close(); }

 private:
  void sendBytes(const std::vector<std::byte>& bytes, int attached, int patience_ms);
  [[noreturn]] void refuseGone() const;
  [[noreturn]] void refuseSilence() const;
  [[noreturn]] void refuseKind(const wire::BodyUnion& body) const;

  std::string other_;
  std::mutex senders_;
  Channel channel_;
  Packet packet_;
};

}  // namespace palpate
