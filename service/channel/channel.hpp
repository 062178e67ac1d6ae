// SPDX-License-Identifier: Apache-2.0
// service/channel/channel.hpp: whole messages between two processes, over a Unix socket; a message may carry a file
// descriptor.
//
// The other side may be anybody: a message longer than kMostMessageBytes, or with more than one descriptor, ends the
// connection, and a side that does not read holds the other up for no longer than it is told to wait.
// Threads: one at a time sends, one at a time receives. System calls; not for the servo's thread. Linux only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/descriptor.hpp"

namespace palpate {

inline constexpr std::size_t kMostMessageBytes = std::size_t{64} << 10U;

struct Packet {
  std::vector<std::byte> bytes;
  Descriptor attached;      // none: the message carried none
  std::int64_t sender = 0;  // the process that sent it, as the kernel says; 0: not known here (Channel::knowSenders())
};

// Who connected, as the kernel says. It may have handed the connection to another process since.
struct Peer {
  std::int64_t process = 0;
  std::uint32_t user = 0;
};

class Channel {
 public:
  enum class Got : std::uint8_t { kPacket, kNothing, kClosed };

  Channel() = default;
  explicit Channel(Descriptor socket) noexcept : socket_(std::move(socket)) {}

  // Waits for room for `most_ms` at most. False: there is none, or the other side is gone; then nothing was sent. The
  // descriptor stays the caller's; below 0: none. Throws Error(kBadInput) for a message that is too long.
  [[nodiscard]] bool send(std::span<const std::byte> bytes, int most_ms, int attached = -1) noexcept(false);
  // Waits for `most_ms` at most [ms]; below 0: without an end. kClosed: the other side is gone, or broke the rules.
  [[nodiscard]] Got receive(Packet& packet, int most_ms);

  // From now on the kernel says of each packet who sent it. A listener's connections and both ends of channelPair() do.
  void knowSenders() const noexcept;
  [[nodiscard]] Peer peer() const noexcept;
  [[nodiscard]] bool isOfOurs() const noexcept;                            // of this user, or root
  [[nodiscard]] int descriptor() const noexcept { return socket_.get(); }  // to wait for it with poll(2)
  [[nodiscard]] bool open() const noexcept { return static_cast<bool>(socket_); }
  void close() noexcept { socket_.close(); }

 private:
  Descriptor socket_;
};

// Two ends of one connection. Throws Error(kOutOfMemory): no descriptor, or no memory, is left.
[[nodiscard]] std::pair<Channel, Channel> channelPair();

// A place where others connect: a socket that only this user's processes can open (mode 0600).
class Listener {
 public:
  // Takes the place of a socket at which nobody listens any more; of several that try at once, one gets it. Throws
  // Error: kBadInput for a path that is too long for a socket, or at which something else lies; kIo if somebody listens
  // there, or keeps its folder locked for kPatience_ms, or for the system's reason.
  // `kind`: whole packets for channels, or a stream of bytes for other programs.
  enum class Kind : std::uint8_t { kPackets, kStream };
  static constexpr int kPatience_ms = 2000;
  explicit Listener(std::string path, Kind kind = Kind::kPackets);
  ~Listener();  // removes it, unless another lies there by now
  Listener(Listener&& other) noexcept
      : path_(std::move(other.path_)),
        place_(other.place_),
        socket_(std::move(other.socket_)),
        rests_until_ns_(other.rests_until_ns_) {}

  // The next connection of this user or root, or a closed channel if none waits. Others are turned away. Where the
  // process has no descriptor left for it, the connection goes on waiting, and the listener rests for kRest_ms: a wait
  // for its descriptor would end at once, again and again.
  [[nodiscard]] Channel accept();
  static constexpr int kRest_ms = 100;
  [[nodiscard]] bool lacksDescriptors() const noexcept;
  // To wait for it with poll(2); -1, which poll leaves out, while it rests.
  [[nodiscard]] int descriptor() const noexcept { return lacksDescriptors() ? -1 : socket_.get(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  struct Place {  // of its file
    std::uint64_t device = 0, number = 0;
    friend bool operator==(const Place&, const Place&) = default;
  };
  [[nodiscard]] Place placeNow() const noexcept;

  std::string path_;
  Place place_;
  Descriptor socket_;
  std::int64_t rests_until_ns_ = 0;  // monotonicNow_ns()
};

// Throws Error: kNotFound if nobody listens there, kBadInput and kIo as Listener does, kBadInput if another user does,
// kDevice if nobody lets it in for `patience_ms`: whoever listens hangs, or is busy with something long.
inline constexpr int kConnectPatience_ms = 2000;
[[nodiscard]] Channel connectTo(const std::string& path, int patience_ms = kConnectPatience_ms);

}  // namespace palpate
