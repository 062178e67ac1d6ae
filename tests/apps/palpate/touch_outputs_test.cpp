// SPDX-License-Identifier: Apache-2.0
// What `palpate touch` leaves behind: four files, each well formed, and in agreement with each other.
#include <regex>
#include <set>

#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "trace.hpp"

namespace palpate {
namespace touch_outputs_test {

using Json = nlohmann::json;

std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t n = 0; n < 4; ++n) value = value << 8 | static_cast<unsigned char>(bytes.at(at + n));
  return value;
}

class TouchOutputs : public ProgramTest {
 protected:
  [[nodiscard]] std::set<std::string> outputs() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(file("out"))) names.insert(entry.path().filename());
    return names;
  }
  [[nodiscard]] Json summary() const { return Json::parse(contentsOf(file("out/summary.json"))); }
};

TEST_F(TouchOutputs, AreFourFiles) {
  const Outcome outcome = run({"touch", "phantom:sphere?size=24", "--seconds", "0.3", "--clock", "simulated", "--width",
                               "480", "--height", "270", "--out", "out"});
  expectSuccess(outcome);
  EXPECT_THAT(outputs(), testing::ElementsAre("report.html", "summary.json", "trace.csv", "view.png"));
  for (const std::string& name : outputs()) EXPECT_THAT(outcome.out, testing::HasSubstr("out/" + name));

  // PNG: signature, then the header chunk with width and height, and at the end the chunk that says so.
  const std::string png = contentsOf(file("out/view.png"));
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(12, 4), "IHDR");
  EXPECT_EQ(bigEndian(png, 16), 480U);
  EXPECT_EQ(bigEndian(png, 20), 270U);
  EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
  EXPECT_THAT(contentsOf(file("out/report.html")), testing::HasSubstr("data:image/png;base64,iVBORw0KGgo"));
}

TEST_F(TouchOutputs, ReportNeedsNothingButItself) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24")));
  const std::string html = contentsOf(file("out/report.html"));
  EXPECT_THAT(html, testing::StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(html, testing::EndsWith("</html>\n"));
  // Whatever a browser would fetch: attributes of elements, and style sheets. Text of the page may name addresses.
  const std::regex fetched(
      R"re(<(?:script|img|link|iframe|source|object)[^>]*(?:src|href|data)="(?!data:)|@import|url\((?!["']?data:))re");
  std::smatch match;
  EXPECT_FALSE(std::regex_search(html, match, fetched)) << match.str();
}

TEST_F(TouchOutputs, TraceHasARowForEachTick) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--rate", "2000"})));
  const Trace trace = readTrace(file("out/trace.csv"));
  EXPECT_EQ(trace.header, kTraceHeader);
  ASSERT_EQ(trace.rows.size(), 600U);  // 0.3 s at 2000 Hz
  for (std::size_t tick = 0; tick < trace.rows.size(); ++tick) {
    const TraceRow& row = trace.rows[tick];
    ASSERT_EQ(row.cells.size(), 22U);
    EXPECT_EQ(row.tick(), static_cast<double>(tick));
    EXPECT_NEAR(row.time_s(), static_cast<double>(tick) / 2000, 1e-9);
    EXPECT_EQ(row.cost_ns(), 0);
    EXPECT_EQ(row.faults(), 0);
    EXPECT_TRUE(row.cells[15] == 0 || row.cells[15] == 1);
  }
}

// F = K d - B v: without damping and with a hand that does not yield, the force is the stiffness times the way from the
// HIP to the VHIP, along the normal; without contact there is none. Rounding: positions of 0.02 m hold 3e-18 m.
TEST_F(TouchOutputs, TraceObeysTheForceLaw) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--stiffness", "750", "--damping", "0"})));
  int contacts = 0;
  for (const TraceRow& row : readTrace(file("out/trace.csv")).rows) {
    if (!row.inContact()) {
      EXPECT_EQ(row.force_N().norm(), 0) << row.tick();
      EXPECT_EQ(row.vhip_W(), row.hip_W()) << row.tick();
      continue;
    }
    ++contacts;
    EXPECT_NEAR(row.normal_W().norm(), 1, 1e-12);
    EXPECT_LE((row.force_N() - 750 * (row.vhip_W() - row.hip_W())).norm(), 1e-12) << row.tick();
    EXPECT_GE(row.force_N().dot(row.normal_W()), 0) << "pulls inwards at tick " << row.tick();
  }
  EXPECT_GT(contacts, 150);  // press, slide and half of approach and retreat are more than half of 300 ticks
}

TEST_F(TouchOutputs, SummaryAgreesWithTheTrace) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--n", "1"})));
  const Trace trace = readTrace(file("out/trace.csv"));
  const Json summary = this->summary();
  double largest_N = 0;
  int contacts = 0;
  for (const TraceRow& row : trace.rows) {
    largest_N = std::max(largest_N, row.force_N().norm());
    contacts += row.inContact() ? 1 : 0;
  }
  EXPECT_EQ(summary["servo"]["ticks"], 300);
  EXPECT_EQ(summary["contact"]["ticks"], contacts);
  EXPECT_NEAR(summary["contact"]["force_N"]["max"].get<double>(), largest_N, 1e-9);
  EXPECT_EQ(summary["servo"]["times_measured"], false);
  EXPECT_EQ(summary["volume"]["name"], "phantom:sphere?size=24");
  EXPECT_EQ(summary["scene"]["servo"]["n"], 1);
  EXPECT_THAT(summary["command"].get<std::string>(), testing::HasSubstr("--n 1"));
}

// Those of an earlier run in the same folder too, which would pass for this run's.
TEST_F(TouchOutputs, TraceOffAndPictureOffLeaveTheirFilesOut) {
  expectSuccess(run({"touch", "phantom:sphere?size=24", "--seconds", "0.1", "--clock", "simulated", "--width", "480",
                     "--height", "270", "--out", "out"}));
  ASSERT_EQ(outputs().size(), 4U);
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--trace", "off"})));
  EXPECT_THAT(outputs(), testing::ElementsAre("report.html", "summary.json"));
  EXPECT_EQ(summary()["files"].size(), 2U);
}

TEST_F(TouchOutputs, ASecondRunReplacesTheFirst) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24")));
  expectSuccess(run(quickTouch("phantom:box?size=24")));
  EXPECT_EQ(summary()["volume"]["name"], "phantom:box?size=24");
  EXPECT_THAT(outputs(), testing::ElementsAre("report.html", "summary.json", "trace.csv"));
}

// What the program says repeats the run does repeat it, blanks and quotes in names included.
TEST_F(TouchOutputs, CommandOfTheSummaryRepeatsTheRun) {
  const std::string out = "the tool's out";
  expectSuccess(run({"touch", "phantom:sphere?size=24&noise=0.01", "--seconds", "0.1", "--clock", "simulated",
                     "--picture", "off", "--iso", "-20", "--out", out}));
  const std::string first = contentsOf(file(out) / "trace.csv");
  const std::string command = Json::parse(contentsOf(file(out) / "summary.json"))["command"];
  std::filesystem::remove_all(file(out));
  ASSERT_THAT(command, testing::StartsWith("palpate touch "));
  const std::string line = "cd '" + folder().string() + "' && '" PALPATE_PROGRAM "'" + command.substr(7) + " >log 2>&1";
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
  EXPECT_EQ(contentsOf(file(out) / "trace.csv"), first);
}

// A journal is of one run: the line names another folder, though the scene file or the flag names this one.
TEST_F(TouchOutputs, CommandOfARunWithAJournalRepeatsIt) {
  write("s.toml", "[edit]\njournal = \"kept\"\nbrush = \"remove:radius=2mm\"\n");
  for (const Words& journal : {Words{"--journal", "my journal/", "--edit", "remove:radius=2mm"}, Words{"s.toml"}}) {
    Words words = {
        "touch", "phantom:sphere?size=24", "--seconds", "0.2", "--clock", "simulated", "--picture", "off", "--out",
        "out"};
    if (journal.size() == 1) words = Words{"touch", "s.toml", "--volume"} + Words(words.begin() + 1, words.end());
    expectSuccess(run(journal.size() == 1 ? words : words + journal));
    const std::string first = contentsOf(file("out/trace.csv"));
    for (int again = 0; again < 2; ++again) {
      const std::string command = summary()["command"];
      const std::string line =
          "cd '" + folder().string() + "' && '" PALPATE_PROGRAM "'" + command.substr(7) + " >log 2>&1";
      ASSERT_EQ(std::system(line.c_str()), 0) << line << "\n" << contentsOf(file("log"));
      EXPECT_EQ(contentsOf(file("out/trace.csv")), first);
    }
    EXPECT_TRUE(exists(journal.size() == 1 ? "kept-3" : "my journal-3"));
  }
}

// A number of up to six figures at the end goes on, whatever else there is becomes the first of a series.
TEST_F(TouchOutputs, CommandNamesTheNextJournal) {
  for (const auto& [given, next] : {std::pair("kept", "kept-2"), std::pair("k-9/", "k-10"),
                                    std::pair("k-123456", "k-123457"), std::pair("k-1234567", "k-1234567-2"),
                                    std::pair("j-", "j--2"), std::pair("a-2b", "a-2b-2"), std::pair("7", "7-2")}) {
    expectSuccess(run(quickTouch("phantom:sphere?size=16", {"--edit", "remove:radius=2mm", "--journal", given})));
    EXPECT_THAT(summary()["command"].get<std::string>(), testing::HasSubstr(std::string(" --journal ") + next + " "));
  }
}

// What somebody else put there is not replaced, and found before the volume is loaded.
TEST_F(TouchOutputs, ForeignFilesAreLeftAlone) {
  std::filesystem::create_directory(file("out"));
  write("out/report.html", "mine");
  expectRefusal(run(quickTouch("phantom:sphere?size=24")), "out/report.html", "it is not a result of palpate", 2);
  EXPECT_EQ(contentsOf(file("out/report.html")), "mine");
  EXPECT_THAT(outputs(), testing::ElementsAre("report.html"));
  std::filesystem::remove(file("out/report.html"));
  write("out/notes.txt", "mine");
  expectSuccess(run(quickTouch("phantom:sphere?size=24")));
  expectSuccess(run(quickTouch("phantom:sphere?size=24")));
  EXPECT_EQ(contentsOf(file("out/notes.txt")), "mine");
}

// Errors against a surface that the run did not touch would be no errors: only the phantom's own isovalue is exact.
TEST_F(TouchOutputs, ExactErrorsOnlyAtTheExactSurface) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--iso", "200"})));
  EXPECT_TRUE(summary()["exact"].is_null());
  expectSuccess(run(quickTouch("phantom:sphere?size=24", {"--iso", "0"})));
  EXPECT_FALSE(summary()["exact"].is_null());
}

// On a loaded machine ticks may be left out, but none is repeated and their times are measured.
TEST_F(TouchOutputs, RealClockMeasuresItsTicks) {
  expectSuccess(run({"touch", "phantom:sphere?size=24", "--seconds", "0.3", "--picture", "off", "--out", "out"}));
  const Trace trace = readTrace(file("out/trace.csv"));
  EXPECT_LE(trace.rows.size(), 300U);
  EXPECT_GT(trace.rows.size(), 30U);
  for (std::size_t n = 1; n < trace.rows.size(); ++n) EXPECT_GT(trace.rows[n].tick(), trace.rows[n - 1].tick());
  for (const TraceRow& row : trace.rows) EXPECT_GT(row.cost_ns(), 0);
  EXPECT_EQ(summary()["servo"]["times_measured"], true);
}

}  // namespace touch_outputs_test
}  // namespace palpate
