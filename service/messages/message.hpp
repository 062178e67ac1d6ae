// SPDX-License-Identifier: Apache-2.0
// service/messages/message.hpp: messages of messages.fbs as bytes and back. Any thread; allocates.
//
// FlatBuffers checks every offset, length and depth of what came before anything is read from it. Numbers and words are
// for whoever acts on them to check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <messages_generated.h>

#include "base/error.hpp"

namespace palpate {

// `content`: any table of the union Body, as "wire::StartT{}".
[[nodiscard]] std::vector<std::byte> encodedBody(wire::BodyUnion content);
template <class Content>
[[nodiscard]] std::vector<std::byte> encoded(Content content) {
  wire::BodyUnion body;
  body.Set(std::move(content));
  return encodedBody(std::move(body));
}

// Throws Error(kBadInput), which names `from`, for bytes that are no message, or one of a kind that this program does
// not know.
[[nodiscard]] wire::BodyUnion decoded(std::span<const std::byte> bytes, const std::string& from);

// Version of questions and answers. Raise it whenever the meaning of one changes.
inline constexpr std::uint32_t kProtocol = 2;
// A question of this program, still without its number and words.
[[nodiscard]] wire::AskT asking(wire::Verb verb);

// The content of a message if it is of this kind, else null.
template <class Content>
[[nodiscard]] Content* contentOf(wire::BodyUnion& body) noexcept {
  return body.type == wire::BodyUnionTraits<Content>::enum_value ? static_cast<Content*>(body.value) : nullptr;
}

// What kind of message it is, for words: "MakeLoop".
[[nodiscard]] std::string kindOf(const wire::BodyUnion& body);

// An error on its way to the process that asked.
[[nodiscard]] wire::RefusalT refusalMessage(const Error& error);
[[nodiscard]] Error errorOf(const wire::RefusalT& refusal);

}  // namespace palpate
