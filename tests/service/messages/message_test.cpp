// SPDX-License-Identifier: Apache-2.0
// Messages come back as they were sent, and none takes more memory than its bytes.
#include "service/messages/message.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace message_test {

using testing::HasSubstr;

std::span<const std::byte> bytesOf(const flatbuffers::FlatBufferBuilder& builder) {
  return {reinterpret_cast<const std::byte*>(builder.GetBufferPointer()), builder.GetSize()};
}

// A question whose words all lie in one place of the message.
std::vector<std::byte> withOneWord(std::size_t length, std::size_t times) {
  flatbuffers::FlatBufferBuilder builder;
  const auto word = builder.CreateString(std::string(length, 'x'));
  const auto words = builder.CreateVector(std::vector(times, word));
  wire::AskBuilder ask(builder);
  ask.add_words(words);
  const auto body = ask.Finish();
  builder.Finish(wire::CreateMessage(builder, wire::Body::Ask, body.Union()), wire::MessageIdentifier());
  const auto bytes = bytesOf(builder);
  return {bytes.begin(), bytes.end()};
}

TEST(Message, ComesBackAsItWasSent) {
  wire::AskT ask = asking(wire::Verb::Edit);
  ask.number = 7;
  for (int i = 0; i < 1000; ++i) ask.words.push_back(std::string(static_cast<std::size_t>(i % 60), 'w'));
  ask.words.emplace_back();
  const std::vector<std::string> words = ask.words;
  wire::BodyUnion body = decoded(encoded(std::move(ask)), "a client");
  const auto* const back = contentOf<wire::AskT>(body);
  ASSERT_NE(back, nullptr);
  EXPECT_EQ(back->number, 7U);
  EXPECT_EQ(back->verb, wire::Verb::Edit);
  EXPECT_EQ(back->protocol, kProtocol);
  EXPECT_EQ(back->words, words);
}

// Each use of a shared word would be a copy of it: 60 KiB would become 200 MiB.
TEST(Message, IsNoLongerThanItsBytes) {
  EXPECT_NO_THROW(static_cast<void>(decoded(withOneWord(30'000, 1), "a client")));
  for (const auto& [length, times] : {std::pair(30'000U, 2U), std::pair(30'000U, 7000U), std::pair(100U, 5000U)}) {
    const std::vector<std::byte> bytes = withOneWord(length, times);
    EXPECT_LT(bytes.size(), 65'000U);
    EXPECT_THAT(refusalOf([&] { static_cast<void>(decoded(bytes, "a client")); }),
                HasSubstr("a client: it sent what is no message of Palpate"))
        << length << " " << times;
  }
}

// The same with tables, whose own parts are copied again and again.
TEST(Message, IsNoLongerThanItsBytesInItsParts) {
  flatbuffers::FlatBufferBuilder builder;
  const auto key = builder.CreateString(std::string(20'000, 'k'));
  wire::FigureBuilder figure(builder);
  figure.add_key(key);
  const auto figures = builder.CreateVector(std::vector(4000, figure.Finish()));
  wire::AnswerBuilder answer(builder);
  answer.add_figures(figures);
  const auto body = answer.Finish();
  builder.Finish(wire::CreateMessage(builder, wire::Body::Answer, body.Union()), wire::MessageIdentifier());
  EXPECT_THAT(refusalOf([&] { static_cast<void>(decoded(bytesOf(builder), "the service")); }),
              HasSubstr("it sent what is no message of Palpate"));
}

TEST(Message, OfAnUnknownKindIsRefused) {
  flatbuffers::FlatBufferBuilder builder;
  const auto word = builder.CreateString("x");
  builder.Finish(wire::CreateMessage(builder, static_cast<wire::Body>(250), word.Union()), wire::MessageIdentifier());
  EXPECT_THAT(refusalOf([&] { static_cast<void>(decoded(bytesOf(builder), "a client")); }),
              HasSubstr("of a kind that this program does not know"));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(decoded({}, "a client")); }), HasSubstr("no message of Palpate"));
}

}  // namespace message_test
}  // namespace palpate
