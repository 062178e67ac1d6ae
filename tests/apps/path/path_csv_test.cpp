// SPDX-License-Identifier: Apache-2.0
#include "apps/path/path_csv.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace path_csv_test {

using ::testing::HasSubstr;

constexpr const char* kHeader = "time_s,x_m,y_m,z_m\n";

class PathCsv : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::path(::testing::TempDir()) / (std::string("palpate_path_") + info->name() + ".csv");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::vector<TimedPoint> read(const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return readPathCsv(file_);
  }
  void expectRefusal(const std::string& text, const std::string& words) {
    try {
      (void)read(text);
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_THAT(error.what(), HasSubstr(words));
      EXPECT_THAT(error.what(), HasSubstr(file_.filename().string()));
      EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    }
  }
  std::filesystem::path file_;
};

TEST_F(PathCsv, ReadsRowsInOrder) {
  const auto points = read(std::string(kHeader) + "0,1,2,3\n0.5,-1e-3,0,4.25\n\n");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].time_s, 0.5);
  EXPECT_EQ(points[1].p_W, Vec3(-1e-3, 0, 4.25));
}

TEST_F(PathCsv, ToleratesCarriageReturnsAndAMissingLastNewline) {
  const auto points = read("time_s,x_m,y_m,z_m\r\n0,1,2,3\r\n1,1,2,3");
  EXPECT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].p_W, Vec3(1, 2, 3));
}

TEST_F(PathCsv, ToleratesSpacesEmptyLinesAndAByteOrderMark) {
  const auto points = read("\xEF\xBB\xBFtime_s,x_m,y_m,z_m\n 0 ,1, 2,3  \n\n\r\n1,4,5,6\n");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].time_s, 0);
  EXPECT_EQ(points[0].p_W, Vec3(1, 2, 3));
  EXPECT_EQ(points[1].p_W, Vec3(4, 5, 6));
}

TEST_F(PathCsv, CountsEmptyLines) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n\n\n1,0, ,0\n", "line 5: \"\" is not a number; write plain");
}

TEST_F(PathCsv, ShortensWhatItQuotes) {
  expectRefusal(std::string(81, 'h'),
                "line 1: the header is \"" + std::string(80, 'h') + "\"; make the first line time_s,x_m,y_m,z_m");
  expectRefusal(std::string(kHeader) + "0,0,0," + std::string(41, 'a') + "\n", '"' + std::string(40, 'a') + '"');
}

TEST_F(PathCsv, RefusesAMissingFile) {
  try {
    (void)readPathCsv(file_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kNotFound);
    EXPECT_EQ(error.what(), file_.string() + ": the path file does not exist; check the name");
  }
}

TEST_F(PathCsv, RefusesAFolder) {
  try {
    (void)readPathCsv(::testing::TempDir());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
    EXPECT_THAT(error.what(), HasSubstr("the path file cannot be read; check that it is a file"));
  }
}

TEST_F(PathCsv, RefusesAnotherHeader) {
  expectRefusal("t,x,y,z\n0,0,0,0\n1,0,0,0\n", "line 1: the header is \"t,x,y,z\"");
}
TEST_F(PathCsv, RefusesAnEmptyFile) {
  expectRefusal("", "the file is empty");
}
TEST_F(PathCsv, RefusesASingleRow) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n", "at least two rows, it has 1");
}
TEST_F(PathCsv, RefusesAWord) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,left,0\n", "line 3: \"left\" is not a number");
}
TEST_F(PathCsv, RefusesANumberWithATail) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,1mm,0\n", "\"1mm\"");
}
TEST_F(PathCsv, RefusesNan) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,nan,0,0\n", "line 3: nan is not a finite");
}
TEST_F(PathCsv, RefusesInfinity) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,0,-inf\n", "line 3: -inf");
}
TEST_F(PathCsv, RefusesTooFewColumns) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,0\n", "line 3: a row needs");
}
TEST_F(PathCsv, RefusesTooManyColumns) {
  expectRefusal(std::string(kHeader) + "0,0,0,0,0\n", "line 2: a row needs");
}
TEST_F(PathCsv, RefusesTimeGoingBack) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,0,0\n0.5,0,0,0\n", "line 4: time goes back from 1 s to 0.5 s");
}
TEST_F(PathCsv, RefusesRepeatedTime) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,0,0\n1,0,0,0\n", "line 4: time does not move on from 1 s to 1 s");
}
TEST_F(PathCsv, RefusesATimeWithoutEnd) {
  expectRefusal(std::string(kHeader) + "-1e308,0,0,0\n1e308,0,0,0\n",
                "line 3: the time from -1e+308 s to 1e+308 s is longer");
}
TEST_F(PathCsv, RefusesAHole) {
  expectRefusal(
      std::string(kHeader) + "0,0,0,0\n1,0,0,0\n2,0,0,0\n12.5,0,0,0\n13.5,0,0,0\n",
      "line 5: a hole in the path: nothing between 2 s and 12.5 s, where rows come every 1 s; record the path");
}
// Of two gaps the shorter one is usual.
TEST_F(PathCsv, RefusesAHoleBeforeTheOnlyOtherRow) {
  expectRefusal(std::string(kHeader) + "0,0,0,0\n10.5,0,0,0\n11.5,0,0,0\n",
                "line 3: a hole in the path: nothing between 0 s and 10.5 s, where rows come every 1 s");
}
TEST_F(PathCsv, AcceptsAGapOfTenIntervals) {
  EXPECT_EQ(read(std::string(kHeader) + "0,0,0,0\n1,0,0,0\n2,0,0,0\n12,0,0,0\n").size(), 4U);
}

// Times are since the first row; blanks around a brush are not its own; a brush may hold commas.
TEST_F(PathCsv, ReadsTheBrushes) {
  static_cast<void>(
      read("time_s,x_m,y_m,z_m,brush\n5,0,0,0,\n5.1,0,0,0, add:radius=1mm \n5.2,0,0,0,add:radius=1mm\n"
           "5.3,0,0,0,a,b\r\n5.4,0,0,0,\n"));
  const PathFile path = readPathFile(file_);
  EXPECT_EQ(path.points.size(), 5U);
  ASSERT_EQ(path.brushes.size(), 3U);
  EXPECT_NEAR(path.brushes[0].begin_s, 0.1, 1e-12);
  EXPECT_EQ(path.brushes[0].text, "add:radius=1mm");
  EXPECT_EQ(path.brushes[1].text, "a,b");
  EXPECT_NEAR(path.brushes[2].begin_s, 0.4, 1e-12);
  EXPECT_EQ(path.brushes[2].text, "");
}

TEST_F(PathCsv, HasNoBrushesWithoutTheirColumn) {
  static_cast<void>(read(std::string(kHeader) + "0,0,0,0\n1,0,0,0\n"));
  EXPECT_TRUE(readPathFile(file_).brushes.empty());
  expectRefusal("time_s,x_m,y_m,z_m,brush\n0,0,0,0,\n1,0,0,0\n", "four numbers and a brush");
  expectRefusal(std::string(kHeader) + "0,0,0,0\n1,0,0,0,add\n", "exactly four numbers");
}

}  // namespace path_csv_test
}  // namespace palpate
