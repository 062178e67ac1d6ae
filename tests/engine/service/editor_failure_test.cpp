// SPDX-License-Identifier: Apache-2.0
// An edit that fails anywhere on its way: either nothing has changed and editing goes on, or the editor is broken and
// gives nothing away any more. Memory is what fails here, at every allocation in turn; the rest of what may fail (the
// device) takes the same ways out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/service/editor.hpp"
#include "engine/service/engine.hpp"
#include "failing_memory.hpp"
#include "servo/window/window_exchange.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace editor_failure_test {

using ::testing::HasSubstr;

// Half of it object, and two bricks that have storage.
Volume halves() {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(1e-3);
  return Volume::fromBricks({40, 40, 40}, lattice, {}, [](const Vec3i& brick, float* values) {
    std::fill_n(values, kBrickVoxels, brick.x() < 2 ? 100.0F : -100.0F);
    const bool is_constant = brick != Vec3i(3, 3, 3) && brick != Vec3i(0, 0, 0);
    if (!is_constant) values[17] = -90;
    return is_constant;
  });
}

struct Edited {
  Volume volume = halves();
  gpu::Transfer transfer;
  BrickPool pool;
  std::unique_ptr<FilterChain> filters, smoothing;
  BrickBoundsPass bounds;
  SampleStore store;
  GradientPass gradient;
  WindowPass window;
  Editor editor;

  // `chains`: the field that is felt is filtered, and gradients are those of another one, smoothed from that.
  explicit Edited(gpu::Gpu& gpu, bool chains = false)
      : transfer(gpu),
        pool(gpu, transfer, volume),
        filters(chains ? chainFrom(gpu, pool) : nullptr),
        smoothing(chains ? chainFrom(gpu, filters->result()) : nullptr),
        bounds(gpu, field()),
        store(gpu, pool.brickCount(), active()),
        gradient(gpu, transfer, field(), store, {}, smoothing ? &smoothing->result() : nullptr),
        window(gpu, field(), store),
        editor({gpu, transfer, pool, store, &bounds, gradient, window, filters.get(), 0, smoothing.get()},
               brushProfile(0, -100, 100, Vec3::Constant(1e-3)), false) {
    gradient.run();
    editor.prepare(std::array{EditKind::kRemove, EditKind::kSmooth});
  }
  std::unique_ptr<FilterChain> chainFrom(gpu::Gpu& gpu, const BrickPool& source) {
    auto made = std::make_unique<FilterChain>(gpu, transfer, source,
                                              lowerFilters(filterChain("gaussian:0.5"), Vec3::Constant(1e-3)));
    made->run();
    return made;
  }
  [[nodiscard]] const BrickPool& field() const { return filters ? filters->result() : pool; }
  std::vector<std::uint32_t> active() {
    bounds.run();
    return activeBricks(bounds.read(transfer), pool.grid(), 0);
  }
  // Of the volume, and of the fields that chains made of it.
  std::vector<BrickContent> all() {
    std::vector<BrickContent> bricks;
    for (std::uint32_t b = 0; b < pool.brickCount(); ++b) bricks.push_back(editor.content(b));
    for (const auto* chain : {filters.get(), smoothing.get()}) {
      for (std::uint32_t b = 0; chain != nullptr && b < pool.brickCount(); ++b) {
        std::vector<float> values(kBrickVoxels);
        if (chain->result().readBrick(transfer, b, values.data())) values.resize(1);
        bricks.push_back({b, std::move(values)});
      }
    }
    return bricks;
  }
};

std::vector<EditCommand> commands() {
  std::vector<EditCommand> list(2);
  list[1].kind = EditKind::kSmooth;
  for (EditCommand& command : list) {
    command.from_W = command.to_W = Vec3(16e-3, 20e-3, 20e-3);
    command.radius_m = 8e-3;
  }
  return list;
}

template <typename Work>
std::string refusal(const Work& work) {
  return refusalOf(work, Error::Code::kDevice);
}

void expectGivesNothingAway(Edited& edited) {
  const auto edits = commands();
  const std::vector<BrickContent> one = {{0, {5.0F}}};
  const auto says = HasSubstr("in the middle of an edit");
  EXPECT_THAT(refusal([&] { edited.editor.apply(edits, nullptr); }), says);
  EXPECT_THAT(refusal([&] { edited.editor.replace(one, nullptr); }), says);
  EXPECT_THAT(refusal([&] { static_cast<void>(edited.editor.content(0)); }), says);
  EXPECT_THAT(refusal([&] { static_cast<void>(edited.editor.takeChanged(1)); }), says);
  EXPECT_THAT(refusal([&] { edited.editor.readBack(edited.volume); }), says);
}

bool same(const std::vector<BrickContent>& a, const std::vector<BrickContent>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.brick == y.brick && x.values == y.values; });
}

std::size_t allocationsOfAnEdit(gpu::Gpu& gpu, bool chains) {
  Edited edited(gpu, chains);
  edited.editor.timeKernels(true);
  const std::size_t before = failing_memory::allocations;
  edited.editor.apply(commands(), nullptr);
  return failing_memory::allocations - before;
}

class FailingEdit : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WithAndWithoutChains, FailingEdit, testing::Bool());

TEST_P(FailingEdit, ChangesNothingOrIsTheLast) {
  gpu::Gpu gpu({});
  std::optional<Edited> edited(std::in_place, gpu, GetParam());
  edited->editor.timeKernels(true);
  const std::vector<BrickContent> before = edited->all();
  const std::vector<EditCommand> edits = commands();
  int unchanged = 0;
  int broken = 0;
  const std::size_t all = allocationsOfAnEdit(gpu, GetParam());
  // Every allocation at the start and at the end, where the edit's work is accounted for; between every seventh (of the
  // many that chains make, fewer): those repeat one another, a brick or a dispatch each.
  for (std::size_t n = 1;; n += n < 20 || n + 30 > all ? 1 : GetParam() ? 29 : 7) {
    bool failed = false;
    failing_memory::failAfter(n);
    try {
      edited->editor.apply(edits, nullptr);
    } catch (const std::exception&) {
      failed = true;
    }
    failing_memory::failNoMore();
    if (!failed) break;
    ASSERT_EQ(edited->editor.version(), 0U) << n;
    if (!edited->editor.broken()) {
      ++unchanged;
      ASSERT_EQ(edited->editor.changedBricks(), 0U) << n;
      ASSERT_TRUE(same(edited->all(), before)) << n;
      continue;
    }
    ++broken;
    expectGivesNothingAway(*edited);
    edited.reset();
    edited.emplace(gpu, GetParam());
    edited->editor.timeKernels(true);
  }
  EXPECT_FALSE(edited->editor.broken());
  EXPECT_EQ(edited->editor.version(), 1U);
  EXPECT_GT(edited->editor.changedBricks(), 8U);
  EXPECT_GT(unchanged, 10);
  EXPECT_GT(broken, 3);
}

// The engine around it vouches for nothing any more, so the servo lets go; it draws and hands out nothing.
TEST(EditorFailure, EndsWindowsAndPictures) {
  const Volume volume = halves();
  const Vec3 tool_W(16e-3, 20e-3, 20e-3);
  std::optional<Engine> made;
  // An engine whose edit runs out of memory at its allocation of this number; how many it has made by then.
  const auto edited = [&](std::size_t number) {
    made.emplace(volume, makePlan({.draws = true}), 0, std::string());
    made->allowEdits(brushProfile(0, -100, 100, Vec3::Constant(1e-3)));
    made->timeKernels(true);
    EXPECT_TRUE(made->publishAround(tool_W, 1));
    const std::size_t before = failing_memory::allocations;
    failing_memory::failAfter(number);
    try {
      static_cast<void>(made->edit(commands(), 2));
    } catch (const std::exception&) {
    }
    failing_memory::failNoMore();
    return failing_memory::allocations - before;
  };
  // From the end, where the edit is over, back into the part that changes the volume.
  std::size_t number = edited(100'000);
  ASSERT_FALSE(made->broken());
  while (number > 5 && !made->broken()) edited(number -= 5);
  ASSERT_TRUE(made->broken()) << number;
  Engine& engine = *made;
  const std::uint64_t version = engine.exchange().latest().version;
  const std::int64_t confirmed_ns = engine.exchange().confirmedAt_ns();
  EXPECT_FALSE(engine.publishAround(tool_W, 3));
  EXPECT_FALSE(engine.publishAround(tool_W + Vec3(20e-3, 0, 0), 4));
  EXPECT_EQ(engine.exchange().latest().version, version);
  EXPECT_EQ(engine.exchange().confirmedAt_ns(), confirmed_ns);
  const auto says = HasSubstr("in the middle of an edit");
  EXPECT_THAT(refusal([&] { static_cast<void>(engine.draw(Camera{})); }), says);
  EXPECT_THAT(refusal([&] { static_cast<void>(engine.filtered({})); }), says);
}

// What was taken and got lost on the way would be missing in every later file.
TEST(EditorFailure, BricksThatWereTakenAndLostEndItToo) {
  gpu::Gpu gpu({});
  Edited edited(gpu);
  edited.editor.apply(commands(), nullptr);
  edited.editor.settle();
  const std::size_t changed = edited.editor.changedBricks();
  ASSERT_GT(changed, 2U);
  failing_memory::failAfter(4);
  EXPECT_THROW(static_cast<void>(edited.editor.takeChanged(changed)), std::bad_alloc);
  failing_memory::failNoMore();
  EXPECT_TRUE(edited.editor.broken());
  expectGivesNothingAway(edited);
}

}  // namespace editor_failure_test
}  // namespace palpate
