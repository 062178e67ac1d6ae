// SPDX-License-Identifier: Apache-2.0
// Files that `palpate filter` writes against SciPy's ndimage, where /usr/bin/python3 has it (python3-scipy); skipped
// with a word elsewhere.
#include <cmath>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "program_test.hpp"

namespace palpate {
namespace {

constexpr const char* kPython = "/usr/bin/python3";

struct Compared {
  double difference = 0;
  double change = 0;
};

class SciPy : public ProgramTest {
 protected:
  void SetUp() override {
    const std::string ask = fmt::format("{} -c 'import numpy, scipy.ndimage' > /dev/null 2>&1", kPython);
    if (std::system(ask.c_str()) != 0) GTEST_SKIP() << kPython << " has no SciPy (package python3-scipy)";
    // Noise, voxels that are no cubes, sides that are no multiple of a brick.
    expectSuccess(run({"convert", "phantom:knot?size=30x27x25&spacing=0.7x0.9x1.3mm&noise=0.1", "in.nrrd"}));
  }
  // By chain.
  [[nodiscard]] std::map<std::string, Compared> compare(const Words& chains) const {
    std::string cases;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      expectSuccess(run({"filter", "in.nrrd", "-o", fmt::format("f{}.nrrd", i), "--filter", chains[i]}));
      cases += fmt::format("f{} {}\n", i, chains[i]);
    }
    write("cases.txt", cases);
    const std::string command =
        fmt::format("{} {} {} > {} 2>&1", kPython, PALPATE_COMPARE_SCIPY, folder().string(), file("said.txt").string());
    const int status = std::system(command.c_str());
    EXPECT_EQ(status, 0) << contentsOf(file("said.txt"));
    std::map<std::string, Compared> compared;
    std::istringstream said(contentsOf(file("said.txt")));
    for (const std::string& chain : chains) {
      std::string name;
      said >> name >> compared[chain].difference >> compared[chain].change;
    }
    EXPECT_TRUE(said) << contentsOf(file("said.txt"));
    return compared;
  }
};

// Both pick one of the values that are there, so they are equal.
TEST_F(SciPy, MediansAndMorphologyAreEqual) {
  const Words chains = {"median:1",
                        "median:2:border=mirror",
                        "median:1.5mm",
                        "dilate:2",
                        "erode:1.9mm",
                        "open:2:border=mirror",
                        "close:2",
                        "dilate:2:shape=ball",
                        "erode:3:shape=ball:border=mirror",
                        "open:2.1mm:shape=ball",
                        "close:2.5:shape=ball"};
  for (const auto& [chain, compared] : compare(chains)) {
    EXPECT_EQ(compared.difference, 0) << chain;
    EXPECT_GT(compared.change, 1) << chain;
  }
}

// SciPy adds in double with taps in double. Ours: 2 r + 1 taps, each rounded, multiplied and added, (2 r + 1) + 2
// roundings of 2^-24 of the largest density at most for each axis; r is up to 12 here (sigma 3 voxels, truncate 4).
TEST_F(SciPy, GaussiansAreEqualButForRounding) {
  const Words chains = {"gaussian:1.5", "gaussian:1.5:border=mirror", "gaussian:0.8mm", "gaussian:3:truncate=4",
                        "gaussian:1mm:truncate=2:border=mirror"};
  constexpr double kLargestDensity = 2000;  // of the phantom: -1000 to 1000 and noise of 0.1 of that range
  for (const auto& [chain, compared] : compare(chains)) {
    EXPECT_LE(compared.difference, 3 * (2 * 12 + 3) * std::ldexp(1, -24) * kLargestDensity) << chain;
    EXPECT_GT(compared.change, 10) << chain;
    RecordProperty(chain, std::to_string(compared.difference));
  }
}

}  // namespace
}  // namespace palpate
