// SPDX-License-Identifier: Apache-2.0
// What the engine publishes: where windows lie, when they come, what they hold.
#include "engine/service/engine.hpp"

#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/reference/window.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace engine_test {

Volume knot() {
  return makeVolume(*makePhantom("phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm"));
}

struct Prepared {
  Volume volume = knot();
  Engine engine;
  explicit Prepared(bool gradient_all = false, bool picture = false)
      : engine(volume, plan(gradient_all, picture), 0, "") {}

  static Plan plan(bool gradient_all, bool picture) {
    return makePlan({.gradient_all = gradient_all, .draws = picture});
  }
  Vec3 at(double i, double j, double k) const { return volume.lattice().toWorld({i, j, k}); }
};

TEST(Engine, FirstWindowIsVersionOneAroundTheTool) {
  Prepared p;
  EXPECT_EQ(p.engine.exchange().latest().version, 0U);
  EXPECT_TRUE(p.engine.publishAround(p.at(30, 26, 23), 1000));
  const SampleWindow& window = p.engine.exchange().latest();
  EXPECT_EQ(window.version, 1U);
  EXPECT_EQ(window.stamp_ns, 1000);
  EXPECT_EQ(p.engine.exchange().confirmedAt_ns(), 1000);
  EXPECT_EQ(window.size, Vec3i(32, 32, 32));
  // The tool is in the middle of the window, within the half voxel of rounding.
  const Vec3 in_window = window.lattice.toIndex(p.at(30, 26, 23));
  EXPECT_LT((in_window - Vec3::Constant(15.5)).cwiseAbs().maxCoeff(), 1.0);
}

TEST(Engine, ConfirmsInsteadOfPublishingWhileTheToolStaysNear) {
  Prepared p;
  p.engine.publishAround(p.at(30, 26, 23), 1000);
  EXPECT_FALSE(p.engine.publishAround(p.at(33, 26, 23), 2000));
  EXPECT_EQ(p.engine.exchange().latest().version, 1U);
  EXPECT_EQ(p.engine.exchange().confirmedAt_ns(), 2000);
  EXPECT_TRUE(p.engine.publishAround(p.at(40, 26, 23), 3000));
  EXPECT_EQ(p.engine.exchange().latest().version, 2U);
}

TEST(Engine, SaysWhichFacesAreTheVolumesBorder) {
  Prepared p;
  p.engine.publishAround(p.at(0, 26, 46), 1);
  const SampleWindow& window = p.engine.exchange().latest();
  EXPECT_TRUE(window.low_is_border[0]);
  EXPECT_FALSE(window.high_is_border[0]);
  EXPECT_FALSE(window.low_is_border[1]);
  EXPECT_TRUE(window.high_is_border[2]);
}

// With every brick's gradient the window equals the twin's, and through the exchange too.
TEST(Engine, WindowsHoldTheTwinsSamples) {
  Prepared p(true);
  p.engine.publishAround(p.at(20, 30, 25), 1);
  const SampleWindow& window = p.engine.exchange().latest();
  const Vec3i first = p.volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
  const auto expected = reference::windowSamples(reference::denseField(p.volume), first, window.size);
  EXPECT_EQ(std::memcmp(window.samples, expected.data(), expected.size() * sizeof(Sample)), 0);
}

// With the gradients of active bricks alone, every cell that the isosurface crosses has all its corners' gradients.
TEST(Engine, ActiveBricksServeEveryCellOnTheSurface) {
  Prepared p;
  const reference::DenseField field = reference::denseField(p.volume);
  for (const Vec3& tool : {Vec3(16, 16, 16), Vec3(44, 36, 30), Vec3(30, 26, 23)}) {
    p.engine.publishAround(p.at(tool.x(), tool.y(), tool.z()), 1);
    const SampleWindow& window = p.engine.exchange().latest();
    const Vec3i first = p.volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
    const auto expected = reference::windowSamples(field, first, window.size);
    const auto at = [&](int i, int j, int k) { return (k * window.size.y() + j) * window.size.x() + i; };
    int crossed = 0;
    for (int k = 0; k + 1 < window.size.z(); ++k) {
      for (int j = 0; j + 1 < window.size.y(); ++j) {
        for (int i = 0; i + 1 < window.size.x(); ++i) {
          int above = 0;
          for (int c = 0; c < 8; ++c)
            above += window.samples[at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))].density > 0;
          if (above == 0 || above == 8) continue;
          ++crossed;
          for (int c = 0; c < 8; ++c) {
            const auto corner = static_cast<std::size_t>(at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
            ASSERT_EQ(std::memcmp(&window.samples[corner], &expected[corner], sizeof(Sample)), 0);
          }
        }
      }
    }
    EXPECT_GT(crossed, 100);
  }
}

void expectTheTwinsWindow(Engine& engine, const Volume& volume, const char* way, const SampleFormat& format) {
  const SampleWindow& window = engine.exchange().latest();
  const Vec3i first = volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
  const std::vector<Sample> expected =
      reference::windowSamples(reference::denseField(volume), first, window.size, gradientOperator(way), format);
  EXPECT_EQ(std::memcmp(window.samples, expected.data(), expected.size() * sizeof(Sample)), 0);
}

// Whatever the operator and the form in which samples are stored, the servo gets floats: the twin's, before an edit and
// after it. A smoothed gradient comes with the density as it is.
TEST(Engine, WindowsHoldTheTwinsSamplesOfEveryOperatorAndForm) {
  for (const char* name : {"central", "sobel", "central4", "gaussian:1.5mm"}) {
    for (const bool half : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", name, half ? "half" : "float"));
      Volume volume = knot();
      const EngineRequest request{.gradient_all = true, .gradient_operator = name, .half_samples = half, .edits = true};
      Engine engine(volume, makePlan(request), 0, "");
      engine.publishAround(volume.lattice().toWorld({20, 30, 25}), 1);
      const SampleFormat format =
          half ? halfSamples(0, volume.minimum(), volume.maximum(), volume.lattice().spacing_m) : SampleFormat{};
      expectTheTwinsWindow(engine, volume, name, format);
      engine.allowEdits(brushProfile(volume, 0));
      EditCommand hole;
      hole.from_W = hole.to_W = volume.lattice().toWorld({22, 28, 25});
      hole.radius_m = 4e-3;
      EXPECT_TRUE(engine.edit(std::span(&hole, 1), 2).published);
      EXPECT_GT(engine.readBack(volume), 0U);
      expectTheTwinsWindow(engine, volume, name, format);
    }
  }
}

// Filters, smoothing and gradients tell how far they are, in this order, and end where what they tell throws.
TEST(Engine, TellsHowFarItsStartIsAndCanBeCancelledInEachPass) {
  const Volume volume = knot();
  const EngineRequest request{.filter = "diffuse:3:kappa=100", .gradient_operator = "gaussian:1"};
  std::vector<std::string> passes;
  double last = 0;
  const Engine engine(volume, makePlan(request), 0, "", 0, [&](const char* pass, double done) {
    if (passes.empty() || passes.back() != pass) {
      passes.emplace_back(pass);
      last = 0;
    }
    EXPECT_GE(done, last) << pass;
    EXPECT_LE(done, 1) << pass;
    last = done;
  });
  ASSERT_EQ(passes, (std::vector<std::string>{"filter", "smoothing", "gradient"}));
  EXPECT_EQ(last, 1);
  for (const std::string& cancelled : passes) {
    const auto stop = [&](const char* pass, double) {
      if (pass == cancelled) throw Error(Error::Code::kCancelled, pass, "stopped", "start it again");
    };
    try {
      const Engine never(volume, makePlan(request), 0, "", 0, stop);
      ADD_FAILURE() << cancelled << " went on";
    } catch (const Error& error) {
      EXPECT_EQ(error.input(), cancelled);
    }
  }
}

// A smoothed field is kept for a plan with edits only.
TEST(Engine, RefusesEditsOfAPlanThatKeptNoSmoothedField) {
  const Volume volume = knot();
  EngineRequest request{.gradient_operator = "gaussian:1"};
  Engine without(volume, makePlan(request), 0, "");
  EXPECT_THROW(without.allowEdits(brushProfile(volume, 0)), Error);
  request.edits = true;
  Engine with(volume, makePlan(request), 0, "");
  const auto smoothedBytes = [](const Engine& engine) {
    for (const MemoryFigure& figure : engine.memory())
      if (figure.name == "gpu smoothed") return figure.bytes;
    return std::uint64_t{1};
  };
  EXPECT_EQ(smoothedBytes(without), 0U);
  EXPECT_GT(smoothedBytes(with), std::uint64_t{1} << 16U);
}

TEST(Engine, SaysWhatItLeftOut) {
  const Prepared some;
  const Prepared all(true);
  EXPECT_LT(some.engine.planFacts().gradient_bricks, all.engine.planFacts().gradient_bricks);
  EXPECT_EQ(all.engine.planFacts().gradient_bricks, all.engine.planFacts().bricks);
}

TEST(Engine, RefusesToDrawWhatWasNotPlanned) {
  Prepared p;
  EXPECT_THROW((void)p.engine.draw({}), Error);
}

// A budget that is a byte short of the densities is refused for them, before anything is uploaded; one that holds them
// and no sample is refused for those.
TEST(Engine, SaysWhatExceedsTheBudget) {
  const Volume volume = knot();
  const std::uint64_t densities = volume.storedBricks() * kBrickVoxels * sizeof(float);
  const auto refusal = [&](std::uint64_t budget) -> std::string {
    try {
      const Engine engine(volume, Prepared::plan(false, false), 0, "", budget);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(refusal(densities - 1), testing::HasSubstr("its densities take"));
  EXPECT_THAT(refusal(densities), testing::Not(testing::HasSubstr("its densities take")));
  EXPECT_THAT(refusal(densities), testing::HasSubstr("samples at its surface"));
  EXPECT_EQ(refusal(10 * densities + (std::uint64_t{1} << 30U)), "nothing");
}

// Before edits are allowed nothing has changed, and nothing can be read back.
TEST(Engine, WithoutEditsTheVolumeIsAtItsFirstVersion) {
  Prepared p;
  const std::vector<float> before = p.volume.toDense();
  EXPECT_EQ(p.engine.editVersion(), 0U);
  EXPECT_EQ(p.engine.readBack(p.volume), 0U);
  EXPECT_EQ(p.volume.toDense(), before);
  EXPECT_THROW(p.engine.edit({}, 0), Error);
}

// The window after an edit carries its version and holds the edited volume, in the box of the last one.
TEST(Engine, PublishesTheEditedVolumeWithItsVersion) {
  Prepared p(true);
  EditCommand hole;
  hole.from_W = hole.to_W = p.at(30, 26, 23);
  hole.radius_m = 4e-3;
  EXPECT_THROW((void)p.engine.edit(std::span(&hole, 1), 1), Error);  // not allowed yet
  p.engine.allowEdits(brushProfile(p.volume, 0));
  p.engine.publishAround(p.at(30, 26, 23), 1000);
  EXPECT_EQ(p.engine.exchange().latest().edit_version, 0U);
  const Vec3 origin = p.engine.exchange().latest().lattice.origin_W;
  const Engine::EditResult result = p.engine.edit(std::span(&hole, 1), 2000);
  EXPECT_EQ(result.version, 1U);
  ASSERT_TRUE(result.published);
  const SampleWindow& window = p.engine.exchange().latest();
  EXPECT_EQ(window.version, 2U);
  EXPECT_EQ(window.edit_version, 1U);
  EXPECT_EQ(window.stamp_ns, 2000);
  EXPECT_EQ(window.lattice.origin_W, origin);
  EXPECT_GT(p.engine.readBack(p.volume), 0U);
  const Vec3i first = p.volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
  const auto expected = reference::windowSamples(reference::denseField(p.volume), first, window.size);
  EXPECT_EQ(std::memcmp(window.samples, expected.data(), expected.size() * sizeof(Sample)), 0);
  // Later windows carry it too.
  EXPECT_TRUE(p.engine.publishAround(p.at(45, 26, 23), 3000));
  EXPECT_EQ(p.engine.exchange().latest().edit_version, 1U);
}

}  // namespace engine_test
}  // namespace palpate
