// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/run_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace run_results_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class RunResults : public testing::Test {
 protected:
  void save(const char* name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }
  [[nodiscard]] std::vector<std::string> foreign() const { return foreignResults(folder_.path()); }
  TemporaryFolder folder_;
};

TEST_F(RunResults, OfAnEarlierRunMayBeReplaced) {
  save("summary.json",
       R"({"schema": "palpate.touch.summary/2", "files": ["x/report.html", "x/summary.json", "x/trace.csv"]})");
  save("trace.csv", "");
  save("report.html", "");
  save("notes.txt", "anything else in the folder is nobody's business");
  EXPECT_THAT(foreign(), IsEmpty());
  EXPECT_NO_THROW(refuseForeignResults(folder_.path()));
  save("view.png", "a picture that that run did not draw");
  EXPECT_THAT(foreign(), ElementsAre("view.png"));
}

TEST_F(RunResults, OfAnEarlierVersionMayBeReplaced) {
  save("summary.json", R"({"schema": "palpate.touch.summary/1", "files": ["trace.csv"]})");
  save("trace.csv", "");
  EXPECT_THAT(foreign(), IsEmpty());
}

TEST_F(RunResults, ThatNobodyListsAreForeign) {
  EXPECT_THAT(foreign(), IsEmpty());
  EXPECT_THAT(foreignResults(folder_.path() / "none"), IsEmpty());
  save("report.html", "a report of another program");
  EXPECT_THAT(foreign(), ElementsAre("report.html"));
  try {
    refuseForeignResults(folder_.path());
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_EQ(std::string(error.what()),
              (folder_.path() / "report.html").string() +
                  ": it is not a result of palpate and would be replaced by one; move it away or choose another folder "
                  "with --out");
  }
}

// Whatever it is, it says nothing of the others and is not replaced itself.
TEST_F(RunResults, ASummaryOfAnotherKindIsForeign) {
  save("trace.csv", "");
  for (const char* text : {"", "[]", "{", "7", R"({"schema": "another/1", "files": ["trace.csv"]})", R"({"schema": 7})",
                           R"({"files": ["trace.csv", "summary.json"]})"}) {
    save("summary.json", text);
    EXPECT_THAT(foreign(), ElementsAre("trace.csv", "summary.json")) << text;
  }
  for (const char* files : {"7", "[7]", "{}", "null"}) {
    save("summary.json", std::string(R"({"schema": "palpate.touch.summary/2", "files": )") + files + "}");
    EXPECT_THAT(foreign(), ElementsAre("trace.csv")) << files;
  }
}

}  // namespace run_results_test
}  // namespace palpate
