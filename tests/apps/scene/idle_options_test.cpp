// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/idle_options.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"

namespace palpate {
namespace idle_options_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

std::vector<std::string> idle(const Scene& scene, const std::vector<std::string>& flags) {
  return idleOptions(scene, flags);
}

TEST(IdleOptions, EveryRowIsAFlagOfTheOptionTable) {
  for (const std::string& flag : flagsThatMayBeIdle()) {
    EXPECT_TRUE(std::any_of(sceneOptions().begin(), sceneOptions().end(), [&](const SceneOption& option) {
      return option.flag == flag;
    })) << flag;
  }
}

TEST(IdleOptions, OnlyWhatWasGivenIsTold) {
  EXPECT_THAT(idle(Scene{}, {}), IsEmpty());
  EXPECT_THAT(idle(Scene{}, {"--stiffness", "--n"}), IsEmpty());
  EXPECT_THAT(idle(Scene{}, {"--hand-mass"}),
              ElementsAre(StartsWith("--hand-mass has no effect: only a simulated hand that is a spring")));
}

struct Case {
  void (*make_idle)(Scene&);
  void (*use)(Scene&);
  std::vector<std::string> flags;
};

// Each group: told in a scene that has no use for it, and not in one that has.
TEST(IdleOptions, EachIsToldWhereNothingUsesItAndNowhereElse) {
  const auto standard = [](Scene&) {};
  const std::vector<Case> cases = {
      {standard,
       [](Scene& s) { s.spring_hand = true; },
       {"--hand-mass", "--hand-damping", "--hand-stiffness", "--device-mass", "--device-damping", "--device-friction"}},
      {standard, [](Scene& s) { s.texture = "procedural"; }, {"--texture-amplitude", "--texture-wavelength"}},
      {standard, [](Scene& s) { s.texture = "density"; }, {"--texture-amplitude", "--texture-gain"}},
      {[](Scene& s) { s.texture = "density"; }, [](Scene& s) { s.texture = "procedural"; }, {"--texture-wavelength"}},
      {[](Scene& s) { s.texture = "procedural"; }, [](Scene& s) { s.texture = "density"; }, {"--texture-gain"}},
      {standard, [](Scene& s) { s.algorithm = "haptization"; }, {"--haptization-density", "--haptization-gradient"}},
      {standard, [](Scene& s) { s.velocity = "foaw"; }, {"--velocity-noise"}},
      {[](Scene& s) { s.simulated_clock = true; }, standard, {"--require-real-time"}},
      {[](Scene& s) { s.velocity = "foaw"; }, standard, {"--velocity-cutoff"}},
      {[](Scene& s) { s.algorithm = "haptization"; }, standard, {"--stiffness", "--damping", "--n"}},
      {[](Scene& s) { s.algorithm = "blezek"; }, standard, {"--n"}},
      {[](Scene& s) { s.path_file = "a.csv"; },
       standard,
       {"--seconds", "--toward", "--start", "--slide-toward", "--edges", "--depth", "--slide", "--approach"}},
      {[](Scene& s) { s.device = "polhem-v1"; },
       standard,
       {"--path", "--toward", "--start", "--slide-toward", "--edges", "--depth", "--slide", "--approach"}},
      {[](Scene& s) {
         s.device = "polhem-v1";
         s.spring_hand = true;
       },
       [](Scene& s) { s.spring_hand = true; },
       {"--hand-mass", "--device-mass"}},
      {[](Scene& s) { s.device = "polhem-v1"; },
       [](Scene& s) { s.spring_hand = true; },
       {"--hand", "--encoder", "--delay", "--dropped", "--hand-damping", "--hand-stiffness"}},
      {[](Scene& s) { s.device = "recorded"; },
       [](Scene& s) { s.spring_hand = true; },
       {"--hand", "--encoder", "--delay", "--dropped", "--device-damping", "--device-friction"}},
      {standard, [](Scene& s) { s.device = "recorded"; }, {"--recording"}},
      {[](Scene& s) { s.device = "recorded"; }, standard, {"--path", "--seconds", "--toward"}},
      {standard,
       [](Scene& s) { s.device = "polhem-v1"; },
       {"--device-path", "--hid", "--calibrated", "--current-limit", "--place-at", "--place-turn", "--place-scale",
        "--force-scale", "--clutch", "--edge"}},
      {[](Scene& s) { s.picture = false; }, standard, {"--width", "--height"}},
      {[](Scene& s) { s.trace = false; }, standard, {"--stopped-trace"}},
  };
  std::vector<std::string> tried;
  for (const Case& c : cases) {
    Scene unused, used;
    c.make_idle(unused);
    c.use(used);
    EXPECT_EQ(idle(unused, c.flags).size(), c.flags.size()) << c.flags.front();
    EXPECT_THAT(idle(used, c.flags), IsEmpty()) << c.flags.front();
    tried.insert(tried.end(), c.flags.begin(), c.flags.end());
  }
  for (const std::string& flag : flagsThatMayBeIdle()) EXPECT_THAT(tried, testing::Contains(flag));
}

}  // namespace idle_options_test
}  // namespace palpate
