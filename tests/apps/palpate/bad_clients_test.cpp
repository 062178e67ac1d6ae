// SPDX-License-Identifier: Apache-2.0
// Clients that keep others from the service, or ask for what is not theirs.
#include <cerrno>
#include <chrono>
#include <fstream>

#include <fmt/format.h>

#include "served_sphere.hpp"
#include "service/channel/channel.hpp"
#include "service/messages/message.hpp"

namespace palpate {
namespace bad_clients_test {

using testing::HasSubstr;

// Who breaks the rules by the number or the time is dropped with a word, and nobody else.
class BadClients : public ServedSphere {
 protected:
  void SetUp() override {
    serve({kServedSphere});
    ASSERT_TRUE(awaitService());
  }
  [[nodiscard]] Channel connected() const { return connectTo((file("run") / "palpate/service.sock").string()); }
  static std::vector<std::byte> question(wire::Verb verb, std::uint64_t number = 1, Words words = {}) {
    wire::AskT ask = asking(verb);
    ask.number = number;
    ask.words = std::move(words);
    return encoded(std::move(ask));
  }
  // Until its socket is closed; empty bytes: it only listens.
  [[nodiscard]] static bool isDropped(Channel& client, const std::vector<std::byte>& asks, bool reads) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      // What does not fit any more is tried again: it may be that nobody reads there just now.
      const bool sent = asks.empty() || client.send(asks, 10);
      if (!sent && errno == EPIPE) return true;
      Packet packet;
      if (reads && client.receive(packet, asks.empty() ? 100 : 0) == Channel::Got::kClosed) return true;
    }
    return false;
  }
};

TEST_F(BadClients, OneThatSaysNothing) {
  Channel client = connected();
  EXPECT_TRUE(isDropped(client, {}, true));
  EXPECT_TRUE(awaitSaid("is dropped: it says nothing")) << contentsOf(file("serve.log"));
  EXPECT_EQ(status()["clients"], 1);
}

// Those that asked once and stay. While they are not idle yet the operator and the servo are let in all the same, and
// others are told; then the idle ones make room, one for each who comes.
TEST_F(BadClients, IdleOnesKeepNobodyOut) {
  constexpr std::size_t kPlaces = 32;  // docs/service.md
  std::vector<Channel> idle;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    idle.push_back(connected());
    ASSERT_TRUE(idle.back().send(question(wire::Verb::Status), 1000));
    Packet answer;
    ASSERT_EQ(idle.back().receive(answer, 60'000), Channel::Got::kPacket);
  }
  EXPECT_EQ(status()["clients"], kPlaces + 1);
  expectRefusal(ctl({"get", "servo.n"}), "the service", "32 clients are connected, and no more are served at once", 5);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  Outcome got = ctl({"get", "servo.n"});
  while (got.status != 0 && std::chrono::steady_clock::now() < end) got = ctl({"get", "servo.n"});
  EXPECT_EQ(got.status, 0) << got.err;
  Packet last;
  ASSERT_EQ(idle.front().receive(last, 60'000), Channel::Got::kPacket);
  const std::string words(reinterpret_cast<const char*>(last.bytes.data()), last.bytes.size());
  EXPECT_THAT(words, HasSubstr("others waited for its place"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
}

TEST_F(BadClients, OneThatAsksTooOften) {
  Channel client = connected();
  // The rate itself is held in asking_rate_test.cpp; here a client must be fast enough to exceed it.
  constexpr double kWithin_s = 60;
  int asked = 0, answered = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kWithin_s);
  while (client.open() && std::chrono::steady_clock::now() < end) {
    if (asked - answered < 60 && client.send(question(wire::Verb::Status), 0)) ++asked;
    Packet packet;
    while (client.receive(packet, 0) == Channel::Got::kPacket) ++answered;
  }
  ASSERT_FALSE(client.open()) << "in " << kWithin_s << " s it asked " << asked << " times";
  EXPECT_GE(answered, 3900);
  EXPECT_TRUE(awaitSaid("is dropped: it asks more often than 2000 times a second")) << contentsOf(file("serve.log"));
}

TEST_F(BadClients, OneThatDoesNotReadItsAnswers) {
  Channel client = connected();
  EXPECT_TRUE(isDropped(client, question(wire::Verb::Get), false));
  EXPECT_TRUE(awaitSaid("is dropped: it does not read its answers")) << contentsOf(file("serve.log"));
}

TEST_F(BadClients, OneThatSaysWhatOnlyAServoMay) {
  Channel client = connected();
  ASSERT_TRUE(client.send(encoded(wire::LoopMadeT{}), 1000));
  EXPECT_TRUE(isDropped(client, {}, true));
  EXPECT_TRUE(awaitSaid("is dropped: it sent a message LoopMade where none may be")) << contentsOf(file("serve.log"));
}

// A servo has given up the right to change files; an engine that did it for it would give that right back. This process
// greets as one, and is refused from then on: on new connections, on one that it had before, and on one that it hands
// to a child.
TEST_F(BadClients, AServoAsksForNothing) {
  Channel before = connected();
  Packet packet;
  ASSERT_TRUE(before.send(question(wire::Verb::Status), 1000));
  ASSERT_EQ(before.receive(packet, 20'000), Channel::Got::kPacket);
  Channel greets = connected(), handed = connected();
  wire::HelloT hello;
  hello.commit = "another";
  ASSERT_TRUE(greets.send(encoded(std::move(hello)), 1000));
  while (greets.receive(packet, 20'000) == Channel::Got::kPacket) {
  }
  ASSERT_FALSE(greets.open()) << "it is let go, since it is of another version";
  const auto isRefused = [&](Channel& client, pid_t named, const std::function<bool()>& ask) {
    ASSERT_TRUE(ask());
    ASSERT_EQ(client.receive(packet, 20'000), Channel::Got::kPacket);
    wire::BodyUnion body = decoded(packet.bytes, "the service");
    const auto* const refusal = contentOf<wire::RefusalT>(body);
    ASSERT_NE(refusal, nullptr) << kindOf(body);
    EXPECT_EQ(refusal->reason, fmt::format("process {} is its servo, which asks for nothing", named));
    EXPECT_EQ(client.receive(packet, 20'000), Channel::Got::kClosed);
  };
  for (const wire::Verb verb : {wire::Verb::Edit, wire::Verb::Undo, wire::Verb::Save, wire::Verb::Get,
                                wire::Verb::Status, wire::Verb::LookOn, wire::Verb::Leave}) {
    Channel client = connected();
    isRefused(client, getpid(), [&] { return client.send(question(verb), 1000); });
  }
  isRefused(before, getpid(), [&] { return before.send(question(wire::Verb::Status), 1000); });
  const pid_t child = fork();
  if (child == 0) _exit(handed.send(question(wire::Verb::Undo), 1000) ? 0 : 1);
  isRefused(handed, getpid(), [&] {  // which connected, and not the child that sent
    int status = 0;
    return waitpid(child, &status, 0) == child && status == 0;
  });
  EXPECT_TRUE(awaitSaid(fmt::format("(process {}) is turned away: it is a servo", getpid())))
      << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));  // a program of its own
}

TEST_F(BadClients, OneOfAnotherProtocol) {
  Channel client = connected();
  for (const std::uint32_t protocol : {std::uint32_t{0}, kProtocol + 1}) {
    wire::AskT ask = asking(wire::Verb::Undo);
    ask.number = 7;
    ask.protocol = protocol;
    ASSERT_TRUE(client.send(encoded(std::move(ask)), 1000));
    Packet packet;
    ASSERT_EQ(client.receive(packet, 20'000), Channel::Got::kPacket);
    wire::BodyUnion body = decoded(packet.bytes, "the service");
    const auto* const answer = contentOf<wire::AnswerT>(body);
    ASSERT_TRUE(answer != nullptr && answer->refusal != nullptr);
    EXPECT_EQ(answer->number, 7U);
    EXPECT_EQ(answer->refusal->reason,
              fmt::format("its program speaks number {} of the protocol, not {}", protocol, kProtocol));
  }
}

// More questions at once than may be open are refused, each by its number; the others are answered. They come while
// the service stands still, so that no answer comes between.
TEST_F(BadClients, OneWithTooManyOpenQuestions) {
  Channel client = connected();
  engine.send(SIGSTOP);
  std::uint64_t asked = 0;
  while (asked < 200 && client.send(question(wire::Verb::Edit, asked + 1, {"add:radius=1mm:at=-12,-12,-12mm"}), 0))
    ++asked;
  engine.send(SIGCONT);
  ASSERT_GT(asked, 100U);
  std::uint64_t made = 0, refused = 0;
  for (Packet packet; made + refused < asked;) {
    ASSERT_EQ(client.receive(packet, 20'000), Channel::Got::kPacket);
    wire::BodyUnion body = decoded(packet.bytes, "the service");
    const auto* const answer = contentOf<wire::AnswerT>(body);
    ASSERT_NE(answer, nullptr);
    if (answer->refusal) {
      EXPECT_EQ(answer->refusal->reason, "64 others are not answered yet");
      ++refused;
    } else {
      ++made;
    }
  }
  EXPECT_GT(refused, 0U);
  EXPECT_GE(made, 64U);
  EXPECT_EQ(status()["edits"], made);
}

// Each hears what became of its own.
TEST_F(BadClients, ARefusalReachesTheOneWhoAsked) {
  Channel good = connected(), bad = connected();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(bad.send(question(wire::Verb::Edit, 100, {"add:radius=none"}), 1000));
    ASSERT_TRUE(good.send(question(wire::Verb::Edit, 200, {"add:radius=1mm:at=-12,-12,-12mm"}), 1000));
    for (Channel* const client : {&bad, &good}) {
      Packet packet;
      ASSERT_EQ(client->receive(packet, 20'000), Channel::Got::kPacket);
      wire::BodyUnion body = decoded(packet.bytes, "the service");
      const auto* const answer = contentOf<wire::AnswerT>(body);
      ASSERT_NE(answer, nullptr);
      EXPECT_EQ(answer->number, client == &bad ? 100U : 200U);
      EXPECT_EQ(answer->refusal != nullptr, client == &bad);
    }
  }
  EXPECT_EQ(status()["edits"], 20);
}

}  // namespace bad_clients_test
}  // namespace palpate
