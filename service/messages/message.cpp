// SPDX-License-Identifier: Apache-2.0
#include "service/messages/message.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr flatbuffers::uoffset_t kDeepest = 8, kMostTables = 4096;

// The codes that a process may hand on. Another number is that of a program that knows more.
Error::Code codeOf(std::int32_t number) {
  constexpr Error::Code kCodes[] = {Error::Code::kBadInput,    Error::Code::kNotFound, Error::Code::kIo,
                                    Error::Code::kOutOfMemory, Error::Code::kDevice,   Error::Code::kCancelled};
  const auto* const known =
      std::ranges::find_if(kCodes, [&](Error::Code code) { return static_cast<std::int32_t>(code) == number; });
  return known == std::end(kCodes) ? Error::Code::kDevice : *known;
}

}  // namespace

std::vector<std::byte> encodedBody(wire::BodyUnion content) {
  wire::MessageT message;
  message.body = std::move(content);
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(wire::Message::Pack(builder, &message), wire::MessageIdentifier());
  const auto* const begin = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  return {begin, begin + builder.GetSize()};
}

wire::BodyUnion decoded(std::span<const std::byte> bytes, const std::string& from) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  flatbuffers::Verifier verifier(data, bytes.size(), kDeepest, kMostTables);
  // A buffer without an identifier is too short for the check of one.
  const bool whole = bytes.size() >= 2 * sizeof(flatbuffers::uoffset_t) && wire::VerifyMessageBuffer(verifier);
  if (!whole)
    throw Error(Error::Code::kBadInput, from, "it sent what is no message of Palpate",
                "start programs of the same version of Palpate");
  std::unique_ptr<wire::MessageT> message(wire::GetMessage(data)->UnPack());
  if (message->body.value == nullptr) {
    throw Error(Error::Code::kBadInput, from, "it sent a message of a kind that this program does not know",
                "start programs of the same version of Palpate");
  }
  return std::move(message->body);
}

std::string kindOf(const wire::BodyUnion& body) {
  return wire::EnumNameBody(body.type);
}

wire::RefusalT refusalMessage(const Error& error) {
  wire::RefusalT refusal;
  refusal.code = static_cast<std::int32_t>(error.code());
  refusal.input = error.input();
  refusal.reason = error.reason();
  refusal.remedy = error.remedy();
  return refusal;
}

Error errorOf(const wire::RefusalT& refusal) {
  return {codeOf(refusal.code), refusal.input, refusal.reason, refusal.remedy};
}

}  // namespace palpate
