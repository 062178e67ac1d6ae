// SPDX-License-Identifier: Apache-2.0
#include "engine/session/checkpoint_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "base/stopwatch.hpp"
#include "base/units.hpp"

namespace palpate {
CheckpointKeeper::CheckpointKeeper(std::filesystem::path folder, const EditedState& state, std::uint64_t journal,
                                   const Headstart& held, std::function<void(const std::string&)> told,
                                   double edits_between_s)
    : folder_(std::move(folder)),
      state_(state),
      journal_(journal),
      told_(std::move(told)),
      edits_between_s_(edits_between_s),
      marks_(held.good),
      is_others_(journal != 0 && !held.bricks.empty()) {}

void CheckpointKeeper::edited(double seconds) noexcept {
  edits_s_ += seconds;
  if (const std::optional<EditMark> now = state_.mark(); now && std::ranges::find(marks_, now) != marks_.end())
    edits_s_ = 0;  // made again, up to where the other file is
}

void CheckpointKeeper::undone() noexcept {
  const std::optional<EditMark> now = state_.mark();
  for (std::optional<EditMark>& mark : marks_) {
    if (mark && now && mark->edits > now->edits) mark.reset();  // also if it is done again: that is rare
  }
}

bool CheckpointKeeper::isDue(std::int64_t now_ns) noexcept {
  if (std::exchange(attempt_.is_new, false)) {
    constexpr double kAgain_s = 10;  // after a failure
    if (attempt_.failed) {
      marks_[attempt_.place].reset();
      is_alone_ = is_alone_ || attempt_.was_alone;
    }
    const double pause_s = std::max(attempt_.seconds / kShareForWriting, attempt_.failed ? kAgain_s : 0);
    not_before_ns_ = attempt_.began_ns + std::llround(pause_s * kNanosecondsPerSecond);
  }
  const bool are_many = (is_others_ || edits_s_ >= edits_between_s_) && edits_s_ > 0;
  return (is_alone_ || are_many) && (hurries_ || now_ns >= not_before_ns_) && state_.mark();
}

// The newest stays, and the one before goes.
std::size_t CheckpointKeeper::placeForNext() const noexcept {
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (!marks_[i]) return i;
  }
  return marks_[0]->edits < marks_[1]->edits ? 0 : 1;
}

std::function<void(const Volume&)> CheckpointKeeper::writer(std::int64_t now_ns, std::uint64_t sequence) {
  const std::size_t place = placeForNext();
  const EditMark mark = *state_.mark();
  marks_[place] = mark;
  attempt_ = {.place = place, .began_ns = now_ns, .was_alone = is_alone_, .is_new = true};
  edits_s_ = 0;
  is_others_ = is_alone_ = false;
  return [this, head = CheckpointHead{mark, journal_, sequence}, place](const Volume& volume) {
    write(volume, head, place);
  };
}

void CheckpointKeeper::write(const Volume& volume, const CheckpointHead& head, std::size_t place) {
  const Stopwatch watch;
  try {
    const std::vector<std::uint32_t> bricks = state_.bricks();
    checkRoomFor(folder_, bricks.size());
    writeCheckpoint(checkpointFile(folder_, place), head, volume, bricks);
  } catch (const std::exception& error) {
    attempt_.failed = true;
    if (!std::exchange(was_told_, true))
      told_(
          fmt::format("no checkpoint was written, so a start after a crash makes more edits again: {}", error.what()));
  }
  attempt_.seconds = watch.seconds();
}

}  // namespace palpate
