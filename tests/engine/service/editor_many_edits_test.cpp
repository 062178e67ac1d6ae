// SPDX-License-Identifier: Apache-2.0
// Many random edits on the GPU against two truths: the twin, and a new start from the volume that was read back.
#include <algorithm>

#include "base/error.hpp"
#include "editor_state.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/reference/edit.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace editor_many_edits_test {

struct Case {
  Vec3i size;
  bool all = false;
  unsigned seed = 1;
  int edits = 1000;
  bool in_place = true;
  const char* chain = "";
  const char* gradient_operator = "central";
  bool half = false;
};

class ManyEdits : public testing::TestWithParam<Case> {};

// The twin works on plain arrays and has its own way through the volume; the new start knows nothing of the past.
TEST_P(ManyEdits, EqualTheTwinAndANewStart) {
  Case c = GetParam();
  if (!isLongRun()) c.edits = std::max(60, c.edits / 4);
  Volume volume = ball(c.size, 0.3 * c.size.minCoeff());
  gpu::Gpu gpu({});
  const GradientOperator gradient_operator = gradientOperator(c.gradient_operator);
  const SampleFormat format = c.half ? halfSamples(kIsovalue, -100, 200, volume.lattice().spacing_m) : SampleFormat{};
  State state(gpu, volume, c.all, 0, c.in_place, c.chain, gradient_operator, format);
  const BrushProfile profile = profileOf(volume);
  Editor editor(state.parts(gpu), profile, c.all);
  reference::DenseField twin = reference::denseField(volume);
  RandomEdits random(c.size, volume.lattice(), -120, 220, c.seed);
  std::size_t most_stored = 0;
  std::size_t most_constant = 0;
  for (int done = 0, round = 1; done < c.edits; ++round) {
    std::vector<EditCommand> commands;
    do commands.push_back(random.next());
    while (random.pick(3) == 0);
    if (random.pick(5) == 0) commands.push_back(mirrored(commands.back(), random.place(), Vec3(1, 0.2, 0)));
    std::erase_if(commands, [&](const EditCommand& command) {
      try {
        checkEdit(command, c.size, volume.lattice());
        return false;
      } catch (const Error&) {  // a mirror may throw a place far out
        return true;
      }
    });
    if (commands.empty()) continue;
    done += static_cast<int>(commands.size());
    const Editor::Outcome outcome = editor.apply(commands, nullptr);
    editor.settle();
    EXPECT_EQ(outcome.version, editor.version());
    reference::applyEdits(twin, lowerEdits(commands, c.size, volume.lattice(), profile));
    if (round % 40 != 0 && done < c.edits) continue;
    editor.readBack(volume);
    ASSERT_TRUE(sameBytes(volume.toDense(), twin.values)) << "after " << done << " edits";
    most_stored = std::max(most_stored, volume.storedBricks());
    most_constant = std::max(most_constant, state.pool.brickCount() - volume.storedBricks());
    State fresh(gpu, volume, c.all, 0, true, c.chain, gradient_operator, format);
    expectSame(state, fresh);
    ASSERT_FALSE(testing::Test::HasFailure()) << "after " << done << " edits";
  }
  EXPECT_EQ(editor.readBack(volume), 0U);
  EXPECT_GE(most_stored, 2U);  // there was something to compare, and bricks came and went
  EXPECT_GE(most_constant, c.size.minCoeff() > 30 ? 2U : 0U);
}

INSTANTIATE_TEST_SUITE_P(Cases, ManyEdits,
                         testing::Values(Case{{53, 41, 37}, false, 1, 1000}, Case{{33, 24, 50}, true, 2, 200},
                                         Case{{17, 9, 2}, false, 3, 200}, Case{{64, 64, 64}, false, 4, 200},
                                         Case{{40, 40, 40}, false, 5, 200, false},
                                         Case{{53, 41, 37}, false, 6, 300, true, "", "sobel"},
                                         Case{{53, 41, 37}, false, 7, 300, true, "", "central4", true},
                                         Case{{33, 24, 50}, true, 8, 120, true, "", "central4"},
                                         Case{{33, 24, 50}, false, 9, 120, true, "", "sobel", true}));

// A filtered field follows edits of what it is made from.
INSTANTIATE_TEST_SUITE_P(
    Filtered, ManyEdits,
    testing::Values(Case{{53, 41, 37}, false, 6, 1000, true, "gaussian:1.2"},
                    Case{{64, 64, 64}, false, 7, 200, true, "gaussian:0.8mm gaussian:2:border=mirror"},
                    Case{{33, 24, 50}, true, 8, 200, false, "gaussian:3"},
                    Case{{53, 41, 37}, false, 9, 200, true, "diffuse:2:kappa=100"},
                    Case{{41, 33, 37}, false, 10, 200, true, "distance:2"},
                    Case{{41, 33, 37}, false, 11, 200, true, "gaussian:0.7 distance:1 gaussian:0.7"},
                    Case{{33, 24, 30}, true, 12, 100, false, "bilateral:0.7:range=80"},
                    Case{{41, 35, 38}, false, 9, 100, true, "median:1 close:2 gaussian:1"},
                    Case{{40, 33, 42}, false, 10, 60, true, "open:1.5:shape=ball median:2"},
                    Case{{53, 41, 37}, false, 10, 200, true, "gaussian:1.2", "central4", true}));

// So does the smoothed field of an operator that takes its gradient, behind a filter or not.
INSTANTIATE_TEST_SUITE_P(
    Smoothed, ManyEdits,
    testing::Values(Case{{53, 41, 37}, false, 12, 600, true, "", "gaussian:1"},
                    Case{{53, 41, 37}, false, 13, 200, true, "gaussian:1.2", "gaussian:0.8mm", true},
                    Case{{33, 24, 50}, true, 14, 120, false, "", "gaussian:2:border=mirror"},
                    Case{{64, 64, 64}, false, 15, 150, true, "", "gaussian:3"},  // reaches two bricks far
                    Case{{17, 9, 1}, false, 16, 150, true, "", "gaussian:1.5mm", true},
                    Case{{41, 33, 37}, false, 17, 120, true, "distance:2", "gaussian:1"},
                    Case{{41, 35, 38}, false, 18, 80, true, "median:1 close:2", "gaussian:1:truncate=4", true}));

}  // namespace editor_many_edits_test
}  // namespace palpate
