// SPDX-License-Identifier: Apache-2.0
// Another isovalue while windows go out and edits come in: against an engine that has every gradient, and against a
// new start.
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/service/engine.hpp"
#include "servo/window/window_exchange.hpp"
#include "tests/engine/passes/sample_bits.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace isovalue_test {

using testing::HasSubstr;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
constexpr std::int64_t kNow = 1;

// Density falls from the middle by 10 a voxel, with waves: the isosurfaces of far isovalues share no brick.
Volume hill() {
  const Vec3i size(70, 60, 50);
  Lattice lattice;
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) {
        const double r = (Vec3(i, j, k) - Vec3(35.2, 29.7, 24.9)).norm();
        values.push_back(static_cast<float>(300 - 10 * r + 8 * std::sin(0.7 * i) * std::cos(0.5 * j + 0.3 * k)));
      }
    }
  }
  return Volume::fromDense(size, lattice, values, {});
}

// Every sample that windows show, by voxel.
std::vector<Sample> allSamples(Engine& engine, const Volume& volume) {
  const Vec3i& size = volume.size();
  std::vector<Sample> all(static_cast<std::size_t>(size.prod()));
  for (int k = 0; k < size.z(); k += 32) {
    for (int j = 0; j < size.y(); j += 32) {
      for (int i = 0; i < size.x(); i += 32) {
        EXPECT_TRUE(engine.publishAround(volume.lattice().toWorld(Vec3(i + 15.5, j + 15.5, k + 15.5)), kNow));
        const SampleWindow& window = engine.exchange().latest();
        const Vec3i first = volume.lattice().toIndex(window.lattice.origin_W).array().round().cast<int>();
        const Sample* sample = window.samples;
        for (int z = 0; z < window.size.z(); ++z) {
          for (int y = 0; y < window.size.y(); ++y) {
            for (int x = 0; x < window.size.x(); ++x) {
              const Vec3i at = first + Vec3i(x, y, z);
              all[(static_cast<std::size_t>(at.z()) * size.y() + at.y()) * size.x() + at.x()] = *sample++;
            }
          }
        }
      }
    }
  }
  return all;
}

bool isZero(const Sample& sample) {
  return sample.gradient_i == 0 && sample.gradient_j == 0 && sample.gradient_k == 0;
}

// `want` and `got` agree where `want` has a gradient, and nowhere is one that is not the true one.
void expectAtLeast(const std::vector<Sample>& got, const std::vector<Sample>& want, const std::vector<Sample>& truth) {
  std::size_t lacking = 0, wrong = 0, gradients = 0;
  for (std::size_t v = 0; v < got.size(); ++v) {
    const bool same = sameBits(got[v], truth[v]);
    wrong += same || (isZero(got[v]) && got[v].density == truth[v].density) ? 0U : 1U;
    lacking += isZero(want[v]) || same ? 0U : 1U;
    gradients += isZero(want[v]) ? 0U : 1U;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(lacking, 0U);
  EXPECT_GT(gradients, 5000U);
}

bool same(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Sample)) == 0;
}

struct Field {
  const char* filter;
  const char* gradient_operator;
  bool all = false;
};
class OtherIsovalue : public testing::TestWithParam<Field> {
 protected:
  [[nodiscard]] Plan plan(bool all) const {
    return makePlan({.filter = GetParam().filter,
                     .gradient_all = all,
                     .gradient_operator = GetParam().gradient_operator,
                     .edits = edits_,
                     .other_isovalues = true});
  }
  [[nodiscard]] std::unique_ptr<Engine> engineAt(double isovalue, const Volume& volume, bool all = false) const {
    return std::make_unique<Engine>(volume, plan(all || GetParam().all), isovalue, "");
  }
  // As if it had been started so.
  void expectAsNew(Engine& engine, const Volume& volume, double isovalue) const {
    const auto fresh = engineAt(isovalue, volume);
    EXPECT_EQ(engine.isovalue(), isovalue);
    EXPECT_EQ(engine.planFacts().gradient_bricks, fresh->planFacts().gradient_bricks);
    EXPECT_TRUE(same(allSamples(engine, volume), allSamples(*fresh, volume)));
  }
  bool edits_ = false;
  Volume volume_ = hill();
};
INSTANTIATE_TEST_SUITE_P(Fields, OtherIsovalue,
                         testing::Values(Field{"", "central"}, Field{"", "gaussian:1.5"},
                                         Field{"gaussian:0.8", "sobel"}, Field{"", "central", true}));

TEST_P(OtherIsovalue, ShowsTheSamplesOfBothUntilTheLastOneIsEnded) {
  const auto truth = allSamples(*engineAt(200, volume_, true), volume_);
  const auto before = allSamples(*engineAt(200, volume_), volume_);
  const auto after = allSamples(*engineAt(90, volume_), volume_);
  const auto engine = engineAt(200, volume_);
  engine->beginIsovalue(90);
  for (int portions = 0; !engine->gatherIsovalue(17, kNow); ++portions) {
    EXPECT_EQ(engine->isovalue(), 200);
    if (portions % 4 == 0) expectAtLeast(allSamples(*engine, volume_), before, truth);
    ASSERT_LT(portions, 100);
  }
  EXPECT_EQ(engine->isovalue(), 90);
  const auto both = allSamples(*engine, volume_);
  expectAtLeast(both, before, truth);
  expectAtLeast(both, after, truth);
  engine->endIsovalue(engine->isovalue());
  expectAsNew(*engine, volume_, 90);
}

TEST_P(OtherIsovalue, ThatIsGivenUpLeavesNothing) {
  const auto engine = engineAt(200, volume_);
  engine->beginIsovalue(90);
  EXPECT_EQ(engine->gatherIsovalue(17, kNow), GetParam().all);
  engine->endIsovalue(engine->isovalue());
  expectAsNew(*engine, volume_, GetParam().all ? 90 : 200);
  engine->beginIsovalue(120);
  EXPECT_EQ(engine->gatherIsovalue(17, kNow), GetParam().all);
  engine->beginIsovalue(30);  // instead
  EXPECT_TRUE(engine->gatherIsovalue(kAll, kNow));
  engine->endIsovalue(engine->isovalue());
  expectAsNew(*engine, volume_, 30);
}

// Brushes put their surface where the field has the isovalue of the start, so what they change about the others' bricks
// they cannot know.
TEST_P(OtherIsovalue, AndEditsInBetweenEndAsANewStart) {
  edits_ = true;
  double isovalue = 120;
  const auto engine = engineAt(isovalue, volume_);
  engine->allowEdits(brushProfile(volume_, isovalue));
  RandomEdits random(volume_.size(), volume_.lattice(), -250, 350, 7);
  const auto edit = [&] {
    const std::vector<EditCommand> commands = {random.next()};
    engine->edit(commands, kNow);
  };
  for (int round = 0; round < 12; ++round) {
    double next = isovalue;
    while (next == isovalue) next = std::floor(random.between(-100, 250));
    if (random.pick(4) == 0) {
      engine->beginIsovalue(-120);                           // and is given up for the next
      if (engine->gatherIsovalue(2, kNow)) isovalue = -120;  // there was little to gather
      edit();
    }
    engine->beginIsovalue(next);
    while (!engine->gatherIsovalue(20, kNow))
      if (random.pick(3) == 0) edit();
    for (int n = random.pick(3); n > 0; --n) edit();
    engine->readBack(volume_);
    for (const double either : {isovalue, next}) {
      expectAtLeast(allSamples(*engine, volume_), allSamples(*engineAt(either, volume_), volume_),
                    allSamples(*engineAt(either, volume_, true), volume_));
    }
    engine->endIsovalue(engine->isovalue());
    isovalue = next;
    for (int n = random.pick(3); n > 0; --n) edit();
    engine->readBack(volume_);
    expectAsNew(*engine, volume_, isovalue);
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
  EXPECT_GT(engine->editVersion(), 12U);
}

// Whole bricks of one density, as undo gives them, between two isovalues too.
TEST_P(OtherIsovalue, KnowsWholeBricksThatAreReplaced) {
  edits_ = true;
  const auto engine = engineAt(120, volume_);
  engine->allowEdits(brushProfile(volume_, 120));
  engine->beginIsovalue(40);
  ASSERT_TRUE(engine->gatherIsovalue(kAll, kNow));
  engine->endIsovalue(engine->isovalue());
  const Vec3i counts = (volume_.size().array() + kBrickSize - 1) / kBrickSize;
  for (const float density : {20.0F, 60.0F, 20.0F, 130.0F}) {
    std::vector<BrickContent> bricks;
    for (int z = 1; z < 3; ++z)
      for (int x = 1; x < 4; ++x)
        bricks.push_back({static_cast<std::uint32_t>((z * counts.y() + 3) * counts.x() + x), {density}});
    engine->replace(bricks, kNow);
    engine->readBack(volume_);
    expectAsNew(*engine, volume_, 40);
  }
}

std::string refusal(Engine& engine, double isovalue, Error::Code code = Error::Code::kBadInput) {
  return refusalOf([&] { engine.beginIsovalue(isovalue); }, code);
}

TEST_P(OtherIsovalue, ThatNoDensityCrossesIsRefused) {
  const auto engine = engineAt(200, volume_);
  const auto before = allSamples(*engine, volume_);
  for (const double isovalue : {400.0, -300.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(refusal(*engine, isovalue), HasSubstr("there is no isosurface"));
  EXPECT_TRUE(engine->gatherIsovalue(kAll, kNow));  // there is nothing to gather
  EXPECT_EQ(engine->isovalue(), 200);
  EXPECT_TRUE(same(allSamples(*engine, volume_), before));
}

// The lowest density is an isovalue, since what is above it is object; the highest is none.
TEST(OtherIsovalueRefusals, BeginAtTheHighestDensity) {
  const Volume volume = hill();
  Engine engine(volume, makePlan({}), 100, "");
  EXPECT_EQ(refusal(engine, volume.minimum()), kNoRefusal);
  EXPECT_EQ(refusal(engine, volume.maximum()),
            fmt::format("isovalue {2:g}: the densities lie between {1:g} and {2:g}, so there is no isosurface; "
                        "give an isovalue from {1:g} to below {2:g}",
                        0, volume.minimum(), volume.maximum()));
}

TEST(OtherIsovalueRefusals, NameWhatHangsOnTheFirstOne) {
  const Volume volume = hill();
  const auto of = [&](const EngineRequest& request) {
    Engine engine(volume, makePlan(request), 100, "");
    return refusal(engine, engine.isovalue() + 1);
  };
  EXPECT_THAT(of({.half_samples = true}), HasSubstr("halves"));
  EXPECT_THAT(of({.distance = true}), HasSubstr("distance from the isosurface"));
  EXPECT_THAT(of({.gradient_operator = "gaussian:1.5"}), HasSubstr("was not kept"));
  EXPECT_EQ(of({.gradient_operator = "gaussian:1.5", .other_isovalues = true}), kNoRefusal);
  EXPECT_EQ(of({.gradient_operator = "gaussian:1.5", .edits = true}), kNoRefusal);
}

// With room for the first isovalue's samples alone: nothing changes, and a smaller isosurface still finds its room.
TEST(OtherIsovalueRefusals, ComeWhereThereIsNoRoom) {
  const Volume volume = hill();
  const std::uint64_t needs = Engine(volume, makePlan({}), 100, "").budgetedBytes();
  Engine engine(volume, makePlan({}), 100, "", needs + std::size_t{2} * kBrickVoxels * sizeof(Sample));
  const auto before = allSamples(engine, volume);
  EXPECT_THAT(refusal(engine, 0, Error::Code::kOutOfMemory), HasSubstr("samples"));
  EXPECT_EQ(engine.isovalue(), 100);
  EXPECT_TRUE(engine.gatherIsovalue(kAll, kNow));
  EXPECT_TRUE(same(allSamples(engine, volume), before));
  EXPECT_EQ(refusal(engine, 100.5), kNoRefusal);
  EXPECT_TRUE(engine.gatherIsovalue(kAll, kNow));
  EXPECT_EQ(engine.isovalue(), 100.5);
}

}  // namespace isovalue_test
}  // namespace palpate
