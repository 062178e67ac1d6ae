// SPDX-License-Identifier: Apache-2.0
#include "service/messages/message.hpp"

#include <algorithm>

#include <flatbuffers/minireflect.h>

#include "base/other_version.hpp"

namespace palpate {
namespace {

constexpr flatbuffers::uoffset_t kDeepest = 8, kMostTables = 4096;

// Places in a buffer may name the same string or vector again and again, which takes hardly any bytes there and its
// full size in each copy. A program of ours never writes that. So all that is copied together is no longer than the
// buffer.
class Copied final : public flatbuffers::IterationVisitor {
 public:
  explicit Copied(std::size_t most) : left_(most) {}
  struct TooMuch {};
  void String(const flatbuffers::String* text) override { spend(text->size()); }
  void Element(std::size_t, flatbuffers::ElementaryType type, const flatbuffers::TypeTable* table,
               const std::uint8_t*) override {
    spend(flatbuffers::InlineSize(type, table));
  }

 private:
  void spend(std::size_t bytes) {
    if (bytes > left_) throw TooMuch{};
    left_ -= bytes;
  }
  std::size_t left_;
};

bool isCopiedOnce(const std::uint8_t* data, std::size_t bytes) {
  const wire::Body kind = wire::GetMessage(data)->body_type();
  if (kind == wire::Body::NONE || kind > wire::Body::MAX) return true;  // nothing of it is copied
  Copied copied(bytes);
  try {
    flatbuffers::IterateFlatBuffer(data, wire::MessageTypeTable(), &copied);
  } catch (const Copied::TooMuch&) {
    return false;
  }
  return true;
}

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
  const bool whole = bytes.size() >= 2 * sizeof(flatbuffers::uoffset_t) && wire::VerifyMessageBuffer(verifier) &&
                     isCopiedOnce(data, bytes.size());
  if (!whole) refuseOtherVersion(from, "it sent what is no message of Palpate");
  std::unique_ptr<wire::MessageT> message(wire::GetMessage(data)->UnPack());
  if (message->body.value == nullptr) {
    refuseOtherVersion(from, "it sent a message of a kind that this program does not know");
  }
  return std::move(message->body);
}

wire::AskT asking(wire::Verb verb) {
  wire::AskT ask;
  ask.verb = verb;
  ask.protocol = kProtocol;
  return ask;
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
