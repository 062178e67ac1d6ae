// SPDX-License-Identifier: Apache-2.0
#include "apps/report/html_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/report/html_text.hpp"
#include "apps/report/page_files.hpp"
#include "base/error.hpp"
#include "sample_run.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace html_report_test {

using ::testing::HasSubstr;
using ::testing::Not;

// The page without what stands between script tags: there, attributes are text of a program.
std::string withoutScripts(std::string page) {
  for (auto at = page.find("<script"); at != std::string::npos; at = page.find("<script", at + 1)) {
    const auto body = page.find('>', at) + 1;
    page.erase(body, page.find("</script>", body) - body);
  }
  return page;
}

// The beginning of every attribute value that makes a browser fetch something.
std::vector<std::string> fetched(const std::string& page) {
  const std::string markup = withoutScripts(page);
  std::vector<std::string> found;
  for (const std::string attribute : {"src=", "href=", "srcset=", "action=", "poster=", "background="}) {
    for (auto at = markup.find(attribute); at != std::string::npos; at = markup.find(attribute, at + 1)) {
      found.push_back(markup.substr(at + attribute.size() + 1, 20));
    }
  }
  return found;
}

std::size_t countOf(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(Report, FetchesNothing) {
  TouchRun run = sampleRun();
  const std::string page = makeReport(run, "PNG");
  const auto references = fetched(page);
  EXPECT_THAT(references, ::testing::SizeIs(2));  // the picture and the empty icon
  for (const std::string& reference : references) EXPECT_TRUE(reference.starts_with("data:")) << reference;
  for (const char* way : {"@import", "url(", "fetch(", "XMLHttpRequest(", "import("}) {
    EXPECT_EQ(countOf(page, way), countOf(std::string(kDygraphsJs), way))
        << way;  // dygraphs can read URLs if it is given one
  }
  // The one address is the licence in the plotting library's own comment.
  EXPECT_EQ(countOf(page, "http:") + countOf(page, "https:"), 1U);
  EXPECT_THAT(page, HasSubstr("/*! @license https:"));
}

TEST(Report, SaysWhatTheEditsDid) {
  TouchRun run = sampleRun();
  run.scene.edit = "remove:radius=2mm";
  run.scene.journal = "kept<here";
  run.scene.save = "sculpted.vdb";
  run.edits->refused = 4;
  std::string page = makeReport(run, "PNG");
  for (const char* words :
       {"<b>3<small> edits</small></b><span>of which 2 reached the window",
        "<b>1.5<small> ms</small></b><span>from an edit to its window, median; 99 % within 2.5 ms",
        "<b>4<small> refused</small></b>", "remove:radius=2mm", "kept&lt;here", "3 of 3, 500 B",
        "saved 2 times in sculpted.vdb up to edit 3, 2 KiB, at most 0.5 s", "edits by time from edit to window [ms]"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
  EXPECT_THAT(page, Not(HasSubstr("why the last save failed")));
  run.edits->save_failures = 1;
  run.edits->save_failure = "the disk is full";
  run.edits->journal_failure = "it is full too";
  page = makeReport(run, "PNG");
  for (const char* words : {", 1 failed", "the disk is full", "it is full too"}) EXPECT_THAT(page, HasSubstr(words));
  run.scene.journal = run.scene.save = "";
  page = makeReport(run, "PNG");
  for (const char* words : {"none (--journal", "not saved (--save"}) EXPECT_THAT(page, HasSubstr(words));
  run.edits.reset();
  EXPECT_THAT(makeReport(run, "PNG"), Not(HasSubstr("<section id=\"edits\">")));
}

TEST(Report, AJournalThatIsNotThereHasNoRow) {
  TouchRun run = sampleRun();
  run.scene.journal = "kept";
  const std::string row = "<th scope=\"row\">journal</th>";
  ASSERT_THAT(makeReport(run, "PNG"), HasSubstr(row));
  run.edits->journal_records = run.edits->journal_saved = run.edits->journal_bytes = 0;
  const std::string page = makeReport(run, "PNG");
  EXPECT_THAT(page, Not(HasSubstr(row)));
  EXPECT_THAT(page, Not(HasSubstr("records acknowledged")));
}

TEST(Report, TheHeadingAndTheKeyFiguresNameTheEdits) {
  TouchRun run = sampleRun();
  run.edits->added_m3 = -12.3e-9;
  run.edits->content = 0xabc;
  const std::string page = makeReport(run, "PNG");
  const std::size_t figures = page.find("<section id=\"figures\">");
  const std::string heading = page.substr(0, figures);
  const std::string key_figures = page.substr(figures, page.find("</section>", figures) - figures);
  EXPECT_THAT(heading, HasSubstr("3 edits removed about 12.3 mm3"));
  EXPECT_THAT(key_figures,
              HasSubstr("<b>3<small> edits</small></b><span>of which 2 reached the window; removed about 12.3 mm3<"));
  EXPECT_THAT(key_figures, HasSubstr("from an edit to its window, median"));
  EXPECT_THAT(page, HasSubstr("0000000000000abc"));
  run.edits.reset();
  EXPECT_THAT(makeReport(run, "PNG"), Not(HasSubstr("reached the window")));
}

TEST(Report, ContainsEverySection) {
  const std::string page = makeReport(sampleRun(), "PNG");
  for (const char* id : {"picture", "figures", "faults", "plots", "histograms", "edits", "work", "plan", "parameters",
                         "machine", "repeat"}) {
    EXPECT_EQ(countOf(page, std::string("<section id=\"") + id + "\">"), 1U) << id;
  }
  for (const char* words : {"The tool touched the surface for 3 s of 5 s",
                            "stale_window",
                            "make the window larger",
                            "Example CPU",
                            "data:image/png;base64,UE5H",
                            "bricks on the GPU",
                            "saves 3.1 MiB",
                            "SCHED_FIFO",
                            "the slide is 12 mm",
                            "plot-force",
                            "plot-depth",
                            "plot-energy",
                            "plot-cost",
                            "quiet: the surface took",
                            "the force falls to zero.",
                            "plot-lateness",
                            "approach",
                            "retreat",
                            "0123abc",
                            ">--stiffness</th><td>500 N/m</td>",
                            "<noscript>"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
}

TEST(Report, SaysThatTheClockWasSimulatedInsteadOfEmptyPlots) {
  TouchRun run = sampleRun();
  run.scene.simulated_clock = true;
  const std::string page = makeReport(run, "");
  EXPECT_THAT(page, HasSubstr("were not measured"));
  EXPECT_THAT(page, Not(HasSubstr("plot-cost")));
  EXPECT_THAT(page, Not(HasSubstr("section id=\"histograms\"")));
  EXPECT_THAT(page, Not(HasSubstr("section id=\"picture\"")));
}

TEST(Report, NamesCannotBreakOutOfThePage) {
  TouchRun run = sampleRun();
  run.volume.name = "<img src=x onerror=alert(1)>\"'&";
  run.phases[0].name = "</script><script>alert(1)</script>";
  const std::string page = makeReport(run, "");
  EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
  EXPECT_THAT(page, Not(HasSubstr("</script><script>alert")));
  EXPECT_EQ(countOf(page, "</script>"), 3U);
}

TEST(Report, StaysSmallHoweverLongTheRun) {
  TouchRun run = sampleRun();
  run.records = sampleRecords(300'000, 1000);
  run.records[123'457].tick_cost_ns = 777'777;  // one peak among many ticks
  const std::string page = makeReport(run, "");
  EXPECT_LT(page.size(), 3U << 20);
  EXPECT_THAT(page, HasSubstr("777.78"));
}

TEST(Report, OfARunWithoutTicksIsStillAPage) {
  TouchRun run = sampleRun();
  run.records.clear();
  EXPECT_THAT(makeReport(run, ""), HasSubstr("never touched"));
}

TEST(Report, SaysWhatTookNoTimeAtAll) {
  TouchRun run = sampleRun();
  for (TickRecord& r : run.records) r.lateness_ns = 0;
  const std::string page = makeReport(run, "");
  EXPECT_THAT(page, HasSubstr("<p>Every wake-up lateness [us] is zero.</p>"));
  EXPECT_THAT(page, HasSubstr("ticks by tick cost [us]</text>"));
  // 2 to 2.899 us, all in the classes from 2 to 3.16 us.
  EXPECT_THAT(page, HasSubstr("<title>2 to 2.51 us: "));
  EXPECT_THAT(page, Not(HasSubstr("were not measured")));
}

TEST(Report, IsNotWrittenWhereItCannotBe) {
  TemporaryFolder folder;
  EXPECT_THROW(writeReport(folder.path() / "no" / "report.html", sampleRun(), ""), Error);
  EXPECT_EQ(folder.files(), 0);
}

TEST(HtmlText, EscapesAndEncodes) {
  EXPECT_EQ(escapeHtml("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_EQ(escapeHtml("a\tb\x1f c\nd"), "a b  c\nd");
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");  // RFC 4648, section 10
  EXPECT_EQ(base64("\xfb\xff\xbf"), "+/+/");
  EXPECT_EQ(escapeScriptJson("\"</script>\""), "\"\\u003c/script>\"");
  EXPECT_EQ(keyInWords("press_depth_m"), "press depth [m]");
  EXPECT_EQ(keyInWords("damping_Ns_per_m"), "damping [N s/m]");
  EXPECT_EQ(keyInWords("algorithm"), "algorithm");
  EXPECT_EQ(keyInWords("_m"), " m");  // a unit alone is a name
}

}  // namespace html_report_test
}  // namespace palpate
