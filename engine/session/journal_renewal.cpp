// SPDX-License-Identifier: Apache-2.0
#include "engine/session/journal_renewal.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"

namespace palpate {

bool JournalRenewal::isDue(std::int64_t now_ns) const noexcept {
  return journal_.canBeginAnew() && now_ns >= not_before_ns_;
}

std::function<void(const Volume&)> JournalRenewal::begin(std::int64_t now_ns, std::uint64_t made,
                                                         std::size_t in_effect) {
  const EditMark mark = state_.markAnyway(in_effect);
  journal_.gatherAnew(made);
  return [this, mark, now_ns](const Volume& volume) { makeFile(mark, volume, now_ns); };
}

void JournalRenewal::makeFile(const EditMark& mark, const Volume& volume, std::int64_t began_ns) {
  constexpr double kBetween_s = 1, kShareForWriting = 1. / 20;
  const Stopwatch watch;
  std::string in_the_way;
  try {
    const std::vector<std::uint32_t> bricks = state_.bricks();
    journal_.beginAnew({mark, &volume, bricks});
  } catch (const Error& error) {
    if (error.code() != Error::Code::kIo) in_the_way = error.what();
  } catch (const std::exception&) {  // no memory
  }
  const double wait_s = std::max(kBetween_s, watch.seconds() / kShareForWriting);
  not_before_ns_ = began_ns + std::llround(wait_s * kNanosecondsPerSecond);
  if (in_the_way.empty() || in_the_way == told_) return;
  told_ = in_the_way;
  throw Error(Error::Code::kIo, "the journal", "it cannot begin anew: " + in_the_way, "it is tried again and again");
}

}  // namespace palpate
