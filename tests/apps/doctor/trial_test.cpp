// SPDX-License-Identifier: Apache-2.0
// The trial of clock and device, with a device whose answers are known. Nothing here depends on how fast.
#include "apps/doctor/trial.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace trial_test {

// Goes 1 mm a tick along y, fails every fourth time, and keeps what it was told.
class Walking final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "walking"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return ForceOff::kUncalibrated; }
  [[nodiscard]] std::vector<DeviceFigure> figures() const override {
    return {{"reports_received", static_cast<double>(reads)}};
  }
  [[nodiscard]] bool read(Vec3& p) noexcept override {
    p = Vec3(0, 1e-3 * reads, 0);
    return ++reads % 4 != 0;
  }
  [[nodiscard]] bool write(const Vec3& force) noexcept override {
    forces = forces && force.isZero(0);
    return true;
  }
  int reads = 0;
  bool forces = true;  // all were zero
};

TEST(Trial, ReadsTheDeviceAndTellsItNoForce) {
  Walking device;
  double share = 0;
  const TrialFigures trial = tryServo(&device, 500, 0.2, [&](double s) { share = s; });
  const int most = 100;
  EXPECT_GT(device.reads, 0);
  EXPECT_LE(device.reads, most);
  EXPECT_TRUE(device.forces);
  EXPECT_NEAR(trial.failed_share, 0.25 * device.reads / most, 0.011);
  EXPECT_NEAR(trial.skipped_share, 1 - static_cast<double>(device.reads) / most, 1e-12);
  EXPECT_NEAR(trial.motion_m, 1e-3 * (device.reads - 1), 1.1e-3);  // the last one may have failed
  EXPECT_NEAR(trial.reports_per_s * trial.seconds, device.reads, 1e-6);
  EXPECT_EQ(trial.force_off, ForceOff::kUncalibrated);
  EXPECT_LE(trial.late_p50_us, trial.late_p99_us);
  EXPECT_LE(trial.late_p99_us, trial.late_max_us);
  EXPECT_GE(trial.seconds, 0.19);
  EXPECT_GT(share, 0);
}

TEST(Trial, GoesWithoutADevice) {
  const TrialFigures trial = tryServo(nullptr, 500, 0.1, [](double) {});
  EXPECT_EQ(trial.reports_per_s, 0);
  EXPECT_EQ(trial.force_off, ForceOff::kNone);
  EXPECT_GE(trial.late_max_us, 0);
  EXPECT_EQ(trial.rate_hz, 500);
}

}  // namespace trial_test
}  // namespace palpate
