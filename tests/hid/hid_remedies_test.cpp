// SPDX-License-Identifier: Apache-2.0
// What devices, the doctor, the calibration and the faults tell a user to do can be done: each verb and flag that their
// words name is one of the program's.
#include <algorithm>
#include <regex>
#include <set>
#include <string_view>

#include "emulated_program.hpp"

namespace palpate {
namespace hid_remedies_test {

namespace fs = std::filesystem;

// The texts in a source file, one after another: between quotes, as the compiler joins them.
std::string textsOf(const fs::path& file) {
  const std::string source = contentsOf(file);
  std::string texts;
  bool in_text = false;
  std::size_t line = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (source[i] == '\n') {
      line = i + 1;
      in_text = false;
      continue;
    }
    const bool is_comment = source.compare(i, 2, "//") == 0 && !in_text;
    const bool is_include = source.compare(line, 8, "#include") == 0;
    if (is_comment || is_include) {
      i = std::min(source.find('\n', i), source.size()) - 1;
      continue;
    }
    if (source[i] == '\\' && in_text) {
      ++i;
      continue;
    }
    if (source[i] == '"')
      in_text = !in_text;
    else if (in_text)
      texts += source[i];
    else if (std::string_view(";,:(").find(source[i]) != std::string_view::npos)
      texts += '\n';  // another text begins
  }
  return texts;
}

std::set<std::string> wordsIn(const std::string& text, const std::regex& word) {
  std::set<std::string> words;
  for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at) words.insert((*at)[1]);
  return words;
}

class Remedies : public EmulatedHid {};

TEST_F(Remedies, NameVerbsAndFlagsThatExist) {
  static const std::regex kVerbLine(R"(\n  ([a-z-]+) {2,})"), kFlag(R"((--[a-z][a-z-]*[a-z]))"),
      kVerb(R"(palpate ([a-z][a-z-]+))");
  const std::set<std::string> verbs = wordsIn(run({"--help"}).out, kVerbLine);
  ASSERT_TRUE(verbs.contains("doctor") && verbs.contains("calibrate"));
  std::map<std::string, std::set<std::string>> flags_of;
  std::set<std::string> flags;
  for (const std::string& verb : verbs) {
    flags_of[verb] = wordsIn(run({verb, "--help"}).out, kFlag);
    flags.insert(flags_of[verb].begin(), flags_of[verb].end());
  }
  ASSERT_TRUE(flags.contains("--current-limit") && flags.contains("--install-udev"));

  const fs::path root = PALPATE_SOURCE;
  std::vector<fs::path> files;
  for (const char* folder :
       {"servo/devices", "servo/hid", "servo/safety", "apps/devices", "apps/held", "apps/doctor"}) {
    for (const auto& entry : fs::directory_iterator(root / folder)) {
      const std::string end = entry.path().extension().string();
      if (end == ".cpp" || end == ".hpp") files.push_back(entry.path());
    }
  }
  for (const char* file : {"verb_calibrate.cpp", "check_motors.cpp", "verb_doctor.cpp", "verb_devices.cpp"})
    files.push_back(root / "apps/palpate" / file);
  // What others' commands are told to do is not the program's.
  const std::set<std::string> others = {"--reload", "--subsystem-match"};
  int named = 0;
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    const std::string texts = textsOf(file);
    for (const std::string& verb : wordsIn(texts, kVerb)) {
      EXPECT_TRUE(verbs.contains(verb)) << "palpate " << verb;
      ++named;
    }
    for (const std::string& flag : wordsIn(texts, kFlag)) {
      EXPECT_TRUE(flags.contains(flag) || others.contains(flag)) << flag;
      ++named;
    }
    // A flag that is named with its verb is that verb's.
    static const std::regex kCommand(R"(palpate ([a-z]+)( [^'\n;()]*)?)");
    for (std::sregex_iterator at(texts.begin(), texts.end(), kCommand), end; at != end; ++at) {
      for (const std::string& flag : wordsIn((*at)[2], kFlag))
        EXPECT_TRUE(flags_of[(*at)[1]].contains(flag)) << (*at)[0];
    }
  }
  EXPECT_GT(named, 20);
}

}  // namespace hid_remedies_test
}  // namespace palpate
