// SPDX-License-Identifier: Apache-2.0
#include "service/channel/channel.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/monotonic_clock.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

// A socket counts as writable to poll(2) only when most of what was sent is read, so it is tried again meanwhile.
constexpr int kLook_ms = 2;
constexpr int kWaiting = 16;      // connections that nobody has accepted yet
constexpr int kMostAttached = 4;  // that one message can bring; more than one ends the connection

bool waitFor(int socket, short event, int most_ms) {
  pollfd wait{.fd = socket, .events = event, .revents = 0};
  const auto end = Clock::now() + std::chrono::milliseconds(std::max(0, most_ms));
  int found = poll(&wait, 1, most_ms);
  while (found < 0 && errno == EINTR) {  // a signal is no answer
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    found = poll(&wait, 1, most_ms < 0 ? -1 : static_cast<int>(std::max<std::int64_t>(0, left)));
  }
  return found > 0;
}

[[noreturn]] void refuseSocket(const std::string& path, Error::Code code, const std::string& why,
                               const std::string& what) {
  throw Error(code, path, why, what);
}

sockaddr_un addressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    refuseSocket(path, Error::Code::kBadInput,
                 formatted("a socket's path has 1 to {} bytes, not {}", sizeof address.sun_path - 1, path.size()),
                 "name a shorter one");
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

Descriptor newSocket(const std::string& path, Listener::Kind kind) {
  const int type = kind == Listener::Kind::kStream ? SOCK_STREAM : SOCK_SEQPACKET;
  Descriptor socket(::socket(AF_UNIX, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket)
    refuseSocket(path, Error::Code::kIo, formatted("no socket can be made ({})", std::strerror(errno)),
                 kFreeDescriptors);
  return socket;
}

int connectSocket(const Descriptor& socket, const sockaddr_un& address) {
  return connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
}

// The descriptors that came with a message, all of them, so that none stays open.
std::vector<Descriptor> attachedTo(msghdr& message) {
  std::vector<Descriptor> all;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(part) + i * sizeof(int), sizeof number);
      all.emplace_back(number);
    }
  }
  return all;
}

std::int64_t senderOf(msghdr& message) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_CREDENTIALS) continue;
    ucred facts{};
    std::memcpy(&facts, CMSG_DATA(part), sizeof facts);
    return facts.pid;
  }
  return 0;
}

// Locked where that is possible, so that of two who find a dead socket there, neither removes what the other has put in
// its place. A folder needs no file for the lock, which would stay behind.
Descriptor lockedFolder(const std::string& path, int most_ms) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  Descriptor opened(open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened && errno != EACCES)
    refuseSocket(path, Error::Code::kIo, formatted("no socket can be made there ({})", std::strerror(errno)),
                 "make its folder, or name another place");
  if (!opened) return opened;  // one may make a socket there, but not look
  const auto end = Clock::now() + std::chrono::milliseconds(most_ms);
  while (flock(opened.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno != EWOULDBLOCK) return opened;  // a file system without locks
    if (Clock::now() >= end)
      refuseSocket(path, Error::Code::kIo, "somebody keeps its folder locked", "name a place in a folder of your own");
    std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
  }
  return opened;
}

}  // namespace

bool Channel::send(std::span<const std::byte> bytes, int most_ms, int attached) {
  if (bytes.empty() || bytes.size() > kMostMessageBytes) {
    throw Error(Error::Code::kBadInput, "message",
                formatted("{} bytes are no message; it has 1 to {}", bytes.size(), kMostMessageBytes),
                "send what is long in shared memory");
  }
  if (!socket_) return false;
  iovec part{.iov_base = const_cast<std::byte*>(bytes.data()), .iov_len = bytes.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (attached >= 0) {
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* const head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(head), &attached, sizeof attached);
  }
  const auto end = Clock::now() + std::chrono::milliseconds(std::max(0, most_ms));
  while (sendmsg(socket_.get(), &message, MSG_NOSIGNAL) < 0) {
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    if (most_ms >= 0 && left.count() <= 0) return false;
    const int look_ms = most_ms < 0 ? kLook_ms : static_cast<int>(std::min<std::int64_t>(kLook_ms, left.count()));
    static_cast<void>(waitFor(socket_.get(), POLLOUT, look_ms));
  }
  return true;
}

Channel::Got Channel::receive(Packet& packet, int most_ms) {
  packet.attached.close();
  packet.bytes.resize(kMostMessageBytes);
  if (!socket_) return Got::kClosed;
  iovec part{.iov_base = packet.bytes.data(), .iov_len = packet.bytes.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostAttached * sizeof(int)) + CMSG_SPACE(sizeof(ucred))> control{};
  bool was_reset = false;
  while (true) {
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = recvmsg(socket_.get(), &message, MSG_CMSG_CLOEXEC);
    if (count < 0 && errno == EINTR) continue;
    // The other side ended without reading all; what it said before is still there.
    if (count < 0 && errno == ECONNRESET && !std::exchange(was_reset, true)) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      if (most_ms == 0 || !waitFor(socket_.get(), POLLIN, most_ms)) return Got::kNothing;
      most_ms = 0;
      continue;
    }
    std::vector<Descriptor> attached = attachedTo(message);
    const bool whole = (message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) == 0;
    if (count <= 0 || !whole || attached.size() > 1) {
      close();
      return Got::kClosed;
    }
    packet.bytes.resize(static_cast<std::size_t>(count));
    if (!attached.empty()) packet.attached = std::move(attached.front());
    packet.sender = senderOf(message);
    return Got::kPacket;
  }
}

void Channel::knowSenders() const noexcept {
  const int yes = 1;
  setsockopt(socket_.get(), SOL_SOCKET, SO_PASSCRED, &yes, sizeof yes);
}

Peer Channel::peer() const noexcept {
  ucred facts{};
  socklen_t bytes = sizeof facts;
  if (getsockopt(socket_.get(), SOL_SOCKET, SO_PEERCRED, &facts, &bytes) != 0) return {.user = ~0U};
  return {facts.pid, facts.uid};
}

bool Channel::isOfOurs() const noexcept {
  const std::uint32_t user = peer().user;
  return user == geteuid() || user == 0;
}

std::pair<Channel, Channel> channelPair() {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0)
    refuseSocket("channel", Error::Code::kOutOfMemory, formatted("no socket can be made ({})", std::strerror(errno)),
                 kFreeDescriptors);
  std::pair<Channel, Channel> both{Channel(Descriptor(ends[0])), Channel(Descriptor(ends[1]))};
  both.first.knowSenders();
  both.second.knowSenders();
  return both;
}

// Its rights are the socket's before it gets its name, so at no moment may another user open it.
Listener::Listener(std::string path, Kind kind) : path_(std::move(path)) {
  const sockaddr_un address = addressOf(path_);
  const Descriptor locked = lockedFolder(path_, kPatience_ms);
  struct stat facts {};
  if (lstat(path_.c_str(), &facts) == 0) {
    if (!S_ISSOCK(facts.st_mode))
      refuseSocket(path_, Error::Code::kBadInput, "something else lies there", "name another place for the socket");
    if (connectSocket(newSocket(path_, kind), address) != ECONNREFUSED)
      refuseSocket(path_, Error::Code::kIo, "somebody listens there already",
                   "stop that service, or name another socket");
    unlink(path_.c_str());
  }
  Descriptor socket = newSocket(path_, kind);
  if (fchmod(socket.get(), S_IRUSR | S_IWUSR) != 0 ||
      bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(socket.get(), kWaiting) != 0)
    refuseSocket(path_, Error::Code::kIo, formatted("no socket can be made there ({})", std::strerror(errno)),
                 "make its folder, or name another place");
  socket_ = std::move(socket);
  place_ = placeNow();
}

Listener::~Listener() {
  if (socket_ && placeNow() == place_) unlink(path_.c_str());
}

Listener::Place Listener::placeNow() const noexcept {
  struct stat facts {};
  if (lstat(path_.c_str(), &facts) != 0) return {};
  return {facts.st_dev, facts.st_ino};
}

bool Listener::lacksDescriptors() const noexcept {
  return rests_until_ns_ != 0 && monotonicNow_ns() < rests_until_ns_;
}

Channel Listener::accept() {
  Channel channel(Descriptor(accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)));
  const bool lacks = !channel.open() && (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM);
  rests_until_ns_ = lacks ? monotonicNow_ns() + std::int64_t{1'000'000} * kRest_ms : 0;
  if (!channel.open()) return channel;
  if (!channel.isOfOurs()) channel.close();
  channel.knowSenders();
  return channel;
}

Channel connectTo(const std::string& path, int patience_ms) {
  const sockaddr_un address = addressOf(path);
  Descriptor socket = newSocket(path, Listener::Kind::kPackets);
  int why = connectSocket(socket, address);
  // EAGAIN: more wait before the door than it has room for.
  for (const auto end = Clock::now() + std::chrono::milliseconds(patience_ms); why == EAGAIN && Clock::now() < end;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
    why = connectSocket(socket, address);
  }
  if (why == ENOENT || why == ECONNREFUSED)
    refuseSocket(path, Error::Code::kNotFound, "no service listens there",
                 "start one with 'palpate serve', or name its socket");
  if (why == EAGAIN)
    refuseSocket(path, Error::Code::kDevice,
                 "the service lets nobody in: its engine hangs, or still loads its volume, or too many wait",
                 "look at the messages of the service, and end it if it hangs");
  if (why == EACCES || why == EPERM)
    refuseSocket(path, Error::Code::kIo, formatted("it may not be opened ({})", std::strerror(why)),
                 "connect as the user who started the service");
  if (why != 0)
    refuseSocket(path, Error::Code::kIo, formatted("it cannot be opened ({})", std::strerror(why)),
                 "look at the socket and the rights of its folder");
  Channel channel(std::move(socket));
  if (!channel.isOfOurs())
    refuseSocket(path, Error::Code::kBadInput, formatted("user {} listens there", channel.peer().user),
                 "start the service as this user");
  return channel;
}

}  // namespace palpate
