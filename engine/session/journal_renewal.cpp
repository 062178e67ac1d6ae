// SPDX-License-Identifier: Apache-2.0
#include "engine/session/journal_renewal.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"
#include "engine/session/checkpoint_keeper.hpp"

namespace palpate {

// Whoever was to begin anew may be gone before: memory fails, or the saver has stopped. Then nothing is on its way.
class JournalRenewal::Attempt {
 public:
  explicit Attempt(JournalWriter& journal) noexcept : journal_(journal) {}
  ~Attempt() {
    if (!is_made_) journal_.failIfBehind();
  }
  Attempt(const Attempt&) = delete;
  Attempt& operator=(const Attempt&) = delete;
  void make() noexcept { is_made_ = true; }

 private:
  JournalWriter& journal_;
  bool is_made_ = false;
};

bool JournalRenewal::isDue(std::int64_t now_ns) const noexcept {
  return journal_.canBeginAnew() && now_ns >= (journal_.failed() ? not_before_ns_ : undo_not_before_ns_);
}

std::function<void(const Volume&)> JournalRenewal::begin(std::int64_t now_ns, std::uint64_t made,
                                                         std::size_t in_effect) {
  const EditMark mark = state_.markAnyway(in_effect);
  const auto attempt = std::make_shared<Attempt>(journal_);
  journal_.gatherAnew(made);
  return [this, mark, now_ns, attempt](const Volume& volume) {
    attempt->make();
    makeFile(mark, volume, now_ns);
  };
}

void JournalRenewal::makeFile(const EditMark& mark, const Volume& volume, std::int64_t began_ns) {
  constexpr double kBetween_s = 1, kShareForUndo = 1. / 2;
  const std::string before = journal_.failure();
  const Stopwatch watch;
  std::string failure, cause;
  try {
    const std::vector<std::uint32_t> bricks = state_.bricks();
    journal_.beginAnew({mark, &volume, bricks});
    has_begun_ = true;
  } catch (const Error& error) {
    failure = error.what();
    cause = error.reason().substr(std::min(error.reason().rfind('('), error.reason().size()));
  } catch (const std::exception& error) {
    failure = error.what();
    journal_.failIfBehind();
  }
  const auto after = [&](double share, double least_s) {
    return began_ns + std::llround(std::max(least_s, watch.seconds() / share) * kNanosecondsPerSecond);
  };
  not_before_ns_ = after(CheckpointKeeper::kShareForWriting, kBetween_s);
  undo_not_before_ns_ = after(kShareForUndo, 0);
  const bool is_named = !cause.empty() && before.find(cause) != std::string::npos;
  if (failure.empty() || is_named || failure == told_) return;
  told_ = failure;
  throw Error(Error::Code::kIo, "the journal", "it cannot begin anew: " + failure, "it is tried again and again");
}

}  // namespace palpate
