// SPDX-License-Identifier: Apache-2.0
// servo/loop/swing_watch.hpp: finds a tool that swings against a surface without settling, tick by tick.
//
// The height of the HIP over the plane turns up and down; out of contact the last plane counts. A swing goes from one
// turn to the next. It counts if it is at least kLeastSwing_m and kLeastSwing_steps encoder steps high. (In a loop that
// is stable without rounding, rounding alone can keep up a swing of two steps.) The contact is unstable if all of this
// is true of kSwings successive swings:
// - They do not die away: the second half, without its largest, is at least kSustained of the first half, without its
//   largest. At kSwings = 20 a swing that loses 5.6 % a period, a damping ratio of 0.009, is on the border.
// - A finger feels them: the second half's mean height is at least leastFelt() at their frequency. Swings that grow are
//   felt in time.
// - Neither the hand nor the surface asks for them. The heights of the swings add up to more than kUnasked times the
//   motion of the hand's path along the normal in the same time, and kAnswered times that of the surface and of what
//   effects add to it. A wall that may be given to a hand answers a surface that goes up and down, as voxels do under a
//   slide, with up to pi / -ln(0.9) = 29.8 times its motion (settlesSoon() in servo/stability/sampled_loop.hpp); the
//   rest is for encoders. So a path that taps, a texture and a noisy surface do not count, unless the contact answers
//   with a resonance of more than that. What an effect adds in proportion to the depth is stiffness and asks for
//   nothing. If the path is unknown, swings count only if no hand makes such ones. Either they are faster than
//   kHand_hz, none takes longer than a period of kHand_hz, and none is less than kKept of the one before it in the same
//   direction: a tool bounces several times when a hand taps on a hard surface, a little less high each time. Or they
//   grow evenly, at any frequency: none is less than the one before it in the same direction, the second half is at
//   least kGrown of the first, and no period differs from the mean by more than kUneven. Whatever the surface asks for,
//   this is enough instead: the path alone does not ask for the swings, and in each period the tool left the surface
//   while the hand wanted it inside.
// - The surface fed them: the energy that it has taken (servo/safety/passivity.hpp) fell from the first to the last. So
//   stick-slip does not count, since friction takes energy.
// Three events start the count anew: the surface ends under the tool (contact is lost with the HIP still below the
// plane), a fading fault, and half a second out of contact. A hand that is exactly on its path cannot bounce, since the
// HIP's height is the path's own.
//
// Frame W: world [m]. Thread: one; the servo's while it runs. Cost: some 20 ns a tick, and that of Path::position().
// Heap, errors: none.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec.hpp"
#include "servo/devices/path.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

class SwingWatch {
 public:
  static constexpr int kSwings = 20;
  static constexpr double kLeastSwing_m = 2e-6;
  static constexpr double kLeastSwing_steps = 2.5;
  static constexpr double kSustained = 0.75;
  static constexpr double kUnasked = 10;
  static constexpr double kAnswered = 40;
  static constexpr double kHand_hz = 12;
  static constexpr double kKept = 0.7;
  static constexpr double kGrown = 1.25;
  static constexpr double kUneven = 0.25;
  static constexpr double kLongestFlight_s = 0.5;

  // The smallest swing, from one turn to the next, that a finger feels [m]: twice the amplitude at the threshold. It is
  // 40 um at 10 Hz, 20 um at 40 Hz and 0.51 um from 250 Hz on, where fingers feel best; in logarithms straight lines
  // lie between these. Verrillo (1963) and Bolanowski et al. (1988) measured such thresholds on the hand's skin; they
  // differ by people and by the area that is touched, several times.
  [[nodiscard]] static double leastFelt(double hz) noexcept;

  // `resolution_m`: of the device's encoders [m]. `path`: where the hand wanted the tool, outlives the watch; null:
  // unknown.
  explicit SwingWatch(double resolution_m, const Path* path = nullptr) noexcept;

  // The next tick of the run. Returns whether the swings that ended with it are those of an unstable contact.
  bool add(const TickRecord& now) noexcept;

  // Of the swings that add() returned true for last.
  struct Unstable {
    double from_s = -1, to_s = -1;  // the first of them begins, the last ends [s]
    double swing_m = 0;             // their mean height [m]
    double swing_hz = 0;            // two swings are a period [1/s]
  };
  [[nodiscard]] const Unstable& unstable() const noexcept { return unstable_; }
  // How often contact was left outwards while the hand wanted the tool inside.
  [[nodiscard]] int bounces() const noexcept { return bounces_; }

 private:
  // A turn of the height: running sums up to it.
  struct Turn {
    double time_s = 0, height_m = 0, energy_J = 0;
    double path_m = 0;   // motion of the path along the normal
    double asked_m = 0;  // motion of path, surface and effects along the normal
    int bounces = 0;
  };
  [[nodiscard]] double effectMotion(const TickRecord& now) const noexcept;
  void forget() noexcept;
  void countBounce(double height_m, double path_height_m) noexcept;
  [[nodiscard]] bool follow(const Turn& now) noexcept;
  void keep(const Turn& turn) noexcept;
  [[nodiscard]] const Turn& turn(std::size_t i) const noexcept { return turns_[(oldest_ + i) % turns_.size()]; }
  [[nodiscard]] double swing(std::size_t i) const noexcept;
  [[nodiscard]] bool keepsUp() const noexcept;
  [[nodiscard]] bool growsEvenly() const noexcept;
  [[nodiscard]] double usualSwings(std::size_t from) const noexcept;
  [[nodiscard]] bool judge() noexcept;

  double resolution_m_, least_m_;
  const Path* path_;
  Vec3 plane_W_ = Vec3::Zero(), normal_W_ = Vec3::Zero();  // of the last tick in contact
  Vec3 path_before_W_ = Vec3::Zero();
  bool has_plane_ = false, in_contact_ = false;
  double effect_height_m_ = 0, depth_m_ = 0;  // of the last tick in contact
  double left_s_ = 0;                         // its time
  double path_m_ = 0, asked_m_ = 0;
  int bounces_ = 0;
  bool turned_ = false;
  int direction_ = 0;                    // of the present swing: 1 up, -1 down, 0 none yet
  Turn farthest_;                        // the farthest point of the present swing
  std::array<Turn, kSwings + 1> turns_;  // ring of the newest
  std::size_t oldest_ = 0, count_ = 0;
  Unstable unstable_;
};

}  // namespace palpate
