// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/lateness.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include <fmt/format.h>
#include <sys/wait.h>

#include "apps/rivals/child_talk.hpp"

namespace palpate {

void LatenessCounts::add(std::int64_t lateness_us, std::int64_t times) {
  const auto at = static_cast<std::size_t>(std::clamp<std::int64_t>(lateness_us, 0, kOverflow_us));
  if (counts_.size() <= at) counts_.resize(at + 1);
  counts_[at] += times;
  total_ += times;
}

void LatenessCounts::add(const LatenessCounts& other) {
  for (std::size_t i = 0; i < other.counts_.size(); ++i) {
    if (other.counts_[i] > 0) add(static_cast<std::int64_t>(i), other.counts_[i]);
  }
}

double LatenessCounts::quantile_us(double q) const {
  const double rank = std::max(1.0, std::ceil(q * static_cast<double>(total_) * (1 - 1e-12)));
  double seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    seen += static_cast<double>(counts_[i]);
    if (seen >= rank) return static_cast<double>(i);
  }
  return 0;
}

std::int64_t LatenessCounts::atLeast(std::int64_t us) const {
  if (us >= static_cast<std::int64_t>(counts_.size())) return 0;
  return std::accumulate(counts_.begin() + std::max<std::int64_t>(us, 0), counts_.end(), std::int64_t{0});
}

std::int64_t LatenessCounts::misses(double rate_hz) const {
  return atLeast(static_cast<std::int64_t>(std::ceil(1e6 / rate_hz)));
}

std::string cyclictestCommand(const CyclictestRequest& request) {
  return fmt::format(
      "cyclictest --quiet --mlockall --default-system --threads=1 --interval={} --loops={} --histogram={} {}",
      std::llround(1e6 / request.rate_hz), request.cycles, LatenessCounts::kOverflow_us,
      request.fifo ? fmt::format("--policy=fifo --priority={}", request.priority) : "--policy=other");
}

CyclictestOutcome runCyclictest(const CyclictestRequest& request) {
  constexpr int kShellFindsNoCommand = 127;
  // `exec` replaces the shell by cyclictest, so that ending the child ends cyclictest. Its errors come with its output.
  ChildTalk shell({"/bin/sh", "-c", "exec " + cyclictestCommand(request) + " 2>&1"});
  std::string text, last;
  while (const std::optional<std::string> line = shell.hear()) {
    text += *line + "\n";
    if (!line->empty()) last = *line;
  }
  CyclictestOutcome outcome;
  const int status = shell.wait();
  if (status < 0) {
    outcome.trouble = "no shell could be started";
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kShellFindsNoCommand) {
    outcome.trouble = "cyclictest is not installed; apt-get install rt-tests";
  } else if (const auto counts = parseCyclictest(text); status == 0 && counts) {
    outcome.lateness = *counts;
  } else {
    outcome.trouble = fmt::format("cyclictest failed (status {}): {}", status, last);
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
