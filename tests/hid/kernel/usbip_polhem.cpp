// SPDX-License-Identifier: Apache-2.0
// An emulated arm as a USB device of the running kernel: the other end of a vhci_hcd port, by the USB/IP protocol
// (Documentation/usb/usbip_protocol.rst) over a socket pair. No network. Runs until it is killed.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/hid/kernel/guest_polhem.hpp"

namespace palpate {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr std::size_t kHeaderBytes = 48;
constexpr std::int32_t kReset = -104;  // ECONNRESET, of a request that was taken back

struct Request {
  std::uint32_t command = 0, number = 0, endpoint = 0, length = 0, unlinks = 0;
  bool in = false;
  std::array<std::uint8_t, 8> setup{};
};

std::uint32_t wordAt(const std::uint8_t* bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return ntohl(word);
}
void putWord(Bytes& bytes, std::uint32_t word) {
  const std::uint32_t net = htonl(word);
  const auto* raw = reinterpret_cast<const std::uint8_t*>(&net);
  bytes.insert(bytes.end(), raw, raw + sizeof net);
}

Bytes stringDescriptor(const std::string& text) {
  Bytes bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
  for (const char c : text) bytes.insert(bytes.end(), {static_cast<std::uint8_t>(c), 0});
  return bytes;
}

class UsbipPolhem {
 public:
  UsbipPolhem(const GuestOptions& options, int number) : options_(options), number_(number), polhem_(options.faults) {}

  // Until its cable is pulled.
  void run(int socket) {
    socket_ = socket;
    held_.clear();
    waiting_.clear();
    is_pulled_ = false;
    while (!is_pulled_ && serve()) {
    }
    polhem_.arm().restart();
  }

 private:
  // False: the kernel has let go.
  bool serve() {
    std::array<std::uint8_t, kHeaderBytes> header{};
    if (!take(header.data(), header.size())) return false;
    Request r{.command = wordAt(&header[0]),
              .number = wordAt(&header[4]),
              .endpoint = wordAt(&header[16]),
              .in = wordAt(&header[12]) == 1};
    r.length = wordAt(&header[24]);
    r.unlinks = wordAt(&header[20]);
    std::copy_n(header.begin() + 40, 8, r.setup.begin());
    if (r.command == kUnlink) {
      unlink(r);
      return true;
    }
    Bytes sent(r.in ? 0 : r.length);
    if (!sent.empty() && !take(sent.data(), sent.size())) return false;
    submit(r, sent);
    return true;
  }

  bool take(std::uint8_t* to, std::size_t count) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t got = read(socket_, to + done, count - done);
      if (got <= 0) return false;
      done += static_cast<std::size_t>(got);
    }
    return true;
  }

  void answer(const Request& r, std::int32_t status, const Bytes& data) {
    Bytes bytes;
    putWord(bytes, kSubmitted);
    putWord(bytes, r.number);
    for (int i = 0; i < 3; ++i) putWord(bytes, 0);
    putWord(bytes, static_cast<std::uint32_t>(status));
    putWord(bytes, static_cast<std::uint32_t>(r.in ? data.size() : r.length));
    for (int i = 0; i < 5; ++i) putWord(bytes, 0);
    if (r.in) bytes.insert(bytes.end(), data.begin(), data.end());
    static_cast<void>(write(socket_, bytes.data(), bytes.size()));
  }

  void unlink(const Request& r) {
    const auto held = std::ranges::find(held_, r.unlinks, &Request::number);
    Bytes bytes;
    putWord(bytes, kUnlinked);
    putWord(bytes, r.number);
    for (int i = 0; i < 3; ++i) putWord(bytes, 0);
    putWord(bytes, static_cast<std::uint32_t>(held != held_.end() ? kReset : 0));
    for (int i = 0; i < 6; ++i) putWord(bytes, 0);
    if (held != held_.end()) held_.erase(held);
    static_cast<void>(write(socket_, bytes.data(), bytes.size()));
  }

  void submit(const Request& r, const Bytes& sent) {
    if (r.endpoint == 0) return answer(r, 0, control(r));
    if (r.in) {
      held_.push_back(r);
    } else {
      answer(r, 0, {});
      Report report;
      report.size = 1 + std::min(sent.size(), report.bytes.size() - 1);
      std::copy_n(sent.begin(), report.size - 1, report.bytes.begin() + 1);
      ++reports_;
      is_pulled_ = reports_ == options_.unplug_after;
      const bool is_silent = options_.silent_after >= 0 && reports_ > options_.silent_after;
      for (const Report& more : polhem_.reports().answersTo(report)) {
        if (!is_silent) waiting_.push_back(more);
      }
    }
    deliver();
  }

  void deliver() {
    while (!held_.empty() && !waiting_.empty()) {
      const Report& report = waiting_.front();
      answer(held_.front(), 0, {report.bytes.begin(), report.bytes.begin() + static_cast<std::ptrdiff_t>(report.size)});
      held_.pop_front();
      waiting_.pop_front();
    }
  }

  Bytes control(const Request& r) {
    const unsigned request = r.setup[1], kind = r.setup[3], index = r.setup[2];
    Bytes bytes;
    if (request == 6) bytes = descriptor(kind, index);  // GET_DESCRIPTOR
    if (request == 0) bytes = {0, 0};                   // GET_STATUS
    // SET_CONFIGURATION: it is switched on.
    if (request == 9 && options_.silent_after != 0) waiting_ = {polhem_.arm().state()};
    if (bytes.size() > r.length) bytes.resize(r.length);
    return bytes;
  }

  [[nodiscard]] Bytes descriptor(unsigned kind, unsigned index) const {
    const Bytes report = reportDescriptor(false);
    const Bytes hid = {9, 0x21, 0x11, 0x01, 0, 1, 0x22, static_cast<std::uint8_t>(report.size()), 0};
    if (kind == 1) return {18, 1, 0, 2, 0, 0, 0, 64, 0x34, 0x12, 6, 0, 0, 1, 1, 2, 3, 1};
    if (kind == 2) {
      Bytes all = {9, 2, 41, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 2, 3, 0, 0, 0};
      all.insert(all.end(), hid.begin(), hid.end());
      const Bytes ends = {7, 5, 0x81, 3, 64, 0, 1, 7, 5, 0x02, 3, 64, 0, 1};
      all.insert(all.end(), ends.begin(), ends.end());
      return all;
    }
    if (kind == 3 && index == 0) return {4, 3, 9, 4};
    if (kind == 3)
      return stringDescriptor(index == 1 ? "Emulated" : index == 2 ? "USB Polhem" : "U" + std::to_string(number_));
    if (kind == 0x21) return hid;
    if (kind == 0x22) return report;
    return {};
  }

  const GuestOptions& options_;
  int number_, socket_ = -1, reports_ = 0;
  bool is_pulled_ = false;
  GuestPolhem polhem_;
  std::deque<Request> held_;
  std::deque<Report> waiting_;
};

// The other end of a port that the kernel has just been given; below 0: it did not take it.
int attachedTo(int port) {
  int ends[2] = {};
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return std::perror("socketpair"), -1;
  constexpr const char* kAttach = "/sys/devices/platform/vhci_hcd.0/attach";
  const int attach = open(kAttach, O_WRONLY);
  // Port, socket, device, high speed.
  const std::string words = std::to_string(port) + " " + std::to_string(ends[0]) + " 65537 3";
  const bool taken = attach >= 0 && write(attach, words.data(), words.size()) >= 0;
  if (!taken) std::perror(kAttach);
  if (attach >= 0) close(attach);
  close(ends[0]);
  return taken ? ends[1] : -1;
}

// One that is pulled comes back, to another port: the kernel may still be busy with the first.
void serve(const GuestOptions& options, int number) {
  UsbipPolhem polhem(options, number);
  for (int port = number; port < 8; port += options.count) {
    const int socket = attachedTo(port);
    if (socket < 0) return;
    polhem.run(socket);
    close(socket);
    usleep(static_cast<useconds_t>(1000 * options.replug_ms));
  }
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  using namespace palpate;
  const GuestOptions o = guestOptions(count, words);
  int number = 0;
  while (number + 1 < o.count && fork() == 0) ++number;  // each in a process of its own
  if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0) return 1;
  serve(o, number);
  return 0;
}
