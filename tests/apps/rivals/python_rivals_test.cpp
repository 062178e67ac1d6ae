// SPDX-License-Identifier: Apache-2.0
// What is said where VTK and SciPy are not; what they compute is tested in rivals_test.cpp.
#include "apps/rivals/python_rivals.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace {

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
  rivals.load({Vec3i::Constant(2), Vec3::Constant(1e-3), densities});  // of no use, and no harm
}

TEST(PythonRivals, SayWhenThereIsNoPython) {
  const PythonRivals rivals(2, {"/nowhere/python3"});
  ASSERT_EQ(rivals.missing().size(), 2U);
  EXPECT_THAT(rivals.missing()[0].why, HasSubstr("/nowhere/python3 did not start"));
}

TEST(PythonRivals, SayWhenPythonEndsAtOnce) {
  EXPECT_EQ(PythonRivals(2, {"/bin/true"}).missing().size(), 2U);
}

}  // namespace
}  // namespace palpate
