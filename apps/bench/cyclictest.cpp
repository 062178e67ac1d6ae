// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/cyclictest.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr int kShellFindsNoCommand = 127;

// Text that one line of a note can hold.
std::string lastLine(const std::string& text) {
  std::istringstream in(text);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

}  // namespace

std::string cyclictestCommand(const CyclictestRequest& request) {
  return fmt::format(
      "cyclictest --quiet --mlockall --default-system --threads=1 --interval={} --loops={} --histogram={} {}",
      std::llround(1e6 / request.rate_hz), request.cycles, LatenessCounts::kOverflow_us,
      request.fifo ? fmt::format("--policy=fifo --priority={}", request.priority) : "--policy=other");
}

CyclictestOutcome runCyclictest(const CyclictestRequest& request) {
  CyclictestOutcome outcome;
  std::FILE* pipe = popen((cyclictestCommand(request) + " 2>&1").c_str(), "r");
  if (pipe == nullptr) {
    outcome.trouble = "no shell could be started";
    return outcome;
  }
  std::string text;
  std::array<char, 4096> block{};
  for (std::size_t got = 0; (got = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    text.append(block.data(), got);
  const int status = pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kShellFindsNoCommand) {
    outcome.trouble = "cyclictest is not installed; apt-get install rt-tests";
  } else if (const auto counts = parseCyclictest(text); status == 0 && counts) {
    outcome.lateness = *counts;
  } else {
    outcome.trouble = fmt::format("cyclictest failed (status {}): {}", status, lastLine(text));
  }
  return outcome;
}

std::optional<LatenessCounts> parseCyclictest(const std::string& text) {
  LatenessCounts counts;
  std::istringstream in(text);
  const std::string overflows = "# Histogram Overflows:";
  for (std::string line; std::getline(in, line);) {
    std::int64_t us = 0, times = 0;
    if (line.starts_with(overflows)) {
      if (std::istringstream(line.substr(overflows.size())) >> times && times > 0) {
        counts.add(LatenessCounts::kOverflow_us, times);
      }
    } else if (!line.empty() && line[0] >= '0' && line[0] <= '9') {
      if (std::istringstream(line) >> us >> times && times > 0) counts.add(us, times);
    }
  }
  return counts.total() > 0 ? std::optional(counts) : std::nullopt;
}

}  // namespace palpate
