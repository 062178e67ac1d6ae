// SPDX-License-Identifier: Apache-2.0
// What the engine publishes: where windows lie, when they come, what they hold.
#include "engine/service/engine.hpp"

#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/reference/window.hpp"
#include "servo/window/window_exchange.hpp"
#include "tests/engine/passes/sample_bits.hpp"

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

// A window begins 15.5 voxels before the tool, rounded down, and holds for tools that would move it by less than six
// voxels along every axis; but one that would then lie at the volume's border comes at once. The domain of 61 x 53 x 47
// voxels has room for windows that begin at (0, 0, 0) up to (29, 21, 15).
TEST(Engine, GathersAnewSixVoxelsOnAndAtTheBorder) {
  Prepared p;
  const auto gathers = [&](const Vec3& from, const Vec3& to) {
    const Vec3 far = from.x() > 30 ? Vec3(0, 0, 0) : Vec3(60, 52, 46);
    p.engine.publishAround(p.at(far.x(), far.y(), far.z()), 1);
    EXPECT_TRUE(p.engine.publishAround(p.at(from.x(), from.y(), from.z()), 2));
    return p.engine.publishAround(p.at(to.x(), to.y(), to.z()), 3);
  };
  const Vec3 from(27.2, 26.2, 23.2);  // (11, 10, 7)
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_FALSE(gathers(from, from + sign * 5 * Vec3::Unit(axis)));
      EXPECT_TRUE(gathers(from, from + sign * 6 * Vec3::Unit(axis)));
    }
    Vec3 before = from, at = from, beyond = from;
    before[axis] = 17.2;  // 1
    at[axis] = 15.2;      // 0
    beyond[axis] = 13.2;
    EXPECT_TRUE(gathers(before, at));
    EXPECT_FALSE(gathers(at, beyond));
    const double last = Vec3(29, 21, 15)[axis];
    before[axis] = last - 2 + 15.7;
    at[axis] = last + 15.7;
    beyond[axis] = last + 18.7;
    EXPECT_TRUE(gathers(before, at));
    EXPECT_FALSE(gathers(at, beyond));
  }
}

TEST(Engine, SaysWhichFacesAreTheVolumesBorder) {
  Prepared p;
  p.engine.publishAround(p.at(0, 26, 46), 1);
  const SampleWindow& window = p.engine.exchange().latest();
  EXPECT_TRUE(window.low_is_border[0]);
  EXPECT_FALSE(window.high_is_border[0]);
  EXPECT_FALSE(window.low_is_border[1]);
  EXPECT_FALSE(window.high_is_border[1]);
  EXPECT_FALSE(window.low_is_border[2]);
  EXPECT_TRUE(window.high_is_border[2]);
  p.engine.publishAround(p.at(60, 0, 0), 2);
  const SampleWindow& other = p.engine.exchange().latest();
  EXPECT_FALSE(other.low_is_border[0]);
  EXPECT_TRUE(other.high_is_border[0]);
  EXPECT_TRUE(other.low_is_border[1]);
  EXPECT_FALSE(other.high_is_border[1]);
  EXPECT_TRUE(other.low_is_border[2]);
  EXPECT_FALSE(other.high_is_border[2]);
}

// Every figure by its name; 61 x 53 x 47 voxels are 8 x 7 x 6 bricks, and three windows hold 32^3 samples of 16 bytes.
TEST(Engine, SaysWhatItHolds) {
  const Volume volume = knot();
  for (const bool filtered : {false, true}) {
    const Engine engine(volume, makePlan({.filter = filtered ? "gaussian:1" : ""}), 0, "");
    const PlanFacts facts = engine.planFacts();
    EXPECT_EQ(facts.bricks, 336U);
    EXPECT_EQ(facts.stored_bricks, volume.storedBricks());
    EXPECT_GT(facts.gradient_bricks, 50U);
    if (filtered) {
      EXPECT_GT(facts.filtered_bricks, facts.stored_bricks);  // a Gaussian reaches into bricks beside them
    } else {
      EXPECT_EQ(facts.filtered_bricks, facts.stored_bricks);
    }
    const std::vector<MemoryFigure> figures = engine.memory();
    std::vector<std::string> names;
    std::uint64_t sum = 0;
    for (const MemoryFigure& figure : figures) {
      names.push_back(figure.name);
      sum += figure.bytes;
    }
    ASSERT_THAT(names, testing::ElementsAre("gpu brick pool", "gpu filtered", "gpu smoothed", "gpu samples",
                                            "gpu windows", "gpu picture", "gpu total"));
    EXPECT_GE(figures[0].bytes, facts.stored_bricks * 2048);
    EXPECT_GE(figures[1].bytes, filtered ? facts.filtered_bricks * 2048 : 0);
    EXPECT_EQ(figures[1].bytes > 0, filtered);
    EXPECT_EQ(figures[2].bytes, 0U);
    EXPECT_GE(figures[3].bytes, facts.gradient_bricks * 8192);
    EXPECT_EQ(figures[4].bytes, 3U * 32 * 32 * 32 * 16);
    EXPECT_EQ(figures[5].bytes, 0U);                      // nothing is drawn
    EXPECT_GE(figures[6].bytes, sum - figures[6].bytes);  // lists and scratch come on top
  }
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
            ASSERT_TRUE(sameBits(window.samples[corner], expected[corner]));
          }
        }
      }
    }
    EXPECT_GT(crossed, 100);
  }
}

void expectTheTwinsWindow(Engine& engine, const Volume& volume, const char* gradient_operator,
                          const SampleFormat& format) {
  const SampleWindow& window = engine.exchange().latest();
  const Vec3i first = volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
  const std::vector<Sample> expected = reference::windowSamples(reference::denseField(volume), first, window.size,
                                                                gradientOperator(gradient_operator), format);
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
  EXPECT_EQ(refusal(densities - 1),
            fmt::format("GPU memory for the volume: "
                        "its densities take {}, samples at its surface come on top, and the budget is {}; "
                        "raise --gpu-memory, or crop or resample the volume",
                        inMiB(densities), inMiB(densities - 1)));
  const std::size_t active = Prepared().engine.planFacts().gradient_bricks;
  EXPECT_THAT(refusal(densities),
              testing::HasSubstr(fmt::format("{} for samples at its surface), and the budget is {}; "
                                             "raise --gpu-memory to ",
                                             inMiB(active * kBrickVoxels * sizeof(Sample)), inMiB(densities))));
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

// The parts of an edit in their order, and the kernels' own where they are asked for.
TEST(Engine, NamesTheStagesOfAnEdit) {
  Prepared p;
  p.engine.allowEdits(brushProfile(p.volume, 0));
  p.engine.publishAround(p.at(30, 26, 23), 1);
  const auto stagesOf = [&](double radius_m) {
    EditCommand hole;
    hole.kind = EditKind::kRemove;
    hole.from_W = hole.to_W = p.at(30, 26, 23);
    hole.radius_m = radius_m;
    std::vector<std::string> names;
    for (const StageTime& stage : p.engine.edit(std::span(&hole, 1), 2).stages) names.push_back(stage.name);
    return names;
  };
  EXPECT_THAT(stagesOf(14e-3), testing::ElementsAre("plan", "record", "gpu", "publish", "settle"));
  p.engine.timeKernels(true);
  EXPECT_THAT(stagesOf(18e-3), testing::ElementsAre("plan", "record", "gpu", "edit", "bounds", "gradient", "window",
                                                    "publish", "settle"));
  p.engine.timeKernels(false);
  EXPECT_THAT(stagesOf(22e-3), testing::ElementsAre("plan", "record", "gpu", "publish", "settle"));
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
