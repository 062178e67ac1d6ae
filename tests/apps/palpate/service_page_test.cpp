// SPDX-License-Identifier: Apache-2.0
// Each sentence of docs/service.md is held by a test, or says why none can hold it (service_page.txt). A sentence that
// is new wants its line there; a test that is named there exists. A row has a checksum of its whole sentence: whoever
// changes one must look again at what is named there. The row with the new checksum is printed where it is wanted.
//
// It does not show that a named test holds all that the sentence says, or is the right one: only somebody who reads
// both sees that. Nor is a sentence found to be wrong when the program changes and the page does not. Code, headings
// and figures in other pages are not looked at.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "base/crc32c.hpp"
#include "program_test.hpp"

namespace palpate {
namespace service_page_test {

struct Held {
  std::string beginning, checksum;
  std::vector<std::string> tests;
  std::string why_none;
};

std::vector<Held> heldSentences() {
  std::vector<Held> all;
  std::istringstream in(contentsOf(PALPATE_SERVICE_PAGE));
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    if (!line.starts_with("    ")) {
      all.push_back({.beginning = line, .checksum = {}, .tests = {}, .why_none = {}});
      continue;
    }
    const std::size_t bracket = line.find('(');
    if (bracket != line.npos) all.back().why_none = line.substr(bracket);
    std::istringstream words(line.substr(0, bracket));
    if (all.back().checksum.empty()) words >> all.back().checksum;
    for (std::string word; words >> word;) all.back().tests.push_back(word);
  }
  return all;
}

// A sentence ends at a mark behind which a capital, code, a bracket or a link begins.
void addSentences(const std::string& paragraph, std::vector<std::string>& all) {
  constexpr std::string_view kEnds = ".?!:", kBegins = "ABCDEFGHIJKLMNOPQRSTUVWXYZ`[(";
  std::size_t from = 0;
  for (std::size_t at = 0; at + 2 < paragraph.size(); ++at) {
    if (kEnds.find(paragraph[at]) == kEnds.npos || paragraph[at + 1] != ' ' ||
        kBegins.find(paragraph[at + 2]) == kBegins.npos)
      continue;
    all.push_back(paragraph.substr(from, at + 1 - from));
    from = at + 2;
  }
  if (from < paragraph.size()) all.push_back(paragraph.substr(from));
}

// Without headings and code. A row of a table is one.
std::vector<std::string> sentencesOf(const std::string& page) {
  std::vector<std::string> all;
  std::string paragraph;
  const auto endParagraph = [&] {
    addSentences(paragraph, all);
    paragraph.clear();
  };
  std::istringstream in(page);
  for (std::string line; std::getline(in, line);) {
    const bool is_row = line.starts_with("| ");
    if (line.empty() || line.starts_with("    ") || line.starts_with('#') || line.starts_with('|')) endParagraph();
    if (is_row) all.push_back(line.substr(2));
    if (line.empty() || line.starts_with("    ") || line.starts_with('#') || line.starts_with('|')) continue;
    paragraph += (paragraph.empty() ? "" : " ") + line;
  }
  endParagraph();
  return all;
}

std::string checksumOf(const std::string& sentence) {
  return fmt::format("{:08x}", crc32c(sentence));
}

// As it is to stand in the file.
std::string rowOf(const Held& one, const std::string& sentence) {
  return fmt::format("{}\n    {} {}{}{}\n", one.beginning, checksumOf(sentence), fmt::join(one.tests, " "),
                     one.tests.empty() || one.why_none.empty() ? "" : " ", one.why_none);
}

std::set<std::string> testsThatExist() {
  std::set<std::string> all;
  const std::regex head(R"(^TEST(?:_F|_P)?\((\w+), (\w+)\))");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(PALPATE_TESTS)) {
    if (!entry.path().string().ends_with("_test.cpp")) continue;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (line.starts_with("TEST") && std::regex_search(line, match, head))
        all.insert(match.str(1) + "." + match.str(2));
    }
  }
  return all;
}

TEST(ServicePage, EachSentenceIsHeld) {
  const std::vector<Held> held = heldSentences();
  std::set<std::string> used;
  const std::vector<std::string> sentences = sentencesOf(contentsOf(PALPATE_DOCS "/service.md"));
  ASSERT_GT(sentences.size(), 100U);
  for (const std::string& sentence : sentences) {
    const auto row = std::ranges::find_if(
        held, [&](const Held& one) { return sentence.starts_with(one.beginning) && !used.contains(one.beginning); });
    EXPECT_NE(row, held.end()) << "no line of service_page.txt is about: " << sentence;
    if (row == held.end()) continue;
    used.insert(row->beginning);
    EXPECT_EQ(row->checksum, checksumOf(sentence))
        << "the sentence is another one: see that what is named for it still holds it, and then write\n"
        << rowOf(*row, sentence) << "of: " << sentence;
  }
  for (const Held& one : held)
    EXPECT_TRUE(used.contains(one.beginning)) << "not on the page any more: " << one.beginning;
}

TEST(ServicePage, EachTestExists) {
  const std::set<std::string> there = testsThatExist();
  for (const Held& one : heldSentences()) {
    EXPECT_FALSE(one.tests.empty() && one.why_none.empty()) << one.beginning;
    for (const std::string& test : one.tests) EXPECT_TRUE(there.contains(test)) << test << " of: " << one.beginning;
  }
}

}  // namespace service_page_test
}  // namespace palpate
