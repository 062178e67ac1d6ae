// SPDX-License-Identifier: Apache-2.0
// Whatever anybody of this user sends to a service: it neither crashes nor hangs, its volume and settings stay, the
// force in the hand stays what it is, and it keeps nothing of those who come and go.
//
// PALPATE_HOSTILE: how many messages (6000; `./dev hostile` sends 1,000,000). PALPATE_HOSTILE_SEED: of all.
// PALPATE_CONNECTIONS: how many that say little or nothing (2000; `./dev hostile` makes a tenth of the messages).
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "apps/serve/service_client.hpp"
#include "endurance_figures.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "hostile_messages.hpp"
#include "process_facts.hpp"
#include "service/memory/link_memory.hpp"
#include "service/memory/view_memory.hpp"
#include "service/messages/message_channel.hpp"
#include "service_processes.hpp"

namespace palpate {
namespace hostile_test {

// A contact at rest moves on by less and less, as planes are found anew.
constexpr double kCreep_N = 1e-6;
// Of what 300 connections and their messages have needed at once, an allocator keeps some.
constexpr double kMostGrowth = 0.2;

using Figures = std::map<std::string, double>;

class Hostile : public ServiceTest {
 protected:
  // A hand that is pressed 1 mm into a sphere, and stays there.
  void begin(const Words& more = {}) {
    write("press.csv", "time_s,x_m,y_m,z_m\n0,0,0,0.014\n0.3,0,0,0.0102\n");
    serve(Words{"phantom:sphere?size=32", "--path", "press.csv"} + more);
    join();
    ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
    honest_.emplace(socket());
    settle();
  }
  [[nodiscard]] std::string socket() const { return (file("run") / "palpate/service.sock").string(); }
  // Answered, or it hangs.
  Figures figures() {
    const ServiceAnswer answer = honest_->ask(wire::Verb::Status);
    return {answer.figures.begin(), answer.figures.end()};
  }
  // Until the pressing hand is at rest.
  void settle() {
    for (int look = 0, same = 0; look < 1200 && same < 10; ++look) {
      const double now_N = figures()["force_N"];
      same = now_N > 0.3 && std::abs(now_N - force_N_) < 1e-9 ? same + 1 : 0;
      force_N_ = now_N;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ASSERT_GT(force_N_, 0.3);
  }
  std::uint64_t content() {
    const std::string name = file("content.vdb").string();
    static_cast<void>(honest_->ask(wire::Verb::Save, {name}));
    const std::uint64_t hash = contentHash(loadVolume(name));
    std::filesystem::remove(name);
    return hash;
  }
  std::string settings() { return honest_->ask(wire::Verb::Get).text; }
  // Descriptors and threads go when those who were dropped are gone.
  [[nodiscard]] bool awaitDescriptors(std::size_t most) const {
    for (int look = 0; look < 400; ++look) {
      if (openDescriptorsOf(engine.id()) <= most) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
    return false;
  }

  void sendAll(int messages, HostileMessages& from);
  void beBadServos(int servos, HostileMessages& from);
  void lookOnBadly(int windows, HostileMessages& from);
  void writeMemory(Descriptor given, HostileMessages& from) const;

  std::optional<ServiceClient> honest_;
  double force_N_ = 0, largest_N_ = 0;
  std::uint64_t sent_ = 0, connections_ = 0;
};

// Also what is too long for a message.
bool sendAny(Channel& to, const std::vector<std::byte>& bytes, int attached) {
  if (bytes.size() <= kMostMessageBytes) return to.send(bytes, 0, attached);
  return ::send(to.descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) > 0;
}

// A process that has greeted as a servo is no client any more, and this one asks on. So servos are processes of their
// own.
bool greets(const std::vector<std::byte>& bytes) {
  try {
    wire::BodyUnion body = decoded(bytes, "anybody");
    return contentOf<wire::HelloT>(body) != nullptr;
  } catch (const Error&) {
    return false;
  }
}

// What work() returns, from 0 to 255.
int inProcessOfItsOwn(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

Descriptor connectedStream(const std::string& path) {
  Descriptor stream(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  static_cast<void>(connect(stream.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address));
  return stream;
}

void Hostile::sendAll(int messages, HostileMessages& from) {
  constexpr std::size_t kAtOnce = 12, kSilent = 10;
  struct Attacker {
    Channel channel;
    bool has_spoken = false;
  };
  std::vector<Attacker> attackers(kAtOnce);
  std::vector<Channel> silent;
  const Descriptor nothing(open("/dev/null", O_RDONLY | O_CLOEXEC));
  const std::uint64_t enough = sent_ + static_cast<std::uint64_t>(messages);
  for (int i = 0; sent_ < enough; ++i) {
    auto& [attacker, has_spoken] = attackers[from.below(kAtOnce)];
    if (!attacker.open()) {
      attacker = connectTo(socket());
      has_spoken = false;
      ++connections_;
    }
    const std::vector<std::byte> bytes = from.next();
    const int attached = from.below(50) == 0 ? nothing.get() : -1;
    if (!has_spoken && greets(bytes)) {
      const auto greet = [&] {
        Channel greeter = connectTo(socket());
        const bool is_sent = sendAny(greeter, bytes, attached);
        Packet answer;
        static_cast<void>(greeter.receive(answer, 1000));
        return is_sent ? 1 : 0;
      };
      if (inProcessOfItsOwn(greet) == 1) ++sent_;
      ++connections_;
    } else if (sendAny(attacker, bytes, attached)) {
      has_spoken = true;
      ++sent_;
    } else if (Packet answer; from.below(2) == 0 && attacker.receive(answer, 0) == Channel::Got::kPacket) {
      continue;  // it is told too much to hear; now it reads one, and asks on
    } else {
      attacker.close();
    }
    if (from.below(3000) == 0) attacker.close();  // in the middle of it all
    if (from.below(5000) == 0) {                  // some say nothing, up to what is let in
      if (silent.size() >= kSilent) silent.erase(silent.begin());
      silent.push_back(connectTo(socket()));
    }
    if (i % 500 != 0) continue;
    const Figures now = figures();
    largest_N_ = std::max(largest_N_, now.at("force_N"));
    ASSERT_EQ(now.at("edits"), 0) << "after " << i << " messages";
    ASSERT_EQ(now.at("servos"), 1) << "after " << i << " messages";
  }
}

// Whoever was given the memory may write into it what he wants, at any time.
void Hostile::writeMemory(Descriptor given, HostileMessages& from) const {
  const off_t size = lseek(given.get(), 0, SEEK_END);
  if (size <= 0) return;
  const auto bytes = static_cast<std::size_t>(size);
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, given.get(), 0);
  if (memory == MAP_FAILED) return;
  auto* const begin = static_cast<std::byte*>(memory);
  for (int i = 0; i < 2000; ++i) {
    // Mostly in the blocks at the front, where numbers are believed most easily.
    const std::size_t at = from.below(4) == 0 ? from.below(bytes) : from.below(sizeof(LinkBlock));
    begin[at] = static_cast<std::byte>(from.below(256));
  }
  munmap(memory, bytes);
}

// Windows that write into the memory that they are given whatever they want, but for where their pointer is, which may
// lead the hand.
void Hostile::lookOnBadly(int windows, HostileMessages& from) {
  int let_in = 0;
  for (int i = 0; i < windows; ++i) {
    Channel window = connectTo(socket());
    ++connections_;
    Packet packet;
    if (!window.send(encoded(asking(wire::Verb::LookOn)), 1000) ||
        window.receive(packet, 5000) != Channel::Got::kPacket)
      continue;
    ++sent_;
    if (!packet.attached) {  // others have not been let go yet
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    ++let_in;
    constexpr std::size_t bytes = std::size_t{1} << 20U;  // of far more
    void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, packet.attached.get(), 0);
    ASSERT_NE(memory, MAP_FAILED);
    auto* const begin = static_cast<std::byte*>(memory);
    constexpr std::size_t kAims = offsetof(ViewBlock, aims), kAfter = kAims + sizeof(PointerAimBlock);
    for (int n = 0; n < 1000; ++n) {
      const std::size_t at = from.below(4) == 0 ? from.below(bytes) : from.below(sizeof(ViewBlock));
      if (at < kAims || at >= kAfter) begin[at] = static_cast<std::byte>(from.below(256));
      if (n % 100 == 0 && sendAny(window, from.next(), -1)) ++sent_;
    }
    munmap(memory, bytes);
    if (i % 20 == 0) {
      ASSERT_EQ(figures().at("edits"), 0) << "after " << i << " windows";
    }
  }
  EXPECT_GT(let_in, windows / 2);
}

void Hostile::beBadServos(int servos, HostileMessages& from) {
  std::string commit = run({"--version"}).out;
  commit = commit.substr(commit.find('(') + 1);
  commit.resize(commit.find(')'));
  const auto beOne = [&](std::uint64_t seed) {
    HostileMessages its(seed);
    Channel bad = connectTo(socket());
    wire::HelloT hello;
    hello.layout = its.below(10) == 0 ? static_cast<std::uint32_t>(its.below(1000)) : kLinkLayout;
    hello.commit = its.below(10) == 0 ? "another" : commit;
    hello.first_version = its.below(2) == 0 ? ~std::uint64_t{0} - its.below(3) : its.below(3);
    hello.stays = its.below(2) == 0;
    int sent = 0;
    if (!bad.send(encoded(hello), 1000)) return sent;
    for (std::size_t left = 1 + its.below(6); left > 0 && bad.open(); --left) {
      Packet packet;
      // A right answer now and then, so that it gets further.
      if (bad.receive(packet, its.below(3) == 0 ? 0 : 50) == Channel::Got::kClosed) break;
      if (packet.attached) writeMemory(std::move(packet.attached), its);
      ++sent;
      if (!sendAny(bad, its.nextOfAServo(), -1)) break;
    }
    return sent;
  };
  for (int i = 0; i < servos; ++i) {
    const std::uint64_t seed = from.below(std::size_t{1} << 30U);
    const int sent = inProcessOfItsOwn([&] { return beOne(seed); });
    ASSERT_GE(sent, 0);
    sent_ += static_cast<std::uint64_t>(sent);
    ++connections_;
    if (i % 20 == 0) {
      ASSERT_EQ(figures().at("edits"), 0) << "after " << i << " servos";
    }
  }
}

TEST_F(Hostile, MessagesHaveNoEffect) {
  const auto seed = static_cast<std::uint64_t>(numberOf("PALPATE_HOSTILE_SEED", 1));
  const int messages = static_cast<int>(numberOf("PALPATE_HOSTILE", 6000));
  const int servos = std::max(20, messages / 1000);
  HostileMessages from(seed);
  begin();
  if (HasFatalFailure()) return;
  const auto started = std::chrono::steady_clock::now();
  const std::uint64_t content_before = content();
  const std::string settings_before = settings();
  sendAll(messages / 10, from);  // what is made once is made
  if (HasFatalFailure()) return;
  ASSERT_TRUE(awaitDescriptors(64));
  const double force_before_N = force_N_;
  const std::size_t descriptors = openDescriptorsOf(engine.id()), threads = threadsOf(engine.id());
  const double memory = ownMemory(engine.id());
  sendAll(messages - messages / 10, from);
  if (HasFatalFailure()) return;
  lookOnBadly(servos, from);
  if (HasFatalFailure()) return;
  EXPECT_TRUE(awaitDescriptors(descriptors)) << openDescriptorsOf(engine.id()) << " after " << descriptors;
  const std::size_t left_open = openDescriptorsOf(engine.id());
  EXPECT_EQ(threadsOf(engine.id()), threads);
  settle();
  EXPECT_NEAR(force_N_, force_before_N, kCreep_N);
  // A busy machine may take force away for a moment (a stall); nothing may add any.
  EXPECT_LE(largest_N_, force_before_N + kCreep_N);
  std::size_t changed = content() != content_before ? 1 : 0;
  changed += settings() != settings_before ? 1U : 0U;
  EXPECT_EQ(changed, 0U);
  const double grown = ownMemory(engine.id()) / memory - 1;

  // The servo leaves, and bad ones come in its place.
  EXPECT_EQ(WEXITSTATUS(servo.end(SIGTERM)), 0);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 0; }));
  beBadServos(servos, from);
  if (HasFatalFailure()) return;
  const bool has_crashed = engine.hasEnded();
  EXPECT_FALSE(has_crashed) << contentsOf(file("serve.log"));
  changed += content() != content_before ? 1U : 0U;
  EXPECT_EQ(changed, 0U);
  join();
  const bool is_felt_again =
      await([&](const nlohmann::json& now) { return std::abs(double(now["force_N"]) - force_before_N) < 1e-6; });
  EXPECT_TRUE(is_felt_again) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  EXPECT_NE(content(), content_before);
  expectSuccess(ctl({"undo"}));
  EXPECT_EQ(content(), content_before);

  BenchResult result =
      beginEndurance("service-hostile", run({"--version"}).out, fmt::format("./dev hostile {}", messages));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  result.rows.push_back({{"messages", static_cast<std::int64_t>(sent_)},
                         {"connections", static_cast<std::int64_t>(connections_)},
                         {"bad_servos", servos},
                         {"seed", static_cast<std::int64_t>(seed)},
                         {"seconds", seconds},
                         {"memory_grown", grown}});
  result.targets = {
      {"crashes and hangs", (has_crashed ? 1.0 : 0.0) + (is_felt_again ? 0.0 : 1.0), 0},
      {"changed voxels and settings", static_cast<double>(changed), 0},
      {"largest force beyond that of the hand at rest [N]", std::max(0.0, largest_N_ - force_before_N), kCreep_N},
      {"descriptors left open", left_open > descriptors ? static_cast<double>(left_open - descriptors) : 0, 0}};
  writeEndurance(
      result, "What hostile messages do to a service",
      "A servo presses a simulated hand on a sphere while clients of the same user send bytes that are no "
      "message, messages with changed bytes, messages where none may be, files with messages, and questions "
      "that must be refused; they do not read, say nothing, or go. Windows that look on write at random into their "
      "memory. Then the servo leaves, and programs that "
      "only say that they are one come instead, answer wrongly and write at random into the memory that they "
      "are given.",
      fmt::format("{} messages over {} connections, and {} bad servos, in {:.0f} s; the engine's own memory "
                  "grew by {:.2f} %.\n",
                  sent_, connections_, servos, seconds, 100 * grown));
}

// Dashboards that leak what they open, at both doors: more than may be there, all the time. The hand, its next servo
// and the operator get in, and nothing of them stays.
TEST_F(Hostile, IdleAndHalfOpenConnectionsKeepNobodyOut) {
  const int connections = static_cast<int>(numberOf("PALPATE_CONNECTIONS", 2000));
  constexpr std::size_t kHeld = 300;
  begin({"--metrics-socket", file("m.sock").string()});
  if (HasFatalFailure()) return;
  const auto started = std::chrono::steady_clock::now();
  const double force_before_N = force_N_;
  ASSERT_TRUE(awaitDescriptors(64));
  const std::size_t descriptors = openDescriptorsOf(engine.id()), threads = threadsOf(engine.id());
  const double memory = ownMemory(engine.id());
  const wire::AskT question = asking(wire::Verb::Status);
  std::vector<Channel> held(kHeld);
  std::vector<Descriptor> half(kHeld);
  int operators = 0;
  for (int i = 0; i < connections; ++i) {
    const std::size_t place = static_cast<std::size_t>(i) % kHeld;
    if (i % 6 == 5) {  // half a question of a browser, or none
      half[place] = connectedStream(file("m.sock").string());
      if (i % 12 == 5) static_cast<void>(::send(half[place].get(), "GET /met", 8, MSG_NOSIGNAL | MSG_DONTWAIT));
    } else {
      held[place] = connectTo(socket());
      if (i % 6 < 3) static_cast<void>(held[place].send(encoded(question), 100));
      Packet answer;
      if (i % 6 == 0) static_cast<void>(held[place].receive(answer, 100));
      if (i % 6 == 4) shutdown(held[place].descriptor(), SHUT_WR);
    }
    if (i % 500 == 0) static_cast<void>(figures());  // an honest client that asks nothing for long would be let go, too
    if (i % std::max(1, connections / 20) != 0) continue;
    ++operators;
    ASSERT_TRUE(status().is_object()) << "the operator was kept out after " << i;
    const double tick = figures()["tick"];
    ASSERT_TRUE(await([&](const nlohmann::json& now) { return now["tick"] > tick; }));
  }
  // The next servo, while as many as before sit there.
  EXPECT_EQ(WEXITSTATUS(servo.end(SIGTERM)), 0);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 0; }));
  join();
  const bool is_felt_again =
      await([&](const nlohmann::json& now) { return std::abs(double(now["force_N"]) - force_before_N) < 1e-6; });
  EXPECT_TRUE(is_felt_again) << contentsOf(file("serve.log"));
  // An edit has no place of its own: one is free once those that are idle have been let go.
  Outcome edited = ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"});
  for (int look = 0; look < 600 && edited.status != 0; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    edited = ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"});
  }
  expectSuccess(edited);
  held.clear();
  half.clear();
  const bool are_closed = awaitDescriptors(descriptors);
  EXPECT_TRUE(are_closed) << openDescriptorsOf(engine.id()) << " after " << descriptors;
  EXPECT_EQ(threadsOf(engine.id()), threads);
  const double grown = ownMemory(engine.id()) / memory - 1;
  expectSuccess(ctl({"stop"}));

  BenchResult result = beginEndurance("service-connections", run({"--version"}).out,
                                      fmt::format("./dev hostile {}", 10 * static_cast<std::int64_t>(connections)));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  result.rows.push_back({{"connections", connections},
                         {"held_at_once", static_cast<std::int64_t>(kHeld)},
                         {"operators_let_in", operators},
                         {"seconds", seconds},
                         {"memory_grown", grown}});
  result.targets = {{"servos that were kept out", is_felt_again ? 0.0 : 1.0, 0},
                    {"growth of the engine's own memory", std::max(0.0, grown), kMostGrowth},
                    {"descriptors left open", are_closed ? 0.0 : 1.0, 0}};
  for (const BenchTarget& target : result.targets) EXPECT_TRUE(target.holds()) << target.name << ": " << target.value;
  writeEndurance(
      result, "What idle and half-open connections do to a service",
      "A servo presses a simulated hand on a sphere, while connections of the same user come and stay, more "
      "at once than a service takes in: they say nothing, ask once and stay, do not read, close the way "
      "back, or send half a question for the metrics. In between an operator asks for the status, and at "
      "last the next servo, an edit and a stop come through.",
      fmt::format("{} connections, {} held at once, in {:.0f} s; {} operators of {} were let in; the engine's "
                  "own memory grew by {:.2f} %.\n",
                  connections, kHeld, seconds, operators, operators, 100 * grown));
}

// It says all that a servo says until its loop is made, and then nothing: others are served, and it is let go.
TEST_F(Hostile, AServoThatNeverBeginsHoldsNobodyUp) {
  serve({"phantom:sphere?size=32"});
  ASSERT_TRUE(awaitService());
  std::string commit = run({"--version"}).out;
  commit = commit.substr(commit.find('(') + 1);
  commit.resize(commit.find(')'));
  MessageChannel silent(connectTo(socket()), "the service");
  wire::HelloT hello;
  hello.layout = kLinkLayout;
  hello.commit = commit;
  hello.stays = true;
  silent.send(std::move(hello));
  static_cast<void>(silent.expect<wire::MakeDeviceT>(20'000));
  wire::DeviceMadeT made;
  made.name = "none";
  made.force_limit_N = 3;
  made.slew_limit_N_per_s = 1000;
  made.workspace_radius_m = 0.1;
  silent.send(std::move(made));
  static_cast<void>(silent.expect<wire::MakeLoopT>(20'000));
  silent.send(wire::LoopMadeT{});
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 1; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  expectSuccess(ctl({"render", "now.png", "--width", "64", "--height", "48"}));
  EXPECT_THAT(contentsOf(file("serve.log")), testing::Not(testing::HasSubstr("does not begin")));  // it was there
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 0; })) << contentsOf(file("serve.log"));
  EXPECT_THAT(contentsOf(file("serve.log")), testing::HasSubstr("the servo does not begin: it is let go"));
  join();
  ASSERT_TRUE(awaitServo()) << contentsOf(file("serve.log"));
}

}  // namespace hostile_test
}  // namespace palpate
