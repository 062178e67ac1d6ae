// SPDX-License-Identifier: Apache-2.0
// What is said where VTK and SciPy are not; what they compute is tested in rivals_test.cpp.
#include <cstdlib>

#include <gmock/gmock.h>

#include "apps/rivals/rivals.hpp"
#include "base/error.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace python_rivals_test {

using testing::HasSubstr;

TEST(PythonRivals, SayWhatToInstall) {
  PythonRivals rivals(2, {"/usr/bin/python3", "-I", "-S"});  // which does not see Debian's modules
  ASSERT_EQ(rivals.missing().size(), 2U);
  EXPECT_EQ(rivals.missing()[0].library, "SciPy");
  EXPECT_THAT(rivals.missing()[0].why, HasSubstr("apt-get install python3-scipy"));
  EXPECT_EQ(rivals.missing()[1].library, "VTK");
  EXPECT_THAT(rivals.missing()[1].why, HasSubstr("apt-get install python3-vtk9"));
  EXPECT_TRUE(rivals.rivalsOf("gaussian:1.5").empty());
  const std::vector<float> densities(8);
  EXPECT_EQ(rivals.load({Vec3i::Constant(2), Vec3::Constant(1e-3), densities}), std::nullopt);  // no use, and no harm
}

TEST(PythonRivals, SayWhenThereIsNoPython) {
  const PythonRivals rivals(2, {"/nowhere/python3"});
  ASSERT_EQ(rivals.missing().size(), 2U);
  EXPECT_THAT(rivals.missing()[0].why, HasSubstr("/nowhere/python3 did not start"));
}

TEST(PythonRivals, SayWhenPythonEndsAtOnce) {
  EXPECT_EQ(PythonRivals(2, {"/bin/true"}).missing().size(), 2U);
}

// A child that says what a line of shell says, in place of Python's program.
PythonRivals childThatSays(const std::string& shell) {
  return PythonRivals(2,
                      {"/bin/sh", "-c", "read threads; printf 'rival\\tSciPy\\tmedian:1\\tway\\nready\\n'; " + shell});
}

TEST(PythonRivals, AreGoneOnceAVolumeCouldNotBeLoaded) {
  const std::vector<float> densities(8);
  const RivalField field{Vec3i::Constant(2), Vec3::Constant(1e-3), densities};
  for (const auto& [shell, words] :
       {std::pair("read volume; exit 1", "it ended"),
        std::pair("read volume; printf 'error\\tMemoryError()\\n'; read more", "MemoryError()")}) {
    PythonRivals rivals = childThatSays(shell);
    EXPECT_TRUE(rivals.missing().empty());
    EXPECT_EQ(rivals.rivalsOf("median:1").size(), 1U);
    EXPECT_THAT(rivals.load(field).value_or("nothing"), HasSubstr(words));
    EXPECT_TRUE(rivals.rivalsOf("median:1").empty());
    EXPECT_EQ(rivals.load(field), std::nullopt);  // the next volume is not asked for again
  }
}

// The child tells in its answer what it was given: words and the size of the file. 2 x 3 x 4 floats are 96 bytes.
TEST(PythonRivals, GiveTheVolumeInAFileAndItsMeasuresInMillimetres) {
  const std::vector<float> densities(24, 1.5F);
  PythonRivals rivals = childThatSays(
      "tab=$(printf '\\t'); IFS=$tab read -r what file x y z h i j; "
      "printf 'error\\t%s: %d bytes, %s %s %s, %s %s %s\\n' \"$what\" $(wc -c < \"$file\") $x $y $z $h $i $j; read "
      "more");
  EXPECT_THAT(rivals.load({Vec3i(2, 3, 4), Vec3(1e-3, 2e-3, 0.5e-3), densities}).value_or("nothing"),
              HasSubstr("load: 96 bytes, 2 3 4, 1 2 0.5"));
}

// A run is asked for by library, job and way; with a file, if somebody wants the result: here the floats 1 and 2.
TEST(PythonRivals, TellWhatARunCostAndItsResult) {
  PythonRivals rivals = childThatSays(
      "tab=$(printf '\\t'); while IFS=$tab read -r what library job way file; do "
      "if [ -n \"$file\" ]; then printf '\\000\\000\\200\\077\\000\\000\\000\\100' > \"$file\"; fi; "
      "if [ \"$what $library $job $way\" = 'run SciPy median:1 way' ]; then printf 'cost\\t12.5\\t30\\n'; "
      "else printf 'error\\tnobody asked\\n'; fi; done");
  ASSERT_EQ(rivals.rivalsOf("median:1").size(), 1U);
  EXPECT_TRUE(rivals.rivalsOf("median:2").empty());
  const Rival rival = rivals.rivalsOf("median:1")[0];
  EXPECT_EQ(rival.library, "SciPy");
  EXPECT_EQ(rival.way, "way");
  const RunCost cost = rival.run(nullptr);
  EXPECT_EQ(cost.wall_ms, 12.5);
  EXPECT_EQ(cost.cpu_ms, 30);
  std::vector<float> result;
  EXPECT_EQ(rival.run(&result).wall_ms, 12.5);
  EXPECT_THAT(result, testing::ElementsAre(1, 2));
}

// Lines that are too short, or of another kind, are passed over.
TEST(PythonRivals, TakeWholeLinesOnly) {
  const PythonRivals rivals(2, {"/bin/sh", "-c",
                                "read threads; printf 'missing\\tVTK\\tno "
                                "module\\nmissing\\tSciPy\\nrival\\tSciPy\\tmedian:1\\nhello\\n\\nready\\n'"});
  ASSERT_EQ(rivals.missing().size(), 1U);
  EXPECT_EQ(rivals.missing()[0].library, "VTK");
  EXPECT_EQ(rivals.missing()[0].why, "no module");
}

// One that wants something for one job alone.
TEST(PythonRivals, MayMissOneJob) {
  const PythonRivals rivals(
      2, {"/bin/sh", "-c",
          "read threads; printf 'missing\\tVTK\\tno display\\tpicture\\nmissing\\tSciPy\\tgone\\nready\\n'"});
  ASSERT_EQ(rivals.missing().size(), 2U);
  EXPECT_EQ(rivals.missing()[0].why, "no display");
  EXPECT_EQ(rivals.missing()[0].job, "picture");
  EXPECT_EQ(rivals.missing()[1].job, "");
}

// Millimetres and degrees.
TEST(PythonRivals, AreToldWhereTheCameraIs) {
  PythonRivals rivals =
      childThatSays("read see; printf 'error\\t%s\\n' \"$(echo \"$see\" | tr '\\t' ' ')\"; read more");
  RivalView view;
  view.camera.position_W = {0.001, -0.002, 0.5};
  view.camera.forward_W = {0, 0, -1};
  view.camera.up_W = {0, 1, 0};
  view.camera.vertical_fov_rad = 1;
  view.camera.width = 64;
  view.camera.height = 48;
  view.isovalue = 12.5;
  EXPECT_THAT(refusalOf([&] { rivals.see(view); }, Error::Code::kDevice),
              HasSubstr("see 64 48 12.5 1 -2 500 0 0 -1 0 1 0 57.295779"));
}

// How many threads the child may use is the first thing that it is told.
TEST(PythonRivals, SayHowManyThreadsThereAre) {
  const PythonRivals rivals(
      3, {"/bin/sh", "-c", "read word number; printf 'missing\\tVTK\\t%s: %s\\nready\\n' $word $number"});
  ASSERT_EQ(rivals.missing().size(), 1U);
  EXPECT_EQ(rivals.missing()[0].why, "threads: 3");
}

TEST(PythonRivals, AreGoneWhereTheVolumeHasNoRoom) {
  const std::vector<float> densities(8);
  PythonRivals rivals = childThatSays("read volume; printf 'ok\\n'; read more");
  const char* before = std::getenv("TMPDIR");
  const std::string old = before != nullptr ? before : "/tmp";
  setenv("TMPDIR", "/proc", 1);  // a folder in which nobody can make a file
  const auto why = rivals.load({Vec3i::Constant(2), Vec3::Constant(1e-3), densities});
  setenv("TMPDIR", old.c_str(), 1);
  EXPECT_THAT(why.value_or("nothing"), HasSubstr("TMPDIR"));
  EXPECT_TRUE(rivals.rivalsOf("median:1").empty());
}

}  // namespace python_rivals_test
}  // namespace palpate
