// SPDX-License-Identifier: Apache-2.0
// servo/devices/pointer_path.hpp: leads the simulated device where a mouse points.
//
// A pointer jumps from one place to another some sixty times a second. A hand does not: it follows as a critically
// damped spring, and at most at kFastest_m_per_s, so that the servo meets no step. Where the straight way to a place is
// blocked, the tool is lifted and put down elsewhere: it leaps, and nothing is felt of what lies between.
//
// Frame W: world [m]. Threads: aim() by one thread, position() by the device's, with times that do not decrease,
// follow() by one that waits for hasFollowed(). No lock, no heap. The solution between two aims is exact, whatever the
// rate of the servo. The two may be processes that share the block of the aims; one that is no place in the world is
// not followed.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "servo/devices/path.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

// Where a pointer leads the tool [m].
struct PointerTarget {
  PointerTarget(const Vec3& hip) noexcept : hip_W(hip) {}
  PointerTarget(const Vec3& hip, const Vec3& from) noexcept : hip_W(hip), from_W(from) {}
  Vec3 hip_W;
  std::optional<Vec3> from_W;  // the tool is put there first: it leaps, since its way would be blocked
  bool operator==(const PointerTarget&) const = default;
};

// An aim as it lies in memory that two processes share.
struct PointerAimRecord {
  double hip_W[3] = {};     // [m]
  double from_W[3] = {};    // of the newest leap [m]
  std::uint64_t leaps = 0;  // so far
};
static_assert(std::is_trivially_copyable_v<PointerAimRecord> && sizeof(PointerAimRecord) == 56);
using PointerAimBlock = TripleBlock<PointerAimRecord>;

// Where the pointer leads the tool: the writer's end.
class PointerAim {
 public:
  // Over a block that neither side has used, and which outlives this.
  explicit PointerAim(PointerAimBlock& shared) noexcept : aims_(shared) {}
  void aim(const Vec3& p_W) noexcept { aim(PointerTarget(p_W)); }
  void aim(const PointerTarget& target) noexcept;

 private:
  TripleBuffer<PointerAimRecord> aims_;
  PointerAimRecord newest_;
};

// The reader's end: aims as they come.
class PointerTargets {
 public:
  explicit PointerTargets(PointerAimBlock& shared) noexcept : aims_(shared) {}
  // The newest that was not taken; one that is no place in the world is left out. A leap is told even if newer aims
  // came since.
  [[nodiscard]] std::optional<PointerTarget> take() noexcept;

 private:
  TripleBuffer<PointerAimRecord> aims_;
  std::uint64_t leaps_ = 0;
};

class PointerPath final : public Path {
 public:
  static constexpr double kTimeConstant_s = 0.02;  // of the spring: a jump is half made after 1.7 of them
  static constexpr double kFastest_m_per_s = 0.5;

  explicit PointerPath(const Vec3& start_W) : aim_W_(start_W), position_W_(start_W) {}
  // Until the first aim it goes another way, which outlives this.
  explicit PointerPath(const Path& until) : until_(&until), aim_W_(until.position(0)), position_W_(aim_W_) {}

  // From the next position() on the aims come from there, where nobody has read any. The block before, if there was
  // one, is not used any more once hasFollowed().
  void follow(PointerAimBlock& aims) noexcept { next_.store(&aims, std::memory_order_release); }
  [[nodiscard]] bool hasFollowed() const noexcept { return next_.load(std::memory_order_acquire) == nullptr; }

  [[nodiscard]] Vec3 position(double time_s) const noexcept override;
  [[nodiscard]] double duration_s() const noexcept override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] std::uint64_t leaps() const noexcept override { return leaps_; }

 private:
  [[nodiscard]] bool look() const noexcept;  // true: it has leapt

  // The device's state. Its functions are const because paths of other kinds have none.
  mutable const Path* until_ = nullptr;  // null: it has been aimed
  mutable std::atomic<PointerAimBlock*> next_{nullptr};
  mutable std::optional<PointerTargets> targets_;
  mutable std::uint64_t leaps_ = 0;
  mutable Vec3 aim_W_;
  mutable double time_s_ = 0;
  mutable Vec3 position_W_;
  mutable Vec3 velocity_W_ = Vec3::Zero();
};

}  // namespace palpate
