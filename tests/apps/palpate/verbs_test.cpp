// SPDX-License-Identifier: Apache-2.0
// The other verbs, and the help of all.
#include <iomanip>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/scene/option_table.hpp"
#include "apps/sculpt/tick_recording.hpp"
#include "engine/filter/filter_spec.hpp"
#include "nrrd_bytes.hpp"
#include "program_test.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace verbs_test {

using testing::HasSubstr;

class Verbs : public ProgramTest {};

TEST_F(Verbs, HelpOfEachSaysWhatItDoes) {
  for (const Words& verb : {Words{},
                            Words{"touch"},
                            Words{"edit"},
                            Words{"recover"},
                            Words{"tune"},
                            Words{"info"},
                            Words{"check"},
                            Words{"check", "gradient"},
                            Words{"check", "filters"},
                            Words{"check", "edits"},
                            Words{"check", "all"},
                            Words{"filter"},
                            Words{"gradient"},
                            Words{"render"},
                            Words{"bench"},
                            Words{"bench", "servo"},
                            Words{"bench", "loop"},
                            Words{"bench", "edit"},
                            Words{"bench", "load"},
                            Words{"convert"},
                            Words{"devices"},
                            Words{"plan"},
                            Words{"scene"},
                            Words{"faults"}}) {
    const Outcome outcome = run(verb + Words{"--help"});
    expectSuccess(outcome);
    EXPECT_THAT(outcome.out, HasSubstr("Usage: palpate"));
  }
}

// Names of phantoms with keys that stand without quotes: a shell takes '?' and '&' for itself.
Words unquotedPhantoms(const std::string& text) {
  Words found;
  for (std::size_t at = text.find("phantom:"); at != std::string::npos; at = text.find("phantom:", at + 1)) {
    const std::string name = text.substr(at, text.find_first_of(" \n,;)`'\"", at) - at);
    if (name.find('?') != std::string::npos && (at == 0 || text[at - 1] != '\'')) found.push_back(name);
  }
  return found;
}

// The line that a window gives for a recording, as a person pastes it. The path, the settings and the volume have names
// and values that a shell or the parser could take for something else.
TEST_F(Verbs, AReplayIsTakenByTheProgram) {
  write("my way.csv", "time_s,x_m,y_m,z_m,brush\n0,0,-0.03,0,\n0.05,0,-0.02,0,\n");
  Seeded random(2);
  for (int i = 0; i < 3; ++i) {
    RigSettings felt;
    felt.parameters.isovalue = static_cast<float>(i == 0 ? -0.1 : random.between(-300, 300));
    felt.parameters.stiffness_N_per_m = random.between(20, 300);
    felt.parameters.damping_Ns_per_m = random.between(0, 0.2);
    felt.parameters.plane_renewal_ticks = 1 + random.pick(5);
    felt.effects = {
        .force_shading = i == 1, .recovery_s = 1e-3 * random.pick(20), .texture = static_cast<TextureKind>(i)};
    felt.effects.friction = {0.6, 0.3, 0.1};
    felt.force_limit_N = random.between(1, 8);
    const std::string line = replayCommand("phantom:sphere?size=32&spacing=2mm", "my way.csv", felt);
    ASSERT_THAT(line, testing::StartsWith("palpate touch '"));
    std::istringstream in(line.substr(std::string("palpate ").size()));
    Words words;  // as a shell splits them; there is no quote within quotes
    for (std::string word; in >> std::quoted(word, '\''); word.clear()) words.push_back(word);
    const Outcome outcome =
        run(words + Words{"--clock", "simulated", "--picture", "off", "--out", "out" + std::to_string(i)});
    EXPECT_EQ(outcome.status, 0) << line << '\n' << outcome.err;
    const auto summary = nlohmann::json::parse(contentsOf(file("out" + std::to_string(i)) / "summary.json"));
    EXPECT_EQ(summary.at("scene").at("contact").at("friction_static"), 0.6) << line;
    EXPECT_EQ(summary.at("volume").at("isovalue_density"), felt.parameters.isovalue) << line;
  }
}

// Flags of each verb, and of the verbs below it, from its own help: "--iso".
std::set<std::string> flagsIn(const std::string& text) {
  std::set<std::string> flags;
  static const std::regex kFlag("(^|[^-a-zA-Z0-9_])(--[a-z][-a-z0-9]*)");
  for (auto it = std::sregex_iterator(text.begin(), text.end(), kFlag); it != std::sregex_iterator(); ++it)
    flags.insert((*it)[2]);
  return flags;
}

// Whatever names a command line to a person: pages, and the texts of the program. "palpate VERB ... --flag": the verb
// has the flag.
TEST_F(Verbs, CommandLinesThatAreToldHaveFlagsThatExist) {
  std::map<std::string, std::set<std::string>> known;
  for (const char* verb : {"touch",  "edit",      "recover",   "info",    "convert", "gradient", "filter", "render",
                           "check",  "bench",     "stability", "devices", "serve",   "servo",    "ctl",    "top",
                           "doctor", "calibrate", "plan",      "tune",    "scene",   "faults",   "sculpt"}) {
    std::string help = run({verb, "--help"}).out;
    static const std::regex kSub("(^|\\n)  ([a-z]+)  ");
    const std::string own = help.substr(std::min(help.size(), help.find("Subcommands:")));
    for (auto it = std::sregex_iterator(own.begin(), own.end(), kSub); it != std::sregex_iterator(); ++it)
      help += run({verb, (*it)[2], "--help"}).out;
    known[verb] = flagsIn(help);
  }
  const std::filesystem::path root = std::filesystem::path(PALPATE_DOCS).parent_path();
  std::vector<std::filesystem::path> texts = {root / "README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md") texts.push_back(entry.path());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "apps"))
    if (entry.path().extension() == ".cpp") texts.push_back(entry.path());
  static const std::regex kLine("palpate ([a-z]+)([^\\n`]*)");
  int seen = 0;
  for (const std::filesystem::path& text : texts) {
    std::string words = contentsOf(text);
    if (text.extension() == ".cpp") words = std::regex_replace(words, std::regex("\"\\s*\\n\\s*\""), "");  // one text
    for (auto it = std::sregex_iterator(words.begin(), words.end(), kLine); it != std::sregex_iterator(); ++it) {
      const auto verb = known.find((*it)[1]);
      if (verb == known.end()) continue;
      std::string rest = (*it)[2];
      for (const char* end : {"; ", "'", "\"", " | ", " && ", "palpate ", "  "}) rest = rest.substr(0, rest.find(end));
      for (const std::string& flag : flagsIn(rest)) {
        EXPECT_TRUE(verb->second.contains(flag)) << text.filename() << ": palpate " << verb->first << rest;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 100);
}

TEST_F(Verbs, ExamplesCanBeGivenToAShell) {
  EXPECT_THAT(unquotedPhantoms("palpate touch phantom:box?size=8\npalpate info 'phantom:box?size=8'"),
              testing::ElementsAre("phantom:box?size=8"));
  const std::string program = run({"--help"}).out;
  EXPECT_THAT(unquotedPhantoms(program), testing::IsEmpty());
  for (const Words& verb :
       {Words{"touch"}, Words{"edit"}, Words{"recover"}, Words{"info"}, Words{"convert"}, Words{"gradient"},
        Words{"filter"}, Words{"render"}, Words{"check", "gradient"}, Words{"check", "filters"},
        Words{"check", "edits"}, Words{"check", "all"}, Words{"bench", "servo"}, Words{"plan"}, Words{"tune"}}) {
    EXPECT_THAT(unquotedPhantoms(run(verb + Words{"--help"}).out), testing::IsEmpty()) << verb.back();
  }
  std::vector<std::filesystem::path> pages = {std::filesystem::path(PALPATE_DOCS).parent_path() / "README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_DOCS)) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  ASSERT_GT(pages.size(), 10U);
  for (const std::filesystem::path& page : pages) {
    std::istringstream lines(contentsOf(page));
    for (std::string line; std::getline(lines, line);) {
      if (line.find("palpate ") == std::string::npos) continue;
      EXPECT_THAT(unquotedPhantoms(line), testing::IsEmpty()) << page << ": " << line;
    }
  }
}

// Coordinates of a file in RAS are turned to LPS, which makes of its origin at 0 one at -0.
TEST_F(Verbs, InfoHasNoMinusBeforeAZero) {
  write("a.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nspace: right-anterior-superior\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: ascii\n\n0 1 2 3 4 5 6 7\n");
  const Outcome outcome = run({"info", "a.nrrd"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("origin       0, 0, 0 mm (LPS)"));
  EXPECT_THAT(outcome.out, HasSubstr("places       x -1 to 0, y -1 to 0, z 0 to 1 mm"));
  EXPECT_THAT(outcome.out, HasSubstr("axes         i (-1, 0, 0)  j (0, -1, 0)"));
}

// 64 voxels with so many slices, in steps of so many millimetres.
std::string smallNrrd(const std::string& sizes, const std::string& step_mm) {
  std::string text = "NRRD0004\ntype: float\ndimension: 3\nsizes: " + sizes + "\nspacings: " + step_mm + " " + step_mm +
                     " " + step_mm + "\nencoding: ascii\n\n";
  for (int n = 0; n < 64; ++n) text += std::to_string(n) + " ";
  return text;
}

// A remedy that is in force already is none.
TEST_F(Verbs, ConvertNamesNoUnitThatIsInForce) {
  write("tiny.nrrd", smallNrrd("4 4 4", "1e-7"));
  for (const Words& unit : {Words{}, Words{"--unit", "mm"}, Words{"--unit", "m"}}) {
    const Outcome outcome = run(Words{"convert", "tiny.nrrd", "x.vdb"} + unit);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("too small for OpenVDB in this unit of length; "));
    EXPECT_EQ(outcome.err.find("use --unit mm") != std::string::npos, unit == (Words{"--unit", "m"})) << outcome.err;
  }
}

// What it has in common with touch is no reason to speak of that.
TEST_F(Verbs, ConvertOfOneSliceSpeaksOfItsSurface) {
  write("slice.nrrd", smallNrrd("8 8 1", "1"));
  expectRefusal(run({"convert", "slice.nrrd", "x.stl"}), "slice.nrrd", "and a surface needs two along every axis", 2);
}

// A ramp of floats, two of which are no numbers.
std::string rampWithNan() {
  std::vector<float> values(std::size_t{12} * 12 * 12);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 12);
  values[7] = values[900] = std::numeric_limits<float>::quiet_NaN();
  return "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 12 12\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n" +
         std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

// What is odd about a volume is told once by every verb that loads one.
TEST_F(Verbs, TellWhatIsOddAboutAVolume) {
  write("a.nrrd", rampWithNan());
  // Nothing is measured but in a long run; a run is counted all the same.
  const Words plan = Words{"plan", "a.nrrd"} + (isLongRun() ? Words{} : Words{"--rounds", "0"});
  for (const Words& verb :
       {quickTouch("a.nrrd"), plan, Words{"tune", "a.nrrd", "--error", "1N", "--seconds", "0.3"},
        Words{"edit", "a.nrrd", "e.nrrd", "--do", "remove:radius=2:at=0,0,0", "--journal", "journal"},
        Words{"recover", "journal", "--out", "r.nrrd"}, Words{"convert", "a.nrrd", "c.nrrd"},
        Words{"filter", "a.nrrd", "-o", "f.nrrd", "--filter", "median:1"}, Words{"gradient", "a.nrrd", "-o", "g.vdb"},
        Words{"render", "a.nrrd", "-o", "r.png", "--size", "8x8"}, Words{"check", "gradient", "a.nrrd"},
        Words{"check", "filters", "a.nrrd", "--filter", "median:1"}, Words{"check", "edits", "a.nrrd", "--edits", "2"},
        Words{"check", "all", "a.nrrd", "--quick"}}) {
    if (verb[1] == "all" && !isLongRun()) continue;  // half a minute
    const bool has_option = verb[0] != "recover";    // the journal has the name with its option
    const Outcome outcome = run(verb + (has_option ? Words{"--nan", "3"} : Words{}));
    EXPECT_EQ(outcome.status, 0) << verb[0] << ": " << outcome.err;
    const Words lines = errorLines(outcome.err);
    ASSERT_EQ(lines.size(), 1U) << verb[0] << " " << verb[1] << ": " << outcome.err;
    EXPECT_THAT(lines[0], HasSubstr("a.nrrd?nan=3: 2 of ")) << verb[0];
  }
  EXPECT_THAT(run({"info", "a.nrrd", "--nan", "3"}).out, HasSubstr("note         2 of "));
}

TEST_F(Verbs, HelpOfTheProgramNamesEveryVerb) {
  const std::string help = run({"--help"}).out;
  for (const char* verb : {"touch", "edit", "recover", "info", "convert", "render", "check", "bench", "devices", "plan",
                           "tune", "scene", "faults"}) {
    EXPECT_THAT(help, testing::ContainsRegex(std::string("\n  ") + verb + " +[a-z]"));
  }
}

// Of the device, the flags that a window reads, with what it begins with.
TEST_F(Verbs, HelpOfSculptHasTheDevicesFlags) {
  const std::string help = run({"sculpt", "--help"}).out;
  EXPECT_THAT(help, testing::ContainsRegex("--device [^\n]*default mouse; key device.name"));
  for (const char* flag : {"--device-path", "--hid", "--calibrated", "--current-limit", "--place-at", "--place-turn",
                           "--place-scale", "--force-scale", "--clutch", "--edge"})
    EXPECT_THAT(help, HasSubstr(std::string("\n  ") + flag + " "));
  EXPECT_THAT(help, testing::Not(HasSubstr("--device-mass")));
  expectRefusal(run({"sculpt", "phantom:sphere", "--force-scale", "0"}), "--force-scale", "'0' is not what it takes",
                2);
}

TEST_F(Verbs, TouchHasNoMouse) {
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--device", "mouse"}), "--device mouse",
                "a run along a path has no window, and so no pointer", 2);
}

// Each flag with its key, and its unit and default where it has them.
TEST_F(Verbs, HelpOfTouchShowsUnitsAndDefaults) {
  for (const char* verb : {"touch", "plan"}) {
    const std::string help = run({verb, "--help"}).out;
    EXPECT_THAT(
        help,
        HasSubstr("time in which the force fades to zero after a fault [s] (a number from 0 to 10; default 0.1;"));
    for (const SceneOption& option : sceneOptions()) {
      if (isOfService(option)) continue;
      const auto at = help.find(std::string("\n  ") + option.flag + " ");
      ASSERT_NE(at, std::string::npos) << option.flag;
      const std::string line = help.substr(at + 1, help.find("\n  -", at + 1) - at);
      EXPECT_THAT(line, HasSubstr(option.key));
      EXPECT_THAT(line, HasSubstr(*option.unit == '\0' ? "" : std::string("[") + option.unit + "]"));
      const std::string standard = optionText(option.value, Scene{});
      EXPECT_THAT(line, HasSubstr(standard.empty() ? "" : "default " + standard));
    }
  }
  EXPECT_THAT(run({"check", "gradient", "--help"}).out, HasSubstr("[ULP] (default 0)"));
}

TEST_F(Verbs, VersionNamesProgramAndCommit) {
  const Outcome outcome = run({"--version"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, testing::MatchesRegex("palpate [0-9]+\\.[0-9]+\\.[0-9]+ \\([0-9a-z-]+\\)\n"));
}

TEST_F(Verbs, SceneIsTheDocumentedTable) {
  const Outcome outcome = run({"scene"});
  expectSuccess(outcome);
  EXPECT_EQ(outcome.out, contentsOf(PALPATE_DOCS "/scene.md"));
}

TEST_F(Verbs, FaultsIsTheDocumentedTable) {
  const Outcome outcome = run({"faults"});
  expectSuccess(outcome);
  EXPECT_EQ(outcome.out, contentsOf(PALPATE_DOCS "/faults.md"));
}

TEST_F(Verbs, InfoSaysWhatAVolumeIs) {
  const Outcome outcome = run({"info", "phantom:sphere?size=24x20x16&spacing=0.5x1x2mm"});
  expectSuccess(outcome);
  for (const char* words :
       {"24 x 20 x 16 voxels", "0.5 x 1 x 2 mm", "phantom", "range", "histogram", "isovalues worth trying"}) {
    EXPECT_THAT(outcome.out, HasSubstr(words));
  }
}

// A turned lattice has its box in the world; the middle is where an edit may begin.
TEST_F(Verbs, InfoSaysWhereAVolumeLies) {
  EXPECT_THAT(run({"info", "phantom:sphere?size=25x21x17&spacing=0.5x1x2mm"}).out,
              HasSubstr("places       x -6 to 6, y -10 to 10, z -16 to 16 mm; the middle 0,0,0\n"));
}

// A turned lattice with three spacings, worked out by hand: its axes are (2,3,6), (6,2,-3) and (3,-6,2) sevenths, with
// 7, 3.5 and 14 mm between voxels. Of 60 voxels 40 hold 0, 15 hold 12.5 and 5 hold 24, so bins are 1 wide and bars
// ln 41, ln 16 and ln 6 over ln 41 of 50 letters long.
TEST_F(Verbs, InfoOfATurnedVolume) {
  std::vector<float> values(40, 0.0F);
  values.resize(55, 12.5F);
  values.resize(60, 24.0F);
  write("a.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 3 4 5\nspace: left-posterior-superior\n"
        "space directions: (2,3,6) (3,1,-1.5) (6,-12,4)\nspace origin: (10,20,-30)\nencoding: raw\nendian: little\n\n" +
            std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
  const std::string info = run({"info", "a.nrrd"}).out;
  EXPECT_THAT(info, testing::StartsWith(R"(a.nrrd
  format       NRRD (float32)
  size         3 x 4 x 5 voxels
  spacing      7 x 3.5 x 14 mm
  extent       21 x 14 x 70 mm
  origin       10, 20, -30 mm (LPS)
  places       x 10 to 47, y -28 to 29, z -34.5 to -2 mm; the middle 28.5,0.5,-18.25
  axes         i (0.2857, 0.4286, 0.8571)  j (0.8571, 0.2857, -0.4286)  k (0.4286, -0.8571, 0.2857)
)"));
  EXPECT_THAT(info, HasSubstr("\n  bricks       1 of 1 hold more than one value; "));
  EXPECT_THAT(info,
              HasSubstr("\n  range        0 ... 24, mean 5.125\n  no data?     66.7 % of the voxels hold 0, far "));
  std::string histogram = "  histogram (length of a bar: logarithm of the voxel count)\n";
  for (int bin = 0; bin < 24; ++bin) {
    const std::string bar(bin == 0 ? 50 : bin == 12 ? 37 : bin == 23 ? 24 : 0, '#');
    const int count = bin == 0 ? 40 : bin == 12 ? 15 : bin == 23 ? 5 : 0;
    histogram += fmt::format("  {:>12}  {:<50}  {}\n", bin, bar, count);
  }
  EXPECT_THAT(info, HasSubstr(histogram + "  isovalues worth trying (--iso), the default first\n"));
  EXPECT_THAT(info, testing::Not(HasSubstr("rescale")));
  EXPECT_THAT(info, testing::Not(HasSubstr("  part ")));
  EXPECT_THAT(info, testing::Not(HasSubstr("  note ")));
}

TEST_F(Verbs, InfoOfAConstantVolumeStillInforms) {
  const Outcome outcome = run({"info", "phantom:sphere?size=2"});  // eight voxels at one distance from the centre
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("no surface"));
}

TEST_F(Verbs, DevicesListsADeviceAndTheDefault) {
  const Outcome outcome = run({"devices"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\n.+ GiB .+\\[default\\]"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex(" [0-9]{1,4}\\.[0-9] GiB  "));
  EXPECT_THAT(outcome.out, testing::StartsWith("haptic device (--device)"));
  EXPECT_THAT(outcome.out, HasSubstr("\n\nVulkan device (--gpu) "));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("unusable: ]")));
  std::size_t defaults = 0;
  for (std::size_t at = 0; (at = outcome.out.find("  [default]\n", at)) != std::string::npos; ++at) ++defaults;
  EXPECT_EQ(defaults, 2U);  // one of each kind
}

TEST_F(Verbs, PlanSaysWhatIsDoneAndWhatIsLeftOut) {
  const Outcome all = run({"plan", "phantom:sphere?size=64", "--rounds", "0"});
  expectSuccess(all);
  EXPECT_THAT(all.out, testing::ContainsRegex("\n  do +.*gradient of up to [0-9]+ of 512 bricks"));
  EXPECT_THAT(all.out, testing::StartsWith("phantom:sphere?size=64 at isovalue 0 on "));
  EXPECT_THAT(all.out, testing::ContainsRegex("\n  do  +[0-9]+ of 512 bricks of density +-[0-9.]+ MiB  a brick that"));
  EXPECT_THAT(all.out, testing::ContainsRegex("\n  leave  +contact effects  +the scene names none\n"));
  const Outcome less = run({"plan", "phantom:sphere?size=64", "--picture", "off", "--rounds", "0"});
  expectSuccess(less);
  EXPECT_THAT(less.out, testing::ContainsRegex("\n  leave +"));
  EXPECT_FALSE(exists("out"));  // a plan writes nothing
}

// With everything on that goes together, each pipeline, buffer and library has words that say what it is for.
TEST_F(Verbs, PlanSaysOfEverythingWhatItIsFor) {
  const Outcome outcome = run({"plan", "phantom:sphere?size=32", "--rounds", "0", "--json", "plan.json", "--filter",
                               "median:1", "--gradient-operator", "gaussian:1", "--edit", "smooth:radius=2mm",
                               "--friction-static", "0.5", "--object", "sphere:centre=0,0,100000:radius=5"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("kept, since edits change it"));  // the smoothed field
  const auto plan = nlohmann::json::parse(contentsOf(file("plan.json")));
  for (const char* list : {"pipelines", "buffers"}) {
    EXPECT_GE(plan["counted"][list].size(), 6U);
    for (const auto& item : plan["counted"][list]) EXPECT_NE(item["why"], "") << item;
  }
  for (const auto& module : plan["modules"]) EXPECT_NE(module["why"], "") << module;
  EXPECT_EQ(plan["effects"], "friction");
  EXPECT_GT(plan["counted"]["effect_runs"], 0);
  for (const char* name : {"palpate", "engine", "servo"})
    EXPECT_THAT(plan["counted"]["threads"], testing::Contains(name));
  EXPECT_TRUE(plan["features"].empty());
}

// One round: every feature is switched once, and none of the files that the scene names is written.
TEST_F(Verbs, PlanMeasuresEveryFeature) {
  const Outcome outcome =
      run({"plan", "phantom:sphere?size=16", "--rounds", "1", "--picture", "off", "--edit", "remove:radius=2mm",
           "--journal", "journal", "--save", "saved.vdb", "--json", "plan.json"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("\n| has | a journal | "));
  EXPECT_THAT(outcome.out, HasSubstr("\n| lacks | filters (gaussian:1) | "));
  const auto plan = nlohmann::json::parse(contentsOf(file("plan.json")));
  for (const auto& feature : plan["features"]) {
    const std::string why = feature.value("not_measured", "");
    if (feature["name"] == "a mesh of the isosurface") {  // which edits would leave behind
      EXPECT_THAT(why, HasSubstr("god-object feels a mesh that is made once"));
    } else {
      EXPECT_EQ(why, "") << feature["name"];
    }
  }
  for (const char* name : {"journal", "saved.vdb", "out"}) EXPECT_FALSE(exists(name)) << name;
}

// On a box as large as its volume no path begins outside; its passes are told all the same.
TEST_F(Verbs, PlanOfWhatCannotBeTouchedSaysWhy) {
  const Outcome outcome = run({"plan", "phantom:sphere?size=16", "--rounds", "0", "--start", "900,0,0"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("bricks of density"));
  EXPECT_THAT(outcome.out, HasSubstr("\nNothing was counted: the run that should be counted failed: "));
}

TEST_F(Verbs, PlanRefusesWhatTouchRefuses) {
  expectRefusal(run({"plan", "phantom:sphere?size=16", "--rounds", "-1"}), "--rounds", "-1", 2);
  expectRefusal(run({"plan", "phantom:sphere?size=16", "--json", "no/such/folder/p.json"}), "no/such/folder", "", 4);
  expectSuccess(run({"convert", "phantom:sphere?size=16", "in.vdb"}));
  expectRefusal(run({"plan", "in.vdb", "--json", "in.vdb"}), "in.vdb", "it is the input", 2);
  write("scene.toml", "volume = \"in.vdb\"\n");
  write("way.csv", "time_s,x_m,y_m,z_m\n0,9,0,0.01\n0.1,9,0,0\n");
  expectRefusal(run({"plan", "scene.toml", "--json", "scene.toml"}), "scene.toml", "the scene is made of it", 2);
  expectRefusal(run({"plan", "in.vdb", "--path", "way.csv", "--json", "way.csv"}), "way.csv", "the scene is made of it",
                2);
  for (const char* output : {"--json", "-o"}) {
    expectRefusal(run({"tune", "scene.toml", "--error", "1N", "--overwrite", output, "scene.toml"}), "scene.toml",
                  "the scene is made of it", 2);
    expectRefusal(run({"tune", "in.vdb", "--error", "1N", "--overwrite", output, "in.vdb"}), "in.vdb",
                  "it is the input", 2);
  }
  expectRefusal(run({"plan", "nowhere.nrrd"}), "nowhere.nrrd", "no such file", 3);
  expectRefusal(run({"plan", "phantom:sphere?size=16", "--iso", "9999"}), "phantom:sphere", "isovalue", 2);
}

TEST_F(Verbs, CheckCountsAndReports) {
  const Outcome outcome = run({"check", "gradient", "phantom:random?size=13x21x10", "--json", "check.json"});
  expectSuccess(outcome);
  const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
  EXPECT_EQ(json["compared"], 4 * 13 * 21 * 10);
  EXPECT_EQ(json["differing"], 0);
  EXPECT_EQ(json["holds"], true);
  EXPECT_THAT(contentsOf(file("check.json")), testing::StartsWith("{\n  \"check\": \"gradient\",\n"));
  const Outcome bounded = run({"check", "gradient", "phantom:random?size=13x21x10", "--bound", "3"});
  expectSuccess(bounded);
  for (const auto& [text, bound] : {std::pair(outcome.out, "0"), std::pair(bounded.out, "3")}) {
    EXPECT_THAT(text, testing::StartsWith("gradient of phantom:random?size=13x21x10 on "));
    EXPECT_THAT(text, HasSubstr(fmt::format(": central, stored as float\n"
                                            "  values compared            10920\n"
                                            "  differing values               0\n"
                                            "  largest                        0 ULP\n"
                                            "  bound                          {} ULP: holds\n",
                                            bound)));
  }
}

// Of a range both ends are taken and what is beyond is not; the page names what was given.
TEST_F(Verbs, CheckTakesTheEndsOfItsRanges) {
  const Words median = {"check", "filters", "phantom:random?size=9x4x3", "--filter", "median:1", "--crop"};
  const Outcome cut = run(median + Words{"2"});
  expectSuccess(cut);
  EXPECT_THAT(cut.out, HasSubstr("(its middle 2 x 2 x 2 voxels)"));
  expectRefusal(run(median + Words{"1"}), "--crop", "1", 2);
  const Words edits = {"check", "edits", "phantom:random?size=9x4x3", "--edits"};
  EXPECT_THAT(run(edits + Words{"1"}).out, HasSubstr("1 at random, seed 1"));
  expectRefusal(run(edits + Words{"0"}), "--edits", "0", 2);
  expectSuccess(run({"convert", "phantom:random?size=6", "scan.nrrd"}));
  const Outcome all =
      run({"check", "all", file("scan.nrrd").string(), "--quick", "--crop", "5", "--seed", "7", "--page", "page.md"});
  expectSuccess(all);
  EXPECT_THAT(contentsOf(file("page.md")),
              HasSubstr("- command: `palpate check all scan.nrrd --quick --crop 5 --seed 7`\n"));
}

TEST_F(Verbs, CheckRefusesAFileThatCannotBeWrittenBeforeTheWork) {
  const Outcome outcome = run({"check", "gradient", "phantom:random?size=8", "--json", "none/a.json"});
  expectRefusal(outcome, "none/a.json", "cannot be created", 4);
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("loading")));
}

// Every operator, and both forms of samples, differ in no bit from the twin. But in a long run an operator has one
// form, in turn.
TEST_F(Verbs, CheckTakesOperatorsAndSamples) {
  bool takes_half = false;
  for (const char* way : {"central", "sobel", "central4", "gaussian:1.2"}) {
    takes_half = !takes_half;
    for (const char* samples : {"float", "half"}) {
      if (!isLongRun() && (std::string(samples) == "half") != takes_half) continue;
      const Outcome outcome = run({"check", "gradient", "phantom:random?size=13x21x10", "--operator", way, "--samples",
                                   samples, "--json", "check.json"});
      expectSuccess(outcome);
      const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
      EXPECT_EQ(json["compared"], 4 * 13 * 21 * 10);
      EXPECT_EQ(json["differing"], 0) << way << " " << samples;
      EXPECT_EQ(json["operator"], way);
      EXPECT_EQ(json["samples"], samples);
    }
  }
  expectRefusal(run({"check", "gradient", "phantom:box?size=8", "--operator", "prewitt"}), "prewitt", "central4", 2);
}

TEST_F(Verbs, GradientWritesVectorsAndRefusesItsInput) {
  const Outcome outcome = run({"gradient", "phantom:sphere?size=24", "-o", "g.vdb", "--operator", "sobel"});
  expectSuccess(outcome);
  EXPECT_TRUE(exists("g.vdb"));
  EXPECT_THAT(outcome.out, HasSubstr("sobel gradient of"));
  expectSuccess(run({"convert", "phantom:sphere?size=24", "v.vdb"}));
  expectRefusal(run({"gradient", "v.vdb", "-o", "v.vdb"}), "v.vdb", "it is the input", 2);
}

// The plan names the operator and says what halves save, and that a smoothed field is freed where nothing edits.
TEST_F(Verbs, PlanSaysOperatorAndSamples) {
  const Outcome half =
      run({"plan", "phantom:sphere?size=24", "--gradient-operator", "central4", "--samples", "half", "--rounds", "0"});
  expectSuccess(half);
  EXPECT_THAT(half.out, HasSubstr(": central4"));
  EXPECT_THAT(half.out, HasSubstr("samples as halves"));
  const Outcome smooth = run({"plan", "phantom:sphere?size=24", "--gradient-operator", "gaussian:1", "--rounds", "0"});
  expectSuccess(smooth);
  EXPECT_THAT(smooth.out, HasSubstr("smoothing of the whole field"));
  EXPECT_THAT(smooth.out, HasSubstr("freed then"));
  expectRefusal(run({"touch", "phantom:sphere?size=24", "--gradient-operator", "prewitt"}), "prewitt", "central4", 2);
  EXPECT_FALSE(exists("out"));
}

TEST_F(Verbs, CheckOfFiltersTellsEachAndHolds) {
  const Outcome outcome = run({"check", "filters", "phantom:random?size=13x21x10", "--json", "check.json"});
  expectSuccess(outcome);
  for (const FilterWords& words : filterTable()) EXPECT_THAT(outcome.out, HasSubstr(std::string(words.name) + ":"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("\n([0-9]+) of [0-9]+ checks hold\n"));
  EXPECT_THAT(outcome.out, HasSubstr("bilateral: exponentials"));  // why that one has a bound
  const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
  EXPECT_EQ(json["check"], "filters");
  EXPECT_EQ(json["holds"], true);
  EXPECT_GT(json["checks"].size(), 2 * filterTable().size());
}

TEST_F(Verbs, CheckOfFiltersTakesAChainACropAndAnIsovalue) {
  const Outcome outcome = run({"check", "filters", "phantom:knot?size=30", "--filter", "gaussian:1 distance:2", "--iso",
                               "10", "--crop", "12", "--json", "check.json"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("its middle 12 x 12 x 12 voxels"));
  const auto json = nlohmann::json::parse(contentsOf(file("check.json")));
  // Three axes, the distance, the distance against brute force, and the chain.
  ASSERT_EQ(json["checks"].size(), 6U);
  EXPECT_EQ(json["checks"][5]["compared"], 12 * 12 * 12);
  expectRefusal(run({"check", "filters", "phantom:box?size=8", "--filter", "mean:1"}), "mean", "there is no filter", 2);
}

TEST_F(Verbs, CheckOfEditsAndOfAllOnAVolume) {
  const Outcome edits = run({"check", "edits", "phantom:knot?size=24", "--edits", "30", "--seed", "5"});
  expectSuccess(edits);
  EXPECT_THAT(edits.out, HasSubstr("30 at random, seed 5"));
  EXPECT_THAT(edits.out, HasSubstr("1 of 1 checks hold"));
  const Outcome all = run({"check", "all", "phantom:knot?size=14", "--quick", "--page", "page.md"});
  expectSuccess(all);
  EXPECT_THAT(contentsOf(file("page.md")), HasSubstr("`palpate check all phantom:knot?size=14 --quick --seed 1`"));
  EXPECT_THAT(contentsOf(file("page.md")), HasSubstr("- `phantom:knot?size=14`"));
  for (const char* kind : {"gradient", "filter", "edits"})
    EXPECT_THAT(all.out, testing::ContainsRegex(std::string("\n  yes +") + kind));
  expectRefusal(run({"check", "edits", "phantom:box?size=8", "--iso", "1e9"}), "phantom:box", "isovalue", 2);
}

TEST_F(Verbs, FilterTakesTheIsovalueOfADistance) {
  const Words words = {"filter", "phantom:sphere?size=24", "-o", "d.nrrd", "--filter", "distance:3"};
  const Outcome own = run(words);
  expectSuccess(own);
  EXPECT_THAT(own.out, HasSubstr("densities -0.003 to 0.003"));
  expectSuccess(run(words + Words{"--iso", "50"}));
  for (const char* beyond : {"1e9", "1e300", "nan"}) {
    const Outcome refused = run(words + Words{"--iso", beyond});
    EXPECT_EQ(refused.status, 2) << beyond;
    expectRefusal(run({"check", "filters", "phantom:sphere?size=24", "--filter", "distance:3", "--iso", beyond}),
                  "phantom:sphere", "isovalue", 2);
  }
}

// An isovalue that nothing reads would be without effect, and nobody would know.
TEST_F(Verbs, FilterAndItsCheckRefuseAnIsovalueWithoutADistance) {
  const Words more = {"phantom:sphere?size=24", "--filter", "gaussian:1", "--iso", "50"};
  expectRefusal(run(Words{"filter", "-o", "d.nrrd"} + more), "--iso", "has a use for an isovalue", 2);
  expectRefusal(run(Words{"check", "filters"} + more), "--iso", "leave it out, or add a distance", 2);
  EXPECT_FALSE(exists("d.nrrd"));
}

// A distance has its surface at 0, wherever the density had it; Otsu would say otherwise.
TEST_F(Verbs, FilterKeepsOrTellsTheIsovalueOfItsResult) {
  const Words filter = {"filter", "phantom:sphere?size=24", "--filter", "gaussian:0.7 distance:3", "--iso", "50", "-o"};
  EXPECT_THAT(run(filter + Words{"d.vdb"}).out, HasSubstr("its surface is at 0, which the file keeps"));
  EXPECT_THAT(run({"info", "d.vdb"}).out, HasSubstr("surface      at isovalue 0, which the file keeps"));
  EXPECT_THAT(run(filter + Words{"d.nrrd"}).out, HasSubstr("give --iso 0 where it is used"));
  expectSuccess(run({"filter", "phantom:knot?size=24&noise=0.05", "--filter", "gaussian:1", "-o", "p.vdb"}));
  EXPECT_THAT(run({"info", "p.vdb"}).out, HasSubstr("surface      at isovalue 0, which the file keeps"));
}

TEST_F(Verbs, FilterSaysHowFarItReaches) {
  const Words filter = {"filter", "phantom:sphere?size=24&spacing=1x1x3mm", "-o", "f.vdb", "--filter"};
  EXPECT_THAT(run(filter + Words{"median:2mm"}).out, HasSubstr("1 pass reaching 2 x 2 x 0 voxels"));
  EXPECT_THAT(run(filter + Words{"median:0.2mm"}).out, HasSubstr("no size reaches a neighbouring voxel"));
  EXPECT_THAT(run(filter + Words{"gaussian:100"}).err,
              HasSubstr("gaussian of 100 voxels: along axis i it reaches 300"));
}

TEST_F(Verbs, CheckFiltersLeavesDistancesOutOfAVolumeOfOneDensity) {
  ASSERT_EQ(run({"filter", "phantom:sphere?size=16", "--filter", "erode:16", "-o", "flat.nrrd"}).status, 0);
  const Outcome outcome = run({"check", "filters", "flat.nrrd"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("distances are left out"));
}

// Programs and pages say the same words of a mask, and none of what was smoothed as they advise.
TEST_F(Verbs, SayThatAMaskIsFeltAsStairs) {
  NrrdBytes mask = ballNrrd();
  for (float& value : mask.values) value = value > 0 ? 1 : 0;
  write("mask.nrrd", mask.bytes());
  const Outcome info = run({"info", "mask.nrrd"});
  expectSuccess(info);
  EXPECT_THAT(info.out, HasSubstr("few values   it holds 2 values (0, 1), so its surface is felt as stairs"));
  const std::string told = "palpate: mask.nrrd: it holds 2 values (0, 1), so its surface is felt as stairs";
  EXPECT_THAT(run(quickTouch("mask.nrrd")).err, HasSubstr(told));
  EXPECT_THAT(run(quickTouch("mask.nrrd", {"--filter", "gaussian:1.5"})).err, testing::Not(HasSubstr("stairs")));
  expectSuccess(run({"filter", "mask.nrrd", "-o", "smooth.vdb", "--filter", "gaussian:1.5"}));
  EXPECT_THAT(run({"info", "smooth.vdb"}).out, testing::Not(HasSubstr("few values")));
  EXPECT_THAT(run({"info", "phantom:sphere?size=24"}).out, testing::Not(HasSubstr("few values")));
}

// docs/filters.md has the table of the code, row by row.
TEST_F(Verbs, FilterTableIsTheDocumentedOne) {
  std::string table = "| filter | size | what it does | keys |\n|---|---|---|---|\n";
  for (const FilterWords& words : filterTable()) {
    std::string keys(words.keys);
    for (std::size_t at = 0; (at = keys.find('|', at)) != std::string::npos; at += 2) keys.insert(at, "\\");
    table += "| `" + std::string(words.name) + "` | " + std::string(words.size) + " | " + std::string(words.what) +
             " | " + keys + " |\n";
  }
  const std::string page = contentsOf(PALPATE_DOCS "/filters.md");
  EXPECT_NE(page.find(table), std::string::npos) << "docs/filters.md must hold:\n" << table;
  const std::string help = run({"filter", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("docs/filters.md"));
}

TEST_F(Verbs, CheckRefusesAResultFileThatCannotBeWritten) {
  expectRefusal(run({"check", "gradient", "phantom:box?size=8", "--json", "nowhere/check.json"}), "nowhere/check.json",
                "cannot be created", 4);
}

}  // namespace verbs_test
}  // namespace palpate
