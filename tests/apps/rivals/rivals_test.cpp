// SPDX-License-Identifier: Apache-2.0
// That the rivals do the job that they are timed for: their results against loops written out here, inside the volume
// (at the border libraries differ). Those of Python are held too where they are installed.
#include "apps/rivals/rivals.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <random>

#include <gmock/gmock.h>

namespace palpate {
namespace rivals_test {

constexpr int kMargin = 6;  // farther than any of the jobs reaches

class Rivals : public testing::Test {
 protected:
  Rivals() {
    std::mt19937 bits(1);
    for (float& density : densities_) density = static_cast<float>(bits() % 2001) - 1000.0F;
  }

  [[nodiscard]] float at(int i, int j, int k) const { return densities_[indexOf(i, j, k)]; }
  [[nodiscard]] std::size_t indexOf(int i, int j, int k) const {
    return i + size_.x() * (j + size_.y() * static_cast<std::size_t>(k));
  }

  std::vector<Rival> all(const std::string& job) {
    const RivalField field{size_, {1e-3, 1e-3, 2e-3}, densities_};
    std::vector<Rival> rivals = itkRivals(job, field, 2);
    openvdb_.emplace(field, 2);
    for (Rival& rival : openvdb_->rivalsOf(job)) rivals.push_back(std::move(rival));
    EXPECT_EQ(python_.load(field), std::nullopt);
    for (Rival& rival : python_.rivalsOf(job)) rivals.push_back(std::move(rival));
    return rivals;
  }

  // The largest difference from `truth` at voxels inside, component by component.
  double worst(const Rival& rival, int components, const std::function<double(int, int, int, int)>& truth) const {
    std::vector<float> result;
    const RunCost cost = rival.run(&result);
    EXPECT_GT(cost.wall_ms, 0);
    if (result.size() != densities_.size() * static_cast<std::size_t>(components)) {
      ADD_FAILURE() << "a result of " << result.size() << " floats";
      return 1e30;
    }
    double most = 0;
    for (int k = kMargin; k < size_.z() - kMargin; ++k) {
      for (int j = kMargin; j < size_.y() - kMargin; ++j) {
        for (int i = kMargin; i < size_.x() - kMargin; ++i) {
          for (int c = 0; c < components; ++c) {
            const auto place = indexOf(i, j, k) * static_cast<std::size_t>(components) + static_cast<std::size_t>(c);
            most = std::max(most, std::abs(static_cast<double>(result[place]) - truth(i, j, k, c)));
          }
        }
      }
    }
    return most;
  }

  std::array<float, 27> around(int i, int j, int k) const {
    std::array<float, 27> values{};
    for (int n = 0; n < 27; ++n)
      values[static_cast<std::size_t>(n)] = at(i - 1 + n % 3, j - 1 + n / 3 % 3, k - 1 + n / 9);
    return values;
  }
  [[nodiscard]] float highest(int i, int j, int k) const { return std::ranges::max(around(i, j, k)); }
  [[nodiscard]] float lowest(int i, int j, int k) const { return std::ranges::min(around(i, j, k)); }
  // Of the 27 voxels around, the outer operator of the inner one's results.
  template <class Inner>
  double overBox(int i, int j, int k, bool most, const Inner& inner) const {
    float best = inner(i, j, k);
    for (int n = 0; n < 27; ++n) {
      const float value = inner(i - 1 + n % 3, j - 1 + n / 3 % 3, k - 1 + n / 9);
      best = most ? std::max(best, value) : std::min(best, value);
    }
    return static_cast<double>(best);
  }

  Vec3i size_{23, 21, 18};
  std::vector<float> densities_ = std::vector<float>(static_cast<std::size_t>(size_.prod()));
  std::optional<OpenVdbRivals> openvdb_;
  PythonRivals python_{2};
};

// Differences of whole numbers up to 2000, halved, over 1 or 2 mm: exact in floats.
TEST_F(Rivals, TakeTheCentralDifference) {
  const auto rivals = all("gradient central");
  EXPECT_GE(rivals.size(), 2U);  // ITK and OpenVDB
  for (const Rival& rival : rivals) {
    const auto truth = [&](int i, int j, int k, int c) {
      const Vec3i e = Vec3i::Unit(c);
      const double difference = static_cast<double>(at(i + e.x(), j + e.y(), k + e.z())) -
                                static_cast<double>(at(i - e.x(), j - e.y(), k - e.z()));
      return difference / (c == 2 ? 4 : 2);
    };
    // OpenVDB's gradient on a grid of unlike spacing is of the first voxel's axes: exact too.
    EXPECT_LE(worst(rival, 3, truth), 1e-3) << rival.library;  // SciPy and OpenVDB multiply by an inverse: some ulp
  }
}

TEST_F(Rivals, TakeTheMiddleOf27) {
  const auto rivals = all("median:1");
  EXPECT_GE(rivals.size(), 2U);
  for (const Rival& rival : rivals) {
    EXPECT_EQ(worst(rival, 1,
                    [&](int i, int j, int k, int) {
                      auto values = around(i, j, k);
                      std::ranges::nth_element(values, values.begin() + 13);
                      return static_cast<double>(values[13]);
                    }),
              0)
        << rival.library;
  }
}

TEST_F(Rivals, CloseWithABox) {
  const auto rivals = all("close:1");
  EXPECT_GE(rivals.size(), 3U);  // three algorithms of ITK
  for (const Rival& rival : rivals) {
    if (rival.way.find("ball") != std::string::npos) continue;  // VTK's, which says so
    EXPECT_EQ(worst(rival, 1,
                    [&](int i, int j, int k, int) {
                      return overBox(i, j, k, false, [&](int x, int y, int z) { return highest(x, y, z); });
                    }),
              0)
        << rival.library << " " << rival.way;
  }
}

TEST_F(Rivals, OpenWithABox) {
  for (const Rival& rival : all("open:1")) {
    EXPECT_EQ(worst(rival, 1,
                    [&](int i, int j, int k, int) {
                      return overBox(i, j, k, true, [&](int x, int y, int z) { return lowest(x, y, z); });
                    }),
              0);
  }
}

// Which SciPy alone has with a box.
TEST_F(Rivals, DilateAndErodeWithABox) {
  for (const MissingRival& missing : python_.missing()) {
    if (missing.library == "SciPy") GTEST_SKIP() << "no SciPy: " << missing.why;
  }
  for (const char* job : {"dilate:1", "erode:1"}) {
    const std::vector<Rival> rivals = all(job);
    EXPECT_EQ(std::ranges::count(rivals, "SciPy", &Rival::library), 1) << job;
    for (const Rival& rival : rivals) {
      if (rival.library != "SciPy") continue;
      EXPECT_EQ(worst(rival, 1,
                      [&](int i, int j, int k, int) {
                        return static_cast<double>(job[0] == 'd' ? highest(i, j, k) : lowest(i, j, k));
                      }),
                0);
    }
  }
}

// Of an impulse 1, along one axis, a kernel of sigma 1.5 leaves in the middle: sampled and scaled to a sum of 1,
// 0.2660; of the discrete scale space, as ITK has it, exp(-t) I0(t) = 0.2874 with t = 2.25; of OpenVDB's four box means
// of three voxels 19/81. To the third power for three axes. What ITK cuts off beyond 11 taps is below its 1e-3.
TEST_F(Rivals, SmoothAsFar) {
  std::fill(densities_.begin(), densities_.end(), 0.0F);
  const Vec3i middle(11, 10, 9);
  densities_[indexOf(middle.x(), middle.y(), middle.z())] = 1000;
  const auto rivals = all("gaussian:1.5");
  EXPECT_GE(rivals.size(), 2U);
  for (const Rival& rival : rivals) {
    std::vector<float> result;
    static_cast<void>(rival.run(&result));
    ASSERT_EQ(result.size(), densities_.size()) << rival.library;
    const bool boxes = rival.library == "OpenVDB";
    const int reach = boxes ? 4 : 5;
    const auto along = [&](int d) { return result[indexOf(middle.x() + d, middle.y(), middle.z())]; };
    EXPECT_NE(along(reach), 0.0F) << rival.library;
    EXPECT_EQ(along(reach + 1), 0.0F) << rival.library;
    const double most = boxes ? 19.0 / 81 : rival.library == "ITK" ? 0.2874 : 0.2660;
    EXPECT_NEAR(static_cast<double>(along(0)), 1000 * most * most * most, 0.004 * 24) << rival.library;
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
      for (int j = -reach; j <= reach; ++j) {
        for (int i = -reach; i <= reach; ++i) {
          sum += static_cast<double>(result[indexOf(middle.x() + i, middle.y() + j, middle.z() + k)]);
        }
      }
    }
    EXPECT_NEAR(sum, 1000, 1) << rival.library;
  }
}

// Against the clocks of POSIX, read outside and inside of what is timed. Some systems account for processor time in
// hundredths of a second, so that much may be missing or be of the time before.
TEST(RunCost, IsTheTimeOfTheClockAndOfTheProcessors) {
  const auto now_ms = [](clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  };
  double inner_wall_ms = 0, inner_cpu_ms = 0;
  const double wall_ms = now_ms(CLOCK_MONOTONIC), cpu_ms = now_ms(CLOCK_PROCESS_CPUTIME_ID);
  const RunCost cost = costOf([&] {
    const double begin_wall_ms = now_ms(CLOCK_MONOTONIC), begin_cpu_ms = now_ms(CLOCK_PROCESS_CPUTIME_ID);
    do {
      inner_wall_ms = now_ms(CLOCK_MONOTONIC) - begin_wall_ms;
      inner_cpu_ms = now_ms(CLOCK_PROCESS_CPUTIME_ID) - begin_cpu_ms;
    } while (inner_cpu_ms < 60);
  });
  EXPECT_GE(cost.wall_ms, inner_wall_ms);
  EXPECT_LE(cost.wall_ms, now_ms(CLOCK_MONOTONIC) - wall_ms);
  EXPECT_GE(cost.cpu_ms, inner_cpu_ms - 10);
  EXPECT_LE(cost.cpu_ms, now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_ms + 10);
}

// A ball of 7 mm in the middle. A pixel whose ray passes its rim closer than the longest voxel edge is not asked.
TEST_F(Rivals, DrawABall) {
  const Vec3 spacing_mm(1, 1, 2), middle_mm = Vec3(11, 10, 8.5).cwiseProduct(spacing_mm);
  constexpr double kRadius_mm = 7;
  for (int k = 0; k < size_.z(); ++k) {
    for (int j = 0; j < size_.y(); ++j) {
      for (int i = 0; i < size_.x(); ++i) {
        const double from_middle = (Vec3(i, j, k).cwiseProduct(spacing_mm) - middle_mm).norm();
        densities_[indexOf(i, j, k)] = static_cast<float>(100 + 10 * (kRadius_mm - from_middle));
      }
    }
  }
  // Off the middle and unlike in x and y, so that a mirrored or turned picture differs.
  const Vec3 from = Vec3(0.5, -0.8, 0.3).normalized();
  const RivalView view{lookAt(1e-3 * (middle_mm + Vec3(3, 2, 3)), from, 0.06, Vec3::UnitZ(), 80, 60, 0.6), 100};
  all("none");
  std::vector<Rival> rivals = openvdb_->picturesOf(view);
  ASSERT_EQ(rivals.size(), 1U);
  PythonRivals on_a_display(2, {"xvfb-run", "-a", "/usr/bin/python3"});
  EXPECT_EQ(on_a_display.load({size_, {1e-3, 1e-3, 2e-3}, densities_}), std::nullopt);
  for (Rival& rival : on_a_display.rivalsOf("picture")) rivals.push_back(std::move(rival));
  if (rivals.size() > 1) on_a_display.see(view);
  for (const Rival& rival : rivals) {
    std::vector<float> covered;
    EXPECT_GT(rival.run(&covered).wall_ms, 0);
    ASSERT_EQ(covered.size(), std::size_t{80 * 60}) << rival.way;
    int wrong = 0, asked = 0;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 80; ++x) {
        const Vec3 ray = view.camera.rayThrough(x + 0.5, y + 0.5);
        const double passes_mm = 1e3 * (1e-3 * middle_mm - view.camera.position_W).cross(ray).norm();
        if (std::abs(passes_mm - kRadius_mm) < 2) continue;
        ++asked;
        wrong += (covered[static_cast<std::size_t>(80 * y + x)] > 0) != (passes_mm < kRadius_mm);
      }
    }
    EXPECT_EQ(wrong, 0) << rival.library;
    EXPECT_GT(asked, 3000);
  }
  if (rivals.size() == 1) GTEST_SKIP() << "VTK's picture was not looked at: xvfb-run, xauth or VTK is not installed";
}

TEST_F(Rivals, RunWhatTheyOfferBesides) {
  for (const char* job : {"diffuse:5:kappa=200", "bilateral:1:range=200", "gradient sobel", "gradient gaussian:1.5"}) {
    for (const Rival& rival : all(job)) EXPECT_GT(rival.run(nullptr).wall_ms, 0) << rival.library << " " << rival.way;
  }
  EXPECT_EQ(itkRivals("diffuse:5:kappa=200", {size_, Vec3::Constant(1e-3), densities_}, 2).size(), 2U);
  EXPECT_TRUE(itkRivals("distance:3", {size_, Vec3::Constant(1e-3), densities_}, 2).empty());
}

}  // namespace rivals_test
}  // namespace palpate
