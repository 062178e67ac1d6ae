// SPDX-License-Identifier: Apache-2.0
#include "apps/supervise/service_notify.hpp"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/outside_text.hpp"

namespace palpate {
namespace {

constexpr const char* kRemedy = "systemd sets it; unset it to start the program by hand";

std::string environmentText(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? text : "";
}

// Empty where the variable is not set.
std::optional<std::int64_t> environmentNumber(const char* name) {
  const std::string text = environmentText(name);
  if (text.empty()) return std::nullopt;
  std::int64_t number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc() || end != text.data() + text.size() || number <= 0) {
    refuse(name, fmt::format("'{}' is no whole number above 0", text), kRemedy);
  }
  return number;
}

std::optional<std::chrono::microseconds> watchdogFromEnvironment() {
  const std::optional<std::int64_t> period_us = environmentNumber("WATCHDOG_USEC");
  const std::optional<std::int64_t> whose = environmentNumber("WATCHDOG_PID");
  if (!period_us || (whose && *whose != getpid())) return std::nullopt;
  return std::chrono::microseconds(*period_us);
}

std::string addressFromEnvironment() {
  std::string address = environmentText("NOTIFY_SOCKET");
  if (address.empty()) return address;
  const bool known = address.front() == '/' || (address.front() == '@' && address.size() > 1);
  if (!known || address.size() >= sizeof(sockaddr_un::sun_path)) {
    refuse("NOTIFY_SOCKET", fmt::format("'{}' is no address of a Unix socket", address), kRemedy);
  }
  return address;
}

}  // namespace

ServiceNotify::ServiceNotify() : address_(addressFromEnvironment()), watchdog_period_(watchdogFromEnvironment()) {}

bool ServiceNotify::ready() const noexcept {
  return send("READY=1");
}

bool ServiceNotify::reloading() const noexcept {
  // The time tells systemd that the next READY=1 is not of an earlier reload.
  try {
    return send(fmt::format("RELOADING=1\nMONOTONIC_USEC={}", monotonicNow_ns() / 1000));
  } catch (...) {
    return false;
  }
}

bool ServiceNotify::stopping() const noexcept {
  return send("STOPPING=1");
}

bool ServiceNotify::status(std::string_view text) const noexcept {
  try {
    return send("STATUS=" + oneLine(std::string(text)));  // a further line would be another message
  } catch (...) {
    return false;
  }
}

bool ServiceNotify::watchdog() const noexcept {
  return send("WATCHDOG=1");
}

// A socket for each message: systemd may be started anew meanwhile.
bool ServiceNotify::send(std::string_view message) const noexcept {
  if (!isWanted()) return false;
  const Descriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket) return false;
  const timeval most{.tv_sec = 1, .tv_usec = 0};
  setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &most, sizeof most);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  address_.copy(to.sun_path, sizeof to.sun_path - 1);
  if (address_.front() == '@') to.sun_path[0] = '\0';
  // An abstract name has no end mark: its length is part of it.
  const auto to_bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  const ssize_t sent = sendto(socket.get(), message.data(), message.size(), MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&to), to_bytes);
  return sent == static_cast<ssize_t>(message.size());
}

}  // namespace palpate
