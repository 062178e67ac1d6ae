// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/metrics_door.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include "base/monotonic_clock.hpp"
#include "base/thread_names.hpp"

namespace palpate {
namespace {

constexpr int kEndLook_ms = 100;  // how long the service's end may go unseen
constexpr std::string_view kEnd = "\r\n\r\n";

// Of a reader's patience.
class Deadline {
 public:
  [[nodiscard]] bool wait(int descriptor, short events) const {
    const std::int64_t left_ms = (until_ns_ - monotonicNow_ns()) / 1'000'000;
    pollfd one{descriptor, events, 0};
    return left_ms > 0 && poll(&one, 1, static_cast<int>(left_ms)) > 0;
  }

 private:
  const std::int64_t until_ns_ = monotonicNow_ns() + std::int64_t{MetricsDoor::kPatience_ms} * 1'000'000;
};

// The request's lines; empty: there is none in time, or it is too long.
std::string requestOf(int descriptor, const Deadline& deadline) {
  std::string request;
  std::array<char, 1024> part{};
  while (request.find(kEnd) == std::string::npos) {
    if (request.size() > MetricsDoor::kMostRequestBytes || !deadline.wait(descriptor, POLLIN)) return {};
    const ssize_t count = recv(descriptor, part.data(), part.size(), 0);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return {};
    request.append(part.data(), static_cast<std::size_t>(count));
  }
  return request;
}

void sendAll(int descriptor, std::string_view text, const Deadline& deadline) {
  while (!text.empty() && deadline.wait(descriptor, POLLOUT)) {
    const ssize_t count = send(descriptor, text.data(), text.size(), MSG_NOSIGNAL);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

std::string response(const char* status, const char* type, const std::string& body) {
  return fmt::format("HTTP/1.0 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}", status,
                     type, body.size(), body);
}

}  // namespace

MetricsDoor::MetricsDoor(const std::string& socket, std::function<std::string()> text)
    : text_(std::move(text)),
      listener_(socket, Listener::Kind::kStream),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void MetricsDoor::run(const std::stop_token& stop) {
  nameThisThread("metrics");
  while (!stop.stop_requested()) {
    pollfd door{listener_.descriptor(), POLLIN, 0};
    if (poll(&door, 1, kEndLook_ms) <= 0) continue;
    if (const Channel reader = listener_.accept(); reader.open()) answer(reader);
  }
}

void MetricsDoor::answer(const Channel& reader) const {
  const Deadline deadline;
  const std::string request = requestOf(reader.descriptor(), deadline);
  if (request.empty()) return;
  const bool is_get = request.starts_with("GET ");
  sendAll(reader.descriptor(),
          is_get ? response("200 OK", "text/plain; version=0.0.4; charset=utf-8", text_())
                 : response("405 Method Not Allowed", "text/plain", "only GET is answered\n"),
          deadline);
}

}  // namespace palpate
