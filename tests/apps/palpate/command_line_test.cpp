// SPDX-License-Identifier: Apache-2.0
// What helps a user to find the words of a command line: help, suggestions, completion; and that each refusal of an
// option names its flag.
#include <cstdlib>
#include <set>

#include <fmt/format.h>

#include "apps/scene/option_table.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace command_line_test {

using testing::HasSubstr;
using testing::Not;

const Words kVerbs = {"touch",     "edit", "recover", "info",   "convert", "gradient", "filter",    "serve",   "servo",
                      "ctl",       "top",  "render",  "sculpt", "check",   "bench",    "stability", "devices", "doctor",
                      "calibrate", "plan", "tune",    "scene",  "faults",  "help",     "completion"};
const std::vector<Words> kVerbsBelow = {
    {"check", "gradient"}, {"check", "filters"}, {"check", "edits"}, {"check", "all"},     {"bench", "servo"},
    {"bench", "loop"},     {"bench", "edit"},    {"bench", "load"},  {"bench", "filters"}, {"bench", "gradient"}};

class CommandLine : public ProgramTest {
 protected:
  // What bash offers for the words, of which the last is being typed.
  [[nodiscard]] Words offered(const Words& words) const {
    write("completion", run({"completion", "bash"}).out);
    std::string script = "source completion; COMP_WORDS=(palpate";
    for (const std::string& word : words) script += " '" + word + "'";
    script +=
        "); COMP_CWORD=" + std::to_string(words.size()) + "; _palpate; printf '%s\\n' \"${COMPREPLY[@]}\" > offered";
    write("script", script);
    const std::string command = "cd '" + folder().string() + "' && bash script 2> errors";
    EXPECT_EQ(std::system(command.c_str()), 0) << contentsOf(file("errors"));
    EXPECT_EQ(contentsOf(file("errors")), "");
    Words found;
    std::istringstream in(contentsOf(file("offered")));
    for (std::string line; std::getline(in, line);) {
      if (!line.empty()) found.push_back(line);
    }
    return found;
  }
};

// Options that are no part of a scene are read by the library of flags.
TEST_F(CommandLine, WordsAreNoNumbers) {
  expectRefusal(run({"filter", "phantom:sphere?size=16", "-o", "x.nrrd", "--filter", "distance:3", "--iso", "foo"}),
                "--iso",
                "'foo' is not what it takes; give a number, and a whole one where it counts something; 'palpate", 2);
}

TEST_F(CommandLine, CalibratingWithoutADeviceTellsWhereTheyAreListed) {
  expectRefusal(run({"calibrate"}), "--device", "no device is named; 'palpate devices' lists what is here", 2);
}

// The same page, whichever way it is asked for.
TEST_F(CommandLine, HelpIsAVerbToo) {
  std::vector<Words> all = kVerbsBelow;
  all.emplace_back();
  for (const std::string& verb : kVerbs) all.push_back({verb});
  for (const Words& verb : all) {
    const Outcome page = run(Words{"help"} + verb);
    expectSuccess(page);
    EXPECT_EQ(page.out, run(verb + Words{"--help"}).out);
    EXPECT_THAT(page.out, HasSubstr("Usage: palpate"));
  }
  expectRefusal(run({"help", "tuoch"}), "tuoch", "no such verb; did you mean touch?", 2);
  expectRefusal(run({"help", "check", "edit"}), "edit", "no such verb; did you mean edits? 'palpate check --help'", 2);
}

TEST_F(CommandLine, TheVersionHasAShortFlag) {
  EXPECT_EQ(run({"-v"}).out, run({"--version"}).out);
  EXPECT_EQ(run({"-v"}).status, 0);
}

TEST_F(CommandLine, SuggestsTheVerbThatWasMeant) {
  expectRefusal(run({"tuoch", "phantom:sphere"}), "tuoch", "there is no such verb; did you mean touch?", 2);
  expectRefusal(run({"bench", "serv"}), "serv", "did you mean servo? 'palpate bench --help'", 2);
  EXPECT_THAT(run({"colour"}).err, Not(HasSubstr("did you mean")));
}

TEST_F(CommandLine, SuggestsTheFlagThatWasMeant) {
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--stifness", "500"}), "--stifness 500: not expected",
                "did you mean --stiffness?", 2);
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--second=3"}), "--second=3: not expected",
                "did you mean --seconds?", 2);
  expectRefusal(run({"bench", "loop", "--secnods", "3"}), "--secnods 3: not expected", "did you mean --seconds?", 2);
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--friction"}), "--friction: not expected",
                "did you mean --friction-static, --friction-dynamic or --friction-viscous?", 2);
  expectRefusal(run({"--versoin"}), "--versoin: not expected", "did you mean --version?", 2);
  EXPECT_THAT(run({"info", "phantom:box", "--colour"}).err, Not(HasSubstr("did you mean")));
}

TEST_F(CommandLine, WhatIsNotExpectedStandsAsItWasGiven) {
  EXPECT_THAT(run({"touch", "phantom:sphere?size=16", "--second", "3"}).err,
              HasSubstr("palpate: --second 3: not expected;"));
  EXPECT_THAT(run({"info", "phantom:box", "a", "--b", "c"}).err, HasSubstr("palpate: a --b c: not expected;"));
}

// Every table of the scene file is a group, and each flag stands in one.
TEST_F(CommandLine, HelpOfTouchIsInGroups) {
  for (const std::string verb : {"touch", "plan", "serve"}) {
    const std::string help = run({verb, "--help"}).out;
    std::set<std::string> groups;
    for (const SceneOption& option : sceneOptions()) {
      if (verb != "serve" && isOfService(option)) {
        EXPECT_THAT(help, Not(HasSubstr(std::string("\n  ") + option.flag + " ")));
        continue;
      }
      const auto group = help.find(std::string("\n") + optionGroup(option) + ":\n");
      const auto flag = help.find(std::string("\n  ") + option.flag + " ");
      ASSERT_NE(group, std::string::npos) << option.flag;
      ASSERT_NE(flag, std::string::npos) << option.flag;
      const std::string between = help.substr(group + 1, flag - group - 1);
      EXPECT_THAT(between, Not(HasSubstr("\n\n"))) << option.flag << " stands under another heading";
      groups.insert(optionGroup(option));
    }
    EXPECT_EQ(groups.size(), verb == "serve" ? 11U : 10U);
  }
}

TEST_F(CommandLine, BashCompletesVerbs) {
  EXPECT_THAT(offered({""}), testing::UnorderedElementsAreArray(kVerbs));
  EXPECT_THAT(offered({"tou"}), testing::ElementsAre("touch"));
  EXPECT_THAT(offered({"bench", "ser"}), testing::ElementsAre("servo", "service"));
  EXPECT_THAT(offered({"help", "con"}), testing::ElementsAre("convert"));
  EXPECT_THAT(offered({"touch", ""}), testing::IsEmpty());  // then the shell offers files
  EXPECT_THAT(offered({"completion", ""}), testing::UnorderedElementsAre("bash", "zsh"));
  EXPECT_THAT(offered({"help", "check", ""}), testing::UnorderedElementsAre("gradient", "filters", "edits", "all"));
  EXPECT_THAT(offered({"help", "bench", "lo"}), testing::ElementsAre("loop", "load"));
  for (const char* verb : {"touch", "completion", "help"})
    EXPECT_THAT(offered({"help", verb, ""}), testing::IsEmpty()) << verb;
}

// bash splits words at '='; where COMP_WORDBREAKS has none, they stay one.
TEST_F(CommandLine, BashCompletesAValueBehindAnEqualsSign) {
  EXPECT_THAT(offered({"touch", "--clock", "=", "s"}), testing::ElementsAre("simulated"));
  EXPECT_THAT(offered({"touch", "--clock", "="}), testing::UnorderedElementsAre("real", "simulated"));
  EXPECT_THAT(offered({"touch", "--clock=s"}), testing::ElementsAre("--clock=simulated"));
  EXPECT_THAT(offered({"touch", "--clock="}), testing::UnorderedElementsAre("--clock=real", "--clock=simulated"));
  EXPECT_THAT(offered({"touch", "a.nrrd", "--algorithm", "=", "h"}),
              testing::UnorderedElementsAreArray(offered({"touch", "a.nrrd", "--algorithm", "h"})));
  EXPECT_THAT(offered({"bench", "--json", "=", ""}), testing::IsEmpty());  // then the shell offers files
}

TEST_F(CommandLine, BashCompletesEveryFlagAndItsWords) {
  const Words flags = offered({"touch", "phantom:sphere", "--"});
  for (const SceneOption& option : sceneOptions()) {
    EXPECT_EQ(std::ranges::count(flags, option.flag), isOfService(option) ? 0 : 1) << option.flag;
    const Words words = optionWords(option.value);
    if (words.empty() || isBare(option.value)) continue;
    EXPECT_THAT(offered({isOfService(option) ? "serve" : "touch", option.flag, ""}),
                testing::UnorderedElementsAreArray(words))
        << option.flag;
  }
  EXPECT_THAT(flags, testing::Contains("--object"));
  EXPECT_THAT(offered({"check", "gradient", "x.nrrd", "--samples", ""}), testing::ElementsAre("float", "half"));
  EXPECT_THAT(offered({"convert", "a", "b", "--unit", "m"}), testing::UnorderedElementsAre("m", "mm"));
  EXPECT_THAT(offered({"completion", "-"}), testing::UnorderedElementsAre("-h", "--help"));
  EXPECT_THAT(offered({"touch", "--out", ""}), testing::IsEmpty());
}

TEST_F(CommandLine, CompletionIsOfAShellThatIsKnown) {
  expectRefusal(run({"completion", "fish"}), "fish", "zsh", 2);
  expectSuccess(run({"completion", "zsh"}));
  const std::string zsh = run({"completion", "zsh"}).out;
  EXPECT_THAT(zsh, testing::StartsWith("#compdef palpate\n"));
  for (const char* words :
       {"\n    'touch --clock') values=(real simulated) ;;\n",
        "\n    'completion')\n      verbs=('bash:bash or zsh' 'zsh:bash or zsh')\n      flags=('--help:Print this help",
        "\n        '--hand:rigid\\: the device is exactly on the path; spring\\: a hand",
        "\n    'help bench')\n      verbs=('servo:", " beside cyclictest'\\''s ("})
    EXPECT_THAT(zsh, HasSubstr(words));
}

TEST_F(CommandLine, ZshTakesItsCompletion) {
  if (std::system("command -v zsh > /dev/null") != 0) GTEST_SKIP() << "there is no zsh";
  write("_palpate", run({"completion", "zsh"}).out);
  const std::string zsh = "cd '" + folder().string() + "' && ";
  EXPECT_EQ(std::system((zsh + "zsh -fn _palpate").c_str()), 0);
  // The functions that a shell offers its completions with are put down as what they were given.
  write("script",
        R"(compdef() { :; }
source ./_palpate
_describe() { local name=${@[-1]}; print -l -- ${(P)name}; }
compadd() { print -l -- ${(P)2}; }
_files() { print files; }
compset() { print -- "$*"; }
for line in 'palpate ' 'palpate touch --' 'palpate touch --clock ' 'palpate bench ' 'palpate help bench ' 'palpate completion ' 'palpate touch --clock=s' 'palpate touch --out=s' 'palpate info '; do
  words=(${(s: :)line}); [[ $line == *' ' ]] && words+=('')
  CURRENT=$#words
  print "<$line>"
  _palpate
done
)");
  EXPECT_EQ(std::system((zsh + "zsh -f script > offered 2>&1").c_str()), 0);
  const std::string offered = contentsOf(file("offered"));
  EXPECT_THAT(offered, HasSubstr("touch:palpate a volume along a path"));
  EXPECT_THAT(offered, HasSubstr("\n--stiffness:stiffness of the contact, K; if not given 500"));
  EXPECT_THAT(offered, HasSubstr("<palpate touch --clock >\nreal\nsimulated\n<palpate bench >\nservo:"));
  EXPECT_THAT(offered, HasSubstr("<palpate help bench >\nservo:"));
  EXPECT_THAT(offered, HasSubstr("<palpate completion >\nbash:bash or zsh\nzsh:bash or zsh\n"));
  // The shell offers values for what is left behind '=', of which it knows by compset.
  EXPECT_THAT(offered, HasSubstr("<palpate touch --clock=s>\n-P *=\nreal\nsimulated\n<palpate touch --out=s>\n"));
  EXPECT_THAT(offered, HasSubstr("<palpate touch --out=s>\n-P *=\nfiles\n"));
  EXPECT_THAT(offered, testing::EndsWith("<palpate info >\nfiles\n"));
}

// Help and refusal of a number say the same range, and both have the flag.
TEST_F(CommandLine, ARefusedNumberIsToldItsFlagAndTheRangeOfTheHelp) {
  const std::string help = run({"touch", "--help"}).out;
  EXPECT_THAT(help,
              HasSubstr("no larger force leaves the safety gate [N] (a number above 0, at most 1000; default 8;"));
  expectRefusal(run({"touch", "phantom:sphere?size=16", "--force-limit", "0"}), "--force-limit: '0'",
                "give a number above 0, at most 1000", 2);
  expectSuccess(run(quickTouch("phantom:sphere?size=16", {"--force-limit", "1e-9"})));
}

// Settings that do not fit together are found by the servo, which knows no flags.
TEST_F(CommandLine, SettingsThatDoNotFitAreToldTheirFlags) {
  const auto touch = [&](const Words& more) { return run(quickTouch("phantom:sphere?size=16", more)); };
  expectRefusal(touch({"--friction-dynamic", "0.5"}), "--friction-dynamic (key contact.friction_dynamic)",
                "give at most the static friction", 2);
  expectRefusal(touch({"--algorithm", "haptization", "--haptization-density", "5:0:0,-5:1:0"}),
                "--haptization-density (key haptization.density)", "row 2", 2);
  expectRefusal(touch({"--stiffness-density", "5:1,-5:1"}), "--stiffness-density (key contact.stiffness_density)",
                "comes after", 2);
}

// The ends of every range that the help gives make a run, or are refused by the flag. Two options at a time, one at its
// lowest, the next at its highest: a run for each.
// Whether the system allows it or not; the flag has no value, so the volume may follow it.
TEST_F(CommandLine, RealTimeMayBeRequired) {
  const Words words = {"touch", "--require-real-time", "phantom:sphere?size=16", "--picture", "off", "--seconds",
                       "0.1"};
  const Outcome outcome = run(words);
  if (outcome.status == 0) {
    EXPECT_THAT(contentsOf(file("out/summary.json")), testing::HasSubstr("\"require_real_time\": \"on\""));
    EXPECT_THAT(contentsOf(file("out/summary.json")), testing::HasSubstr("SCHED_FIFO priority"));
  } else {
    expectRefusal(outcome, "real time", "leave --require-real-time out", 6);
  }
  EXPECT_THAT(run(words + Words{"--clock", "simulated"}).err, testing::HasSubstr("--require-real-time has no effect"));
}

TEST_F(CommandLine, EveryEndOfARangeMakesARun) {
  struct Ends {
    std::string flag, lowest, highest;
  };
  std::vector<Ends> all;
  for (const SceneOption& option : sceneOptions()) {
    if (const auto* number = std::get_if<NumberOption>(&option.value)) {
      const double above = number->above_lowest ? 1e-9 * number->highest : 0;
      all.push_back(
          {option.flag, fmt::format("{:.17g}", number->lowest + above), fmt::format("{:.17g}", number->highest)});
    } else if (const auto* integer = std::get_if<IntegerOption>(&option.value)) {
      all.push_back({option.flag, std::to_string(integer->lowest), std::to_string(integer->highest)});
    }
  }
  // An isovalue is the volume's; how long the run takes is given below, a picture and a file are not made.
  std::erase_if(all, [](const Ends& ends) {
    return ends.flag == "--iso" || ends.flag == "--seconds" || ends.flag == "--width" || ends.flag == "--height" ||
           ends.flag == "--save-every";
  });
  ASSERT_GT(all.size(), 25U);
  // But in a long run every other pair: each flag has one of its ends then.
  for (std::size_t i = 0; i < all.size(); i += isLongRun() ? 1 : 2) {
    const Ends &low = all[i], &high = all[(i + 1) % all.size()];
    const Outcome outcome =
        runPalpate({.arguments = {"touch", "phantom:sphere?size=16", "--clock", "simulated", "--picture", "off",
                                  "--seconds", "0.1", low.flag, low.lowest, high.flag, high.highest},
                    .folder = folder()});
    if (outcome.status == 0) continue;
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_TRUE(outcome.err.find(low.flag) != std::string::npos || outcome.err.find(high.flag) != std::string::npos)
        << low.flag << " " << low.lowest << " " << high.flag << " " << high.highest << ": " << outcome.err;
  }
}

}  // namespace command_line_test
}  // namespace palpate
