// SPDX-License-Identifier: Apache-2.0
// apps/serve/metrics_door.hpp: a Unix socket at which a service's metrics are read by HTTP, as
// `curl --unix-socket metrics.sock http://palpate/metrics` or a proxy for Prometheus does.
//
// A thread of its own answers one after another: any GET gets the same text, and the connection ends. One who asks
// nothing, asks slowly or does not read is left after kPatience_ms, so that nobody is kept waiting longer than that by
// each before him. It is no web server: no headers are heeded, and nothing is kept.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <thread>

#include "service/channel/channel.hpp"

namespace palpate {

class MetricsDoor {
 public:
  static constexpr int kPatience_ms = 500;
  static constexpr std::size_t kMostRequestBytes = 4096;
  // `text`: Prometheus' text (served_status.hpp); called by the door's thread. Throws Error as Listener does.
  MetricsDoor(const std::string& socket, std::function<std::string()> text);
  ~MetricsDoor() = default;
  MetricsDoor(const MetricsDoor&) = delete;
  MetricsDoor& operator=(const MetricsDoor&) = delete;

 private:
  void run(const std::stop_token& stop);
  void answer(const Channel& reader) const;

  const std::function<std::string()> text_;
  Listener listener_;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
