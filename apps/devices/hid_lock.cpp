// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/hid_lock.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <regex>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "base/descriptor.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// "1-2.3" of libusb's path "1-2.3:1.0", or of a folder of that name above the hidraw node in /sys; empty: it is none of
// USB, or not known.
std::string usbPort(const std::string& device, const fs::path& sys) {
  static const std::regex kInterface(R"((\d+-[\d.]+):\d+\.\d+)");
  std::smatch match;
  if (std::regex_match(device, match, kInterface)) return match[1];
  std::error_code ignored;
  const fs::path at = fs::canonical(sys / "class/hidraw" / fs::path(device).filename() / "device", ignored);
  for (const fs::path& part : at) {
    const std::string name = part.string();
    if (std::regex_match(name, match, kInterface)) return match[1];
  }
  return {};
}

// Its first byte is 0, so the name is no file's: the kernel forgets it with the socket.
std::pair<sockaddr_un, socklen_t> nameOf(const std::string& device) {
  const std::string name = "palpate-uses:" + hidLockName(device);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t size = std::min(name.size(), sizeof address.sun_path - 1);
  std::memcpy(address.sun_path + 1, name.data(), size);
  return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + size)};
}

// For whole packets, since a servo may have no other sockets (service/sandbox).
Descriptor newSocket() {
  return Descriptor(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

// The process that listens there; 0: not known, as to a servo, which may not ask (service/sandbox).
pid_t listenerAt(const sockaddr_un& address, socklen_t size) {
  const Descriptor own = newSocket();
  ucred facts{};
  socklen_t bytes = sizeof facts;
  if (!own || connect(own.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) return 0;
  return getsockopt(own.get(), SOL_SOCKET, SO_PEERCRED, &facts, &bytes) == 0 ? facts.pid : 0;
}

// Held as long as it is open. None where the system gives no socket: then there is no lock.
Descriptor lockOf(const std::string& device) {
  const auto [address, size] = nameOf(device);
  Descriptor own = newSocket();
  if (!own || bind(own.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0) {
    if (own) static_cast<void>(listen(own.get(), SOMAXCONN));  // whoever asks who holds it is never accepted
    return own;
  }
  if (errno != EADDRINUSE) return {};
  const pid_t holder = listenerAt(address, size);
  throw Error(
      Error::Code::kDevice, device,
      fmt::format("another program of Palpate uses it{}", holder > 0 ? fmt::format(" (process {})", holder) : ""),
      holder > 0 ? "end that one first" : "end that one first; 'palpate doctor' says which process it is");
}

class LockedPort final : public ReportPort {
 public:
  LockedPort(Descriptor lock, std::unique_ptr<ReportPort> port) : lock_(std::move(lock)), port_(std::move(port)) {}
  PortRead read(Report& report, int timeout_ms) noexcept override { return port_->read(report, timeout_ms); }
  bool write(const Report& report) noexcept override { return port_->write(report); }

 private:
  Descriptor lock_;
  std::unique_ptr<ReportPort> port_;  // closed before the lock is given up
};

}  // namespace

std::string hidPortName(const std::string& device, const fs::path& sys) {
  const std::string port = usbPort(device, sys);
  return port.empty() ? device : port;
}

// The number of its file tells apart two of the same name, as emulated ones.
std::string hidLockName(const std::string& device, const fs::path& sys) {
  const std::string port = usbPort(device, sys);
  const fs::path file = port.empty() ? fs::path(device) : sys / "bus/usb/devices" / port;
  struct stat facts {};
  if (stat(file.c_str(), &facts) != 0) return port.empty() ? device : port;
  return fmt::format("{}:{}:{}", port.empty() ? device : port, facts.st_dev, facts.st_ino);
}

std::unique_ptr<ReportPort> openHidAlone(const std::string& path, HidBackEnd back_end) {
  Descriptor lock = lockOf(path);
  return std::make_unique<LockedPort>(std::move(lock), openHid(path, back_end));
}

}  // namespace palpate
