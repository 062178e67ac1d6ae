// SPDX-License-Identifier: Apache-2.0
#include "service/broker/broker.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <span>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/close_from.hpp"
#include "base/end_with_parent.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "service/messages/message.hpp"
#include "service/sandbox/capabilities.hpp"
#include "service/sandbox/memory_images.hpp"

namespace palpate {
namespace {

constexpr const char* kWho = "the servo's broker";
constexpr char kGreet = 'g', kOpen = 'o';
constexpr std::size_t kMostWords = 4096;  // of a request [byte]
constexpr int kOurs = 3;                  // the descriptor over there

// --- the other process ----------------------------------------------------------------------------------------------

// What it needs is this user's already: a socket of this user, and a device that this user may open.
void giveUpRights() {
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  static_cast<void>(dropCapabilities(RealTime::kGivenUp));
  static_cast<void>(refuseMemoryImages());
}

void closeAllBut(const Channel& channel) {
  const int sink = open("/dev/null", O_RDWR);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(sink, standard);
  if (sink > STDERR_FILENO) close(sink);
  dup3(channel.descriptor(), kOurs, O_CLOEXEC);
  closeFrom(kOurs + 1, Closing::kNow);
}

void answer(Channel& channel, const Broker::Tasks& tasks, const std::string& request) {
  const std::string words = request.substr(1);
  Channel reached;
  Descriptor opened;
  if (request[0] == kGreet && tasks.greet && words.size() == sizeof(std::uint64_t)) {
    std::uint64_t first_version = 0;
    std::memcpy(&first_version, words.data(), sizeof first_version);
    reached = tasks.greet(first_version);
  } else if (request[0] == kOpen && tasks.open) {
    opened = tasks.open(words);
  } else {
    throw Error(Error::Code::kBadInput, kWho, "it was asked for what it does not do", "start the servo again");
  }
  const std::byte done{0};
  static_cast<void>(channel.send({&done, 1}, -1, reached.open() ? reached.descriptor() : opened.get()));
}

[[noreturn]] void serve(const Broker::Tasks& tasks) noexcept {
  Channel channel{Descriptor(kOurs)};
  Packet packet;
  while (channel.receive(packet, -1) == Channel::Got::kPacket) {
    const std::string request(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
    try {
      if (request.size() > 1 + kMostWords) break;
      answer(channel, tasks, request);
    } catch (const Error& error) {
      if (!channel.send(encoded(refusalMessage(error)), -1)) break;
    } catch (const std::exception& failure) {
      const Error error(Error::Code::kOutOfMemory, kWho, failure.what(), "end other programs");
      if (!channel.send(encoded(refusalMessage(error)), -1)) break;
    }
  }
  _exit(0);
}

// The connection ends when nobody holds its other end any more: so this process must not hold it, whatever becomes of
// the rest. One that hangs in a task, and so hears of no end, is killed; but not where the fence of a servo's files
// holds its signals, also this one (Landlock since Linux 6.12).
[[noreturn]] void become(pid_t servo, Channel& other_end, const Channel& channel, const Broker::Tasks& tasks) noexcept {
  other_end.close();
  endWithParent(servo, SIGKILL);
  prctl(PR_SET_NAME, "palpate-broker", 0, 0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) static_cast<void>(std::signal(signal, SIG_IGN));
  closeAllBut(channel);
  giveUpRights();
  serve(tasks);
}

[[noreturn]] void refuseGone(const char* how) {
  throw Error(Error::Code::kDevice, kWho, how, "start the servo again");
}

}  // namespace

Broker::Broker(Tasks tasks, std::chrono::milliseconds patience) : patience_ms_(static_cast<int>(patience.count())) {
  auto [ours, theirs] = channelPair();
  const pid_t servo = getpid();
  process_ = fork();
  if (process_ < 0)
    throw Error(Error::Code::kOutOfMemory, kWho,
                formatted("no process can be started for it ({})", std::strerror(errno)), kFreeProcesses);
  if (process_ == 0) become(servo, ours, theirs, tasks);
  channel_ = std::move(ours);
}

Broker::~Broker() {
  channel_.close();
  constexpr int kLooks = 1000;
  for (int look = 0; look < kLooks && waitpid(process_, nullptr, WNOHANG) == 0; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

Channel Broker::greet(std::uint64_t first_version) {
  std::string words(sizeof first_version, '\0');
  std::memcpy(words.data(), &first_version, sizeof first_version);
  return Channel(ask(kGreet, words));
}

Descriptor Broker::open(const std::string& path) {
  return ask(kOpen, path);
}

Descriptor Broker::ask(char kind, const std::string& words) {
  if (words.size() > kMostWords)
    throw Error(Error::Code::kBadInput, kWho, formatted("{} bytes are no path", words.size()), "name a shorter one");
  const std::string request = kind + words;
  const std::lock_guard lock(mutex_);
  Packet packet;
  Channel::Got got = Channel::Got::kClosed;
  if (channel_.send(std::as_bytes(std::span(request)), patience_ms_)) got = channel_.receive(packet, patience_ms_);
  // An answer that came later would be taken for that of another question.
  if (got != Channel::Got::kPacket) {
    channel_.close();
    is_gone_ = true;
  }
  if (got == Channel::Got::kClosed) refuseGone("its process has ended");
  if (got == Channel::Got::kNothing) refuseGone("its process does not answer");
  if (packet.attached) return std::move(packet.attached);
  wire::BodyUnion body = decoded(packet.bytes, kWho);
  if (const auto* const refusal = contentOf<wire::RefusalT>(body)) throw errorOf(*refusal);
  refuseGone("its process does not hand over what it opened");
}

}  // namespace palpate
