// SPDX-License-Identifier: Apache-2.0
// A tool that nothing holds: which of its ways are entries, and what it is told of the others.
#include "servo/algorithms/free_motion.hpp"

#include <gtest/gtest.h>

#include "servo/safety/faults.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {
namespace free_motion_test {

// All is object below a height. The window holds 4 to 27 mm along each axis of 32, and no face of the volume.
class Ground {
 public:
  explicit Ground(double top_m) {
    millimetreVolume([=](const Vec3& p_W) { return top_m - p_W.z(); }, 32)
        .hold(held_, Vec3i::Constant(4), Vec3i::Constant(24));
  }
  [[nodiscard]] IsoField field() const { return {held_.window, 0}; }

 private:
  HeldWindow held_;
};

Vec3 at(double z_mm) {
  return {16e-3, 16e-3, z_mm * 1e-3};
}
constexpr double kUnseen_mm = 30;  // beyond the window

class Free : public testing::Test {
 protected:
  // The height of the entry [mm]; 0: none.
  double move(double z_mm) { return moveIn(ground_, z_mm); }
  double moveIn(const Ground& ground, double z_mm) {
    faults = 0;
    const auto entry = free.move(ground.field(), at(z_mm), faults);
    return entry ? entry->p_W.z() * 1e3 : 0;
  }
  [[nodiscard]] Probe probe(double z_mm) const { return ground_.field().probe(at(z_mm)); }

  static constexpr double kRounding_mm = 1e-4;  // 1e-4 of densities of a few mm (IsoField::refined)
  static constexpr std::uint32_t kInside = bit(ServoFault::kInsideObject), kLost = bit(ServoFault::kSurfaceLost),
                                 kBeyond = bit(ServoFault::kBeyondWindow);
  const Ground ground_{10e-3};
  FreeMotion free;
  std::uint32_t faults = 0;
};

TEST_F(Free, EntersOnceItHasBeenOutside) {
  EXPECT_EQ(move(8), 0);
  EXPECT_EQ(faults, kInside);
  EXPECT_EQ(free.hipSide(), Side::kInside);
  EXPECT_EQ(move(kUnseen_mm), 0);
  EXPECT_EQ(faults, kBeyond);
  EXPECT_EQ(free.hipSide(), Side::kUnknown);
  EXPECT_EQ(move(12), 0);
  EXPECT_EQ(faults, 0U);
  EXPECT_EQ(free.hipSide(), Side::kOutside);
  EXPECT_EQ(move(kUnseen_mm), 0);
  EXPECT_EQ(faults, kBeyond);
  EXPECT_NEAR(move(8), 10, kRounding_mm);  // over the gap
  EXPECT_EQ(faults, 0U);
  // The entry is given once.
  EXPECT_EQ(move(8), 0);
  EXPECT_EQ(faults, kInside);
  free.reset();
  EXPECT_EQ(free.hipSide(), Side::kUnknown);
}

TEST_F(Free, AfterAContactItGoesOnFromThere) {
  free.release(probe(11));
  EXPECT_NEAR(move(9), 10, kRounding_mm);
  free.release(probe(9));
  EXPECT_EQ(move(8), 0);
  EXPECT_EQ(faults, kInside);
  free.release(probe(12));
  free.reset();
  EXPECT_EQ(move(8), 0);
}

// Told in every tick until the tool has been seen outside, or a contact has ended otherwise.
TEST_F(Free, AContactThatWasLostIsRemembered) {
  for (const double lost_at_mm : {8.0, kUnseen_mm}) {
    SCOPED_TRACE(lost_at_mm);
    std::uint32_t told = kBeyond;
    free.lose(probe(lost_at_mm), told);
    EXPECT_EQ(told, kBeyond | kLost);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(move(8), 0);
      EXPECT_EQ(faults, kLost);
    }
    EXPECT_EQ(move(kUnseen_mm), 0);
    EXPECT_EQ(faults, kBeyond);
    EXPECT_EQ(move(12), 0);
    EXPECT_EQ(faults, 0U);
    EXPECT_NEAR(move(8), 10, kRounding_mm);
    EXPECT_EQ(move(8), 0);
    EXPECT_EQ(faults, kInside);
  }
  std::uint32_t told = 0;
  free.lose(probe(8), told);
  free.release(probe(8));
  EXPECT_EQ(move(8), 0);
  EXPECT_EQ(faults, kInside);
  told = 0;
  free.lose(probe(12), told);  // outside, it is free
  EXPECT_EQ(told, 0U);
  EXPECT_NEAR(move(8), 10, kRounding_mm);
}

TEST_F(Free, SeesAnEditOnce) {
  EXPECT_FALSE(free.see(0));
  EXPECT_TRUE(free.see(1));
  EXPECT_FALSE(free.see(1));
  EXPECT_TRUE(free.see(0));
}

TEST_F(Free, MaterialOverTheFreePlaceIsNoEntryButHasAWayOut) {
  const Ground higher(14e-3), everything(1);
  EXPECT_EQ(move(12), 0);
  free.see(1);
  EXPECT_NEAR(moveIn(higher, 11.5), 14, kRounding_mm);
  EXPECT_EQ(faults, 0U);
  // Where no tick could see the tool meanwhile, too.
  EXPECT_EQ(move(12), 0);
  free.see(2);
  EXPECT_EQ(moveIn(higher, kUnseen_mm), 0);
  EXPECT_NEAR(moveIn(higher, 11.5), 14, kRounding_mm);
  // Without a way out it waits.
  EXPECT_EQ(move(12), 0);
  free.see(3);
  EXPECT_EQ(moveIn(everything, 11.5), 0);
  EXPECT_EQ(faults, kInside);
  EXPECT_EQ(moveIn(higher, 11.5), 0);
  EXPECT_EQ(faults, kInside);
}

// The free place is still free: the way from there is searched in the volume as it is now.
TEST_F(Free, AnEditBesideTheFreePlaceIsEntered) {
  const Ground higher(11e-3);
  EXPECT_EQ(move(12), 0);
  free.see(1);
  EXPECT_NEAR(moveIn(higher, 9), 11, kRounding_mm);
  EXPECT_EQ(faults, 0U);
  // One that was in the object all the while is not buried by an edit.
  free.release(probe(9));
  free.see(2);
  EXPECT_EQ(moveIn(higher, 9), 0);
  EXPECT_EQ(faults, kInside);
}

TEST_F(Free, GoesOnFromWhereAnotherAlgorithmWasFree) {
  free.resume(at(12));
  EXPECT_NEAR(move(9), 10, kRounding_mm);
  free.resume(at(9));  // that is in the object: buried, so the nearest way out
  EXPECT_NEAR(move(8), 10, kRounding_mm);
}

}  // namespace free_motion_test
}  // namespace palpate
