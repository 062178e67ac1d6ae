// SPDX-License-Identifier: Apache-2.0
// What a scene does not name costs it nothing: the running program's own counters (summary.json, "work") show no
// pipeline, dispatch, buffer, thread, effect or library of it, and what remains is the same to the bit.
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "program_test.hpp"

namespace palpate {
namespace left_out_test {

using nlohmann::json;
using testing::Contains;
using testing::StartsWith;
using testing::UnorderedElementsAre;
using Names = std::multiset<std::string>;

const std::string kVolume = "phantom:knot?size=32";
// No feature at all; by the real clock, so that there are threads.
const Words kBare = {"touch", kVolume, "--seconds", "0.2", "--picture", "off", "--trace", "off", "--out", "out"};

class LeftOut : public ProgramTest {
 protected:
  [[nodiscard]] json summaryOf(const Words& words) const {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(contentsOf(file("out/summary.json")));
  }

  static Names namesIn(const json& list) {
    Names names;
    for (const json& item : list)
      names.insert(item.is_string() ? item.get<std::string>() : item["name"].get<std::string>());
    return names;
  }
  // Palpate's own beside the first, whose name a driver's threads may have too.
  static Names ownThreads(const json& summary) {
    Names own;
    for (const std::string& name : namesIn(summary["work"]["threads"]))
      if (Names{"engine", "servo", "journal", "saver", "device"}.contains(name)) own.insert(name);
    return own;
  }
  // On the device at the end, without samples: which bricks have these depends on where a window met the tool.
  static std::uint64_t heldBytes(const json& summary) {
    std::uint64_t bytes = 0;
    for (const json& buffer : summary["work"]["buffers"])
      if (!buffer["name"].get<std::string>().starts_with("samples")) bytes += buffer["bytes"].get<std::uint64_t>();
    return bytes;
  }
  static Names kernelsOf(const json& summary) { return namesIn(summary["work"]["kernels"]); }
  // What has it that the bare touch lacks.
  static Names more(const Names& with, const Names& without) {
    Names rest;
    std::ranges::set_difference(with, without, std::inserter(rest, rest.end()));
    return rest;
  }
};

// All that a bare touch has.
TEST_F(LeftOut, ABareTouchHasThreePipelinesTwoThreadsAndNoEffect) {
  const json bare = summaryOf(kBare);
  EXPECT_THAT(kernelsOf(bare), UnorderedElementsAre("brick_bounds", "gradient", "window"));
  for (const json& kernel : bare["work"]["kernels"]) {
    const int dispatches = kernel["dispatches"];
    if (kernel["name"] == "window") {
      EXPECT_GE(dispatches, bare["servo"]["windows_used"]);  // a tick may pass while another one is gathered
    } else if (kernel["name"] == "gradient") {
      EXPECT_GE(dispatches, 1);  // when a window reaches bricks that have none
    } else {
      EXPECT_EQ(dispatches, 1);  // once, at the start
    }
  }
  EXPECT_THAT(ownThreads(bare), UnorderedElementsAre("engine", "servo"));
  EXPECT_EQ(bare["work"]["effect_runs"], 0);
  EXPECT_FALSE(exists("out/trace.csv"));
  EXPECT_FALSE(exists("out/view.png"));
}

// The simulated clock needs no thread beside the program's own.
TEST_F(LeftOut, TheSimulatedClockMakesNoThread) {
  const json bare = summaryOf(kBare + Words{"--clock", "simulated"});
  EXPECT_TRUE(ownThreads(bare).empty());
  for (const json& kernel : bare["work"]["kernels"]) {  // in step, so every window is used
    if (kernel["name"] == "window") {
      EXPECT_EQ(kernel["dispatches"], bare["servo"]["windows_used"]);
    }
  }
}

// Each feature has something that the bare touch has not, and nothing of another feature.
struct Brought {
  const char* name;
  Words words;
  std::vector<std::string> kernels = {};    // how the names of those begin that come with it
  std::vector<std::string> buffers = {};    // likewise of those that it may bring
  std::vector<std::string> threads = {};    // that come with it
  std::vector<std::string> libraries = {};  // how the names of those begin that come with it
  bool effects = false;
  std::optional<bool> memory = false;  // more is held on the device; empty: it was, and is freed again
};

const std::vector<std::string> kEditBuffers = {"bounds tasks",   "brick tasks",  "edit",
                                               "given bricks",   "stamps",       "staging",
                                               "touched bricks", "samples slab", "density slab"};

class LeftOutFeature : public LeftOut, public testing::WithParamInterface<Brought> {};

TEST_P(LeftOutFeature, IsPaidForByThoseWhoNameItAlone) {
  const Brought& feature = GetParam();
  write("tetrahedron.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  static const json bare = summaryOf(kBare);  // the same for all
  Words words = kBare;
  for (std::size_t n = 0; n + 1 < feature.words.size(); n += 2) {  // a flag of the bare touch is given once
    const auto given = std::ranges::find(words, feature.words[n]);
    if (given != words.end()) {
      *(given + 1) = feature.words[n + 1];
    } else {
      words.insert(words.end(), {feature.words[n], feature.words[n + 1]});
    }
  }
  const json with = summaryOf(words);
  const Names kernels = more(kernelsOf(with), kernelsOf(bare));
  for (const std::string& name : kernels) {
    EXPECT_TRUE(std::ranges::any_of(feature.kernels, [&](const std::string& begin) { return name.starts_with(begin); }))
        << name << " comes with " << feature.name;
  }
  for (const std::string& begin : feature.kernels) EXPECT_THAT(kernels, Contains(StartsWith(begin))) << feature.name;
  EXPECT_THAT(more(ownThreads(with), ownThreads(bare)), testing::UnorderedElementsAreArray(feature.threads));
  // No buffer of another feature.
  for (const std::string& name : more(namesIn(with["work"]["buffers"]), namesIn(bare["work"]["buffers"]))) {
    EXPECT_TRUE(std::ranges::any_of(feature.buffers, [&](const std::string& begin) { return name.starts_with(begin); }))
        << name << " comes with " << feature.name;
  }
  const Names libraries = more(namesIn(with["libraries"]), namesIn(bare["libraries"]));
  EXPECT_EQ(libraries.empty(), feature.libraries.empty()) << testing::PrintToString(libraries);
  for (const std::string& begin : feature.libraries) EXPECT_THAT(libraries, Contains(StartsWith(begin)));
  EXPECT_EQ(with["work"]["effect_runs"].get<int>() > 0, feature.effects);
  if (feature.memory) {
    EXPECT_EQ(heldBytes(with) > heldBytes(bare), *feature.memory);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Features, LeftOutFeature,
    testing::Values(Brought{.name = "filter",
                            .words = {"--filter", "gaussian:1"},
                            .kernels = {"filter_convolve"},
                            .buffers = {"filter"},
                            .memory = true},
                    Brought{.name = "distance",
                            .words = {"--field", "distance"},
                            .kernels = {"filter_distance"},
                            .buffers = {"filter"},
                            .memory = true},
                    Brought{.name = "smoothing",
                            .words = {"--gradient-operator", "gaussian:1"},
                            .kernels = {"filter_convolve", "gradient_smoothed"},
                            .memory = std::nullopt},
                    Brought{.name = "all_gradients", .words = {"--gradient", "all"}},  // samples alone
                    Brought{.name = "picture",
                            .words = {"--picture", "on"},
                            .kernels = {"draw", "cell_"},
                            .libraries = {"cairo.so", "libcairo."},
                            .memory = std::nullopt},
                    Brought{.name = "friction", .words = {"--friction-static", "0.5"}, .effects = true},
                    Brought{.name = "texture", .words = {"--texture", "procedural"}, .effects = true},
                    Brought{.name = "recovery", .words = {"--recovery", "20"}, .effects = true},
                    Brought{.name = "shading", .words = {"--force-shading", "on"}, .effects = true},
                    Brought{
                        .name = "stiffness_by_density", .words = {"--stiffness-density", "0:1,1:2"}, .effects = true},
                    Brought{.name = "object", .words = {"--object", "sphere:centre=0,0,100000:radius=5"}},
                    Brought{.name = "mesh",
                            .words = {"--object", "mesh:position=0,0,100000:file=tetrahedron.obj"},
                            .libraries = {"embree.so", "libembree", "assimp.so", "libassimp."}},
                    Brought{.name = "record", .words = {"--record", "session.rec"}},
                    Brought{.name = "passivity", .words = {"--passivity", "control"}},
                    Brought{.name = "edits",
                            .words = {"--edit", "remove:radius=2mm"},
                            .kernels = {"edit", "brick_commit", "brick_bounds"},
                            .buffers = kEditBuffers,
                            .memory = true},
                    Brought{.name = "journal",
                            .words = {"--edit", "remove:radius=2mm", "--journal", "journal"},
                            .kernels = {"edit", "brick_commit", "brick_bounds"},
                            .buffers = kEditBuffers,
                            .threads = {"journal"},
                            .memory = true},
                    Brought{.name = "save",
                            .words = {"--edit", "remove:radius=2mm", "--save", "saved.vdb"},
                            .kernels = {"edit", "brick_commit", "brick_bounds"},
                            .buffers = kEditBuffers,
                            .threads = {"saver"},
                            .memory = true}),
    [](const testing::TestParamInfo<Brought>& feature) { return std::string(feature.param.name); });

// A feature that is left out beside others leaves the rest of the scene as it was: the traces are the same, bit for
// bit.
struct Beside {
  const char* name;
  Words rest, feature;
};

class LeftOutChangesNothing : public ProgramTest, public testing::WithParamInterface<Beside> {};

TEST_P(LeftOutChangesNothing, OfWhatRemains) {
  write("tetrahedron.stl",
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
  const Words base = {"touch", "phantom:knot?size=32&noise=0.02", "--seconds", "0.3", "--clock", "simulated"};
  const Beside& beside = GetParam();
  static std::map<Words, std::string> traces;  // of the same rest: run once
  std::string& without = traces[beside.rest];
  if (without.empty()) {
    expectSuccess(run(base + beside.rest + Words{"--out", "without"}));
    without = contentsOf(file("without/trace.csv"));
  }
  expectSuccess(run(base + beside.rest + beside.feature + Words{"--out", "with"}));
  EXPECT_GT(without.size(), 10000U);
  EXPECT_TRUE(without == contentsOf(file("with/trace.csv"))) << "the traces differ";
}

const Words kNoPicture = {"--picture", "off"};
const Words kEdited = {"--picture", "off", "--edit", "remove:radius=2mm"};
const Words kBusy = {"--picture", "off", "--friction-static", "0.5", "--texture", "procedural", "--filter", "median:1"};

INSTANTIATE_TEST_SUITE_P(
    Features, LeftOutChangesNothing,
    testing::Values(Beside{"picture", {}, kNoPicture}, Beside{"all_gradients", kNoPicture, {"--gradient", "all"}},
                    Beside{"all_gradients_beside_others", kBusy, {"--gradient", "all"}},
                    Beside{"far_ball", kNoPicture, {"--object", "sphere:centre=0,0,100000:radius=5"}},
                    Beside{"far_mesh", kNoPicture, {"--object", "mesh:position=0,0,100000:file=tetrahedron.stl"}},
                    Beside{"record", kNoPicture, {"--record", "session.rec"}},
                    Beside{"journal", kEdited, {"--journal", "journal"}},
                    Beside{"save", kEdited, {"--save", "saved.vdb"}},
                    Beside{"memory_limit", kBusy, {"--gpu-memory", "1GiB"}}),
    [](const testing::TestParamInfo<Beside>& beside) { return std::string(beside.param.name); });

}  // namespace left_out_test
}  // namespace palpate
