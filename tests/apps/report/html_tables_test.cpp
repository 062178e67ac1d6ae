// SPDX-License-Identifier: Apache-2.0
// Sections to the letter, of a run in which no two figures are equal.
#include "apps/report/html_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/report/plot_data.hpp"
#include "apps/report/svg_plot.hpp"
#include "sample_run.hpp"

namespace palpate {
namespace html_tables_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string figure(const std::string& value, const std::string& unit, const std::string& meaning) {
  return "<div class=\"figure\"><b>" + value + "<small> " + unit + "</small></b><span>" + meaning + "</span></div>\n";
}
std::string row(const std::string& name, const std::string& value) {
  return "<tr><th scope=\"row\">" + name + "</th><td>" + value + "</td></tr>\n";
}

const char* const kFiguresBegin = "<section id=\"figures\">\n<h2>Key figures</h2>\n<div class=\"figures\">\n";

TEST(HtmlTables, KeyFiguresToTheLetter) {
  EXPECT_EQ(keyFigures(sampleEditedRun(), sampleFigures()),
            kFiguresBegin + figure("3", "s", "in contact, of 5 s") +
                figure("0.5", "N", "largest force; median 0.25 N") + figure("1", "mm", "deepest press; median 0.5 mm") +
                figure("20", "mm", "of surface followed") +
                figure("1.5", "mJ",
                       "quiet: the surface took 1.5 mJ from the hand, and no contact gave more than it had taken") +
                figure("3", "edits", "of which 2 reached the window; added about 2 mm3") +
                figure("1.5", "ms", "from an edit to its window, median; 99 % within 2.5 ms") +
                figure("1", "refused", "edits that were not applied; the notes tell why") +
                figure("0.01", "voxel", "tool point off the exact surface, median; 99 % within 0.05 voxel") +
                figure("0.02", "N", "force off the exact one, median; 99 % within 0.04 N") +
                figure("0.3", "degrees", "force off the exact normal, median; 99 % within 1.2 degrees") +
                figure("2", "us", "tick cost, median; 99 % within 3.25 us") +
                figure("60", "us", "wake-up after the due time, 99 %; worst 70 us") +
                figure("4", "late", "of 4993 ticks, 7 left out") + "</div>\n</section>\n");
}

TEST(HtmlTables, KeyFiguresLeaveOutWhatIsNotKnown) {
  TouchRun run = sampleEditedRun();
  run.scene.simulated_clock = true;
  run.exact->vhip_median_voxel.reset();
  run.edits = RunEdits{};
  RunFigures none;
  none.time_s = 5;
  const std::string before = kFiguresBegin + figure("0", "s", "in contact, of 5 s") +
                             figure("0", "N", "largest force; median 0 N") +
                             figure("0", "mm", "deepest press; median 0 mm") + figure("0", "mm", "of surface followed");
  const std::string angle = figure("0.02", "N", "force off the exact one, median; 99 % within 0.04 N") +
                            figure("0.3", "degrees", "force off the exact normal, median; 99 % within 1.2 degrees");
  const std::string after = figure("simulated", "clock", "no times were measured") + "</div>\n</section>\n";
  EXPECT_EQ(keyFigures(run, none), before + figure("0", "edits", "of which 0 reached the window") + angle + after);
  run.edits->count = 1;
  EXPECT_EQ(keyFigures(run, none), before + figure("1", "edit", "of which 0 reached the window") + angle + after);
  run.edits.reset();
  run.exact.reset();
  EXPECT_EQ(keyFigures(run, none), before + after);
}

TEST(HtmlTables, FaultsAndNotesToTheLetter) {
  TouchRun run = sampleRun();
  const std::string begin = "<section id=\"faults\">\n<h2>Faults and notes</h2>\n";
  EXPECT_EQ(faultSection(run),
            begin +
                "<div class=\"fault\"><b>stale_window</b> in 12 of 5000 ticks, "
                "first at tick 300.<br>the engine published too rarely; the force falls to zero."
                "<br><i>What to do:</i> make the window larger</div>\n<p>Worth knowing of this run:</p>\n"
                "<ul>\n<li>the slide is 12 mm instead of 20 mm</li>\n</ul>\n</section>\n");
  run.faults.clear();
  run.notes.clear();
  EXPECT_EQ(faultSection(run), begin + "<p>No fault was raised.</p>\n</section>\n");
}

TEST(HtmlTables, EditsToTheLetter) {
  TouchRun run = sampleEditedRun();
  const std::string begin = "<section id=\"edits\">\n<h2>Edits</h2>\n<div class=\"figures\">\n" +
                            figure("3", "edits", "of which 2 reached the window; added about 2 mm3") +
                            figure("1.5", "ms", "from an edit to its window, median; 99 % within 2.5 ms") +
                            figure("1", "refused", "edits that were not applied; the notes tell why") +
                            "</div>\n<div class=\"columns\"><table>\n" + row("brush", "remove:radius=2mm");
  EXPECT_EQ(editSection(run),
            begin + row("journal", "kept") + row("records acknowledged", "2 of 3, 500 B") +
                row("why not all are", "the disk is full") +
                row("volume", "saved 2 times in a.vdb up to edit 3, 2 KiB, at most 0.5 s, 4 failed") +
                row("content", "0000000000000abc") + row("why the last save failed", "it is full too") +
                "</table>\n<div>" +
                histogramSvg(logHistogram({1.5, 2.5}, 10), "edits by time from edit to window [ms]", "ms", "edits") +
                "</div>\n</div>\n</section>\n");
  // A journal that was deleted has no row, but for what was lost with it.
  run.edits->journal_bytes = 0;
  EXPECT_THAT(editSection(run), StartsWith(begin + row("records acknowledged", "2 of 3, 0 B")));
  run.edits->journal_records = 0;
  EXPECT_THAT(editSection(run), StartsWith(begin + row("why not all are", "the disk is full")));
  run.edits->journal_bytes = 241;
  EXPECT_THAT(editSection(run),
              StartsWith(begin + row("journal", "kept") + row("records acknowledged", "2 of 0, 241 B")));
  run.scene.journal = run.scene.save = "";
  EXPECT_THAT(editSection(run), StartsWith(begin + row("journal", "none (--journal keeps every edit on disk)") +
                                           row("volume", "not saved (--save keeps it)")));
}

TEST(HtmlTables, WorkPlanMachineAndRepeatToTheLetter) {
  TouchRun run = sampleRun();
  EXPECT_EQ(workSection(run),
            "<section id=\"work\">\n"
            "<h2>Time and memory</h2>\n<div class=\"columns\"><table><caption>Stages</caption>\n" +
                row("load", "0.4 s") + row("gradient", "0.1 s") + row("all together", "0.5 s") +
                "</table>\n<table><caption>Memory</caption>\n" + row("bricks on the GPU", "3 MiB") +
                "</table></div>\n</section>\n");
  EXPECT_EQ(planSection(run),
            "<section id=\"plan\">\n<h2>What was computed and what was left out</h2>\n<ul>\n"
            "<li>gradient of 120 of 512 bricks: the others hold no surface; saves 3.1 MiB</li>\n</ul>\n</section>\n");
  const std::string machine = "<section id=\"machine\">\n<h2>Machine</h2>\n<table>\n" +
                              row("processor", "Example CPU") + row("cores allowed", "4") + row("memory", "8 GiB") +
                              row("system", "Debian GNU/Linux 12, Linux 6.1") + row("Vulkan device", "llvmpipe") +
                              row("Vulkan driver", "Mesa 22.3, Vulkan 1.3.230") + "</table>\n";
  EXPECT_EQ(machineSection(run), machine +
                                     "<p>Real time:</p>\n<ul>\n<li>SCHED_FIFO not allowed: "
                                     "raise rtprio in /etc/security/limits.conf</li>\n</ul>\n</section>\n");
  const std::string repeat =
      "<section id=\"repeat\">\n<h2>How to repeat it</h2>\n<pre><code>palpate touch &#39;phantom:sphere?size=64&#39; "
      "--out out</code></pre>\n<p>Program version 0123abc. With the ";
  EXPECT_EQ(repeatSection(run), repeat + "real clock times differ from run to run.</p>\n</section>\n");
  run.scene.simulated_clock = true;
  run.plan.clear();
  run.realtime.clear();
  EXPECT_EQ(repeatSection(run),
            repeat + "simulated clock the trace comes out the same, bit for bit.</p>\n</section>\n");
  EXPECT_EQ(machineSection(run), machine + "</section>\n");
  EXPECT_THAT(planSection(run), HasSubstr("<p>No plan was recorded.</p>"));
}

// Values of every kind, and options with a unit, without one, and without a value.
TEST(HtmlTables, ParametersAreAsTheCommandLineTakesThem) {
  TouchRun run = sampleRun();
  const auto summary = nlohmann::ordered_json::parse(
      R"({"volume": {"a_m": null, "b": true, "c": false, "d": "", "e": "x<y", "f": 3, "g_voxel": [1, 2.5]}})");
  const std::string page = parameterSection(run, summary);
  EXPECT_THAT(page, StartsWith("<section id=\"parameters\">\n<h2>Volume and parameters</h2>\n"
                               "<table><caption>Volume</caption>\n" +
                               row("a [m]", "chosen by the program") + row("b", "yes") + row("c", "no") +
                               row("d", "-") + row("e", "x&lt;y") + row("f", "3") + row("g [voxel]", "1, 2.5") +
                               "</table>\n<details><summary>All parameters of the run</summary>\n<table>\n"));
  EXPECT_THAT(page, HasSubstr(row("--stiffness", "500 N/m")));
  EXPECT_THAT(page, HasSubstr(row("--algorithm", "hri")));
  EXPECT_THAT(page, HasSubstr(row("--depth", "")));
  std::size_t objects = 0;
  for (auto at = page.find("--object<"); at != std::string::npos; at = page.find("--object<", at + 1)) ++objects;
  EXPECT_EQ(objects, 2U);
}

}  // namespace html_tables_test
}  // namespace palpate
