// SPDX-License-Identifier: Apache-2.0
// What the program tells of itself: the help of all verbs, the tables that pages show, and the command lines that it
// and the pages give to a person.
#include <iomanip>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/scene/option_table.hpp"
#include "apps/sculpt/tick_recording.hpp"
#include "engine/filter/filter_spec.hpp"
#include "program_test.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace help_test {

using testing::HasSubstr;

class Help : public ProgramTest {};

TEST_F(Help, HelpOfEachSaysWhatItDoes) {
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

TEST_F(Help, HelpOfTheProgramNamesEveryVerb) {
  const std::string help = run({"--help"}).out;
  for (const char* verb : {"touch", "edit", "recover", "info", "convert", "render", "check", "bench", "devices", "plan",
                           "tune", "scene", "faults"}) {
    EXPECT_THAT(help, testing::ContainsRegex(std::string("\n  ") + verb + " +[a-z]"));
  }
}

// Each flag with its key, and its unit and default where it has them.
TEST_F(Help, HelpOfTouchShowsUnitsAndDefaults) {
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

// Of the device, the flags that a window reads, with what it begins with.
TEST_F(Help, HelpOfSculptHasTheDevicesFlags) {
  const std::string help = run({"sculpt", "--help"}).out;
  EXPECT_THAT(help, testing::ContainsRegex("--device [^\n]*default mouse; key device.name"));
  for (const char* flag : {"--device-path", "--hid", "--calibrated", "--current-limit", "--place-at", "--place-turn",
                           "--place-scale", "--force-scale", "--clutch", "--edge"})
    EXPECT_THAT(help, HasSubstr(std::string("\n  ") + flag + " "));
  EXPECT_THAT(help, testing::Not(HasSubstr("--device-mass")));
  expectRefusal(run({"sculpt", "phantom:sphere", "--force-scale", "0"}), "--force-scale", "'0' is not what it takes",
                2);
}

TEST_F(Help, TouchHasNoMouse) {
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--device", "mouse"}), "--device mouse",
                "a run along a path has no window, and so no pointer", 2);
}

TEST_F(Help, VersionNamesProgramAndCommit) {
  const Outcome outcome = run({"--version"});
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, testing::MatchesRegex("palpate [0-9]+\\.[0-9]+\\.[0-9]+ \\([0-9a-z-]+\\)\n"));
}

TEST_F(Help, DevicesListsADeviceAndTheDefault) {
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

TEST_F(Help, SceneIsTheDocumentedTable) {
  const Outcome outcome = run({"scene"});
  expectSuccess(outcome);
  EXPECT_EQ(outcome.out, contentsOf(PALPATE_DOCS "/scene.md"));
}

TEST_F(Help, FaultsIsTheDocumentedTable) {
  const Outcome outcome = run({"faults"});
  expectSuccess(outcome);
  EXPECT_EQ(outcome.out, contentsOf(PALPATE_DOCS "/faults.md"));
}

// docs/filters.md has the table of the code, row by row.
TEST_F(Help, FilterTableIsTheDocumentedOne) {
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

// The line that a window gives for a recording, as a person pastes it. The path, the settings and the volume have names
// and values that a shell or the parser could take for something else.
TEST_F(Help, AReplayIsTakenByTheProgram) {
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
TEST_F(Help, CommandLinesThatAreToldHaveFlagsThatExist) {
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

// Names of phantoms with keys that stand without quotes: a shell takes '?' and '&' for itself.
Words unquotedPhantoms(const std::string& text) {
  Words found;
  for (std::size_t at = text.find("phantom:"); at != std::string::npos; at = text.find("phantom:", at + 1)) {
    const std::string name = text.substr(at, text.find_first_of(" \n,;)`'\"", at) - at);
    if (name.find('?') != std::string::npos && (at == 0 || text[at - 1] != '\'')) found.push_back(name);
  }
  return found;
}

TEST_F(Help, ExamplesCanBeGivenToAShell) {
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

}  // namespace help_test
}  // namespace palpate
