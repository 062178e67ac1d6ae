// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/registry.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "support/test_meshes.hpp"

namespace palpate {
namespace registry_test {

TEST(AlgorithmRegistry, MakesEveryAlgorithmItLists) {
  ASSERT_FALSE(algorithms().empty());
  EXPECT_EQ(algorithms().front().name, "hri");
  for (const AlgorithmEntry& entry : algorithms()) {
    AlgorithmSetup setup;
    if (entry.needs.isosurface_mesh)
      setup.isosurface = std::make_shared<const MeshObject>(boxMesh({0, 0, 0}, {1, 1, 1}));
    EXPECT_NE(makeAlgorithm(entry.name, std::move(setup)), nullptr) << entry.name;
    EXPECT_FALSE(entry.description.empty());
  }
}

// What each needs and is compared by.
TEST(AlgorithmRegistry, SaysWhatEachNeedsAndIs) {
  std::vector<std::string> rows;
  for (const AlgorithmEntry& entry : algorithms()) {
    std::string row(entry.name);
    if (entry.needs.gradient_everywhere) row += ", gradient everywhere";
    if (entry.needs.isosurface_mesh) row += ", mesh";
    if (entry.traits.renews_planes) row += ", renews planes";
    if (entry.traits.takes_tables) row += ", tables";
    if (!entry.traits.shows_surface) row += ", no surface";
    rows.push_back(row);
  }
  EXPECT_THAT(rows,
              testing::ElementsAre("hri, renews planes", "hri-paper, renews planes", "hri-paper-line, renews planes",
                                   "avila, gradient everywhere", "blezek", "god-object, mesh", "implicit",
                                   "haptization, gradient everywhere, tables, no surface"));
}

TEST(AlgorithmRegistry, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  try {
    static_cast<void>(makeAlgorithm("telepathy", {}));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("use one of: hri, hri-paper, "));
    for (const AlgorithmEntry& entry : algorithms())
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string(entry.name)));
  }
}

TEST(AlgorithmRegistry, RefusesParametersThatCannotBeUsed) {
  const auto refused = [](auto change) {
    AlgorithmParameters p;
    change(p);
    EXPECT_THROW(static_cast<void>(makeAlgorithm("hri", {.parameters = p})), Error);
  };
  refused([](AlgorithmParameters& p) { p.plane_renewal_ticks = 0; });
  refused([](AlgorithmParameters& p) { p.stiffness_N_per_m = -1; });
  refused([](AlgorithmParameters& p) { p.damping_Ns_per_m = -1; });
  refused([](AlgorithmParameters& p) { p.stiffness_N_per_m = NAN; });
  refused([](AlgorithmParameters& p) { p.isovalue = INFINITY; });
  refused([](AlgorithmParameters& p) { p.rate_hz = 0; });
  refused([](AlgorithmParameters& p) { p.rate_hz = NAN; });
  EXPECT_THROW(static_cast<void>(makeAlgorithm("god-object", {})), Error);  // without a mesh
  EXPECT_NO_THROW(static_cast<void>(makeAlgorithm(
      "hri",
      {.parameters = {.stiffness_N_per_m = 0, .damping_Ns_per_m = 0, .plane_renewal_ticks = 1, .rate_hz = 0.1}})));
}

}  // namespace registry_test
}  // namespace palpate
