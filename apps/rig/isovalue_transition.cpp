// SPDX-License-Identifier: Apache-2.0
#include "apps/rig/isovalue_transition.hpp"

#include <limits>

#include "base/stopwatch.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

bool IsovalueTransition::mayGive(const Look& look) noexcept {
  if (at_ != At::kShown || look.wanted != next_ || look.window_seen < shown_) return false;
  at_ = At::kTaking;
  return true;
}

void IsovalueTransition::work(const Look& look, std::int64_t now_ns) {
  switch (at_) {
    case At::kStart:
      if (look.wanted == look.in_use) return;
      engine_.beginIsovalue(look.wanted);
      next_ = look.wanted;
      return gather(look, now_ns);
    case At::kGathering:
      return look.wanted == next_ ? gather(look, now_ns) : end(look.in_use);
    case At::kShown:  // the samples of the isovalue in use are still complete
      return look.wanted == next_ ? void() : end(look.in_use);
    case At::kTaking:
      return look.taken ? end(look.in_use) : void();
  }
}

void IsovalueTransition::gather(const Look& look, std::int64_t now_ns) {
  at_ = At::kStart;  // stays so if the engine has no room
  const Stopwatch watch;
  const bool all =
      engine_.gatherIsovalue(look.all_at_once ? std::numeric_limits<std::size_t>::max() : portion_.bricks(), now_ns);
  at_ = all ? At::kShown : At::kGathering;
  if (!all) portion_.took(portion_.bricks(), watch.seconds());
  shown_ = engine_.exchange().nextVersion() - 1;
}

void IsovalueTransition::end(double in_use) {
  if (at_ != At::kStart) engine_.endIsovalue(in_use);
  at_ = At::kStart;
}

}  // namespace palpate
