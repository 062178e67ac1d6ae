// SPDX-License-Identifier: Apache-2.0
// Files that `palpate filter` writes against SciPy's ndimage, where /usr/bin/python3 has it (python3-scipy); skipped
// with a word elsewhere.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "engine/files/volume_file.hpp"
#include "engine/reference/gradient.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace scipy_test {

constexpr const char* kPython = "/usr/bin/python3";
constexpr std::string_view kGradient = "gradient/";

struct Compared {
  double difference = 0;
  double change = 0;
  double largest = 0;  // density before the filter
};

class SciPy : public ProgramTest {
 protected:
  void SetUp() override {
    const std::string ask = fmt::format("{} -c 'import numpy, scipy.ndimage' > /dev/null 2>&1", kPython);
    if (std::system(ask.c_str()) != 0) GTEST_SKIP() << kPython << " has no SciPy (package python3-scipy)";
    // Noise, voxels that are no cubes, sides that are no multiple of a brick.
    expectSuccess(run({"convert", "phantom:knot?size=30x27x25&spacing=0.7x0.9x1.3mm&noise=0.1", "in.nrrd"}));
  }
  // The twin's, with which the kernels agree bit for bit (tests/engine/passes/gradient_test.cpp).
  void writeGradients(const std::string& name, const std::string& way) const {
    const GradientOperator by = gradientOperator(way);
    const reference::DenseField field =
        reference::smoothedFor(by, reference::denseField(loadVolume(file("in.nrrd").string())));
    std::ofstream out(file(name), std::ios::binary);
    for (int n = 0; n < field.size.prod(); ++n) {
      const auto gradient = reference::gradientAt(field, by, n % field.size.x(), n / field.size.x() % field.size.y(),
                                                  n / field.size.x() / field.size.y());
      for (const double component : gradient) out.write(reinterpret_cast<const char*>(&component), sizeof component);
    }
  }
  // By chain, or by "gradient/" and an operator. Distances are from isovalue 0, the phantom's.
  [[nodiscard]] std::map<std::string, Compared> compare(const Words& chains) const {
    std::string cases;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      if (chains[i].starts_with(kGradient)) {
        writeGradients(fmt::format("f{}.raw", i), chains[i].substr(kGradient.size()));
      } else {
        Words filter = {"filter", "in.nrrd", "-o", fmt::format("f{}.nrrd", i), "--filter", chains[i]};
        if (chains[i].starts_with("distance")) filter = filter + Words{"--iso", "0"};
        expectSuccess(run(filter));
      }
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
      Compared& read = compared[chain];
      said >> name >> read.difference >> read.change >> read.largest;
    }
    EXPECT_TRUE(said) << contentsOf(file("said.txt"));
    return compared;
  }
};

// Both pick one of the values that are there, so they are equal.
TEST_F(SciPy, MediansAndMorphologyAreEqual) {
  const Words chains = {
      "median:2:border=mirror",           "median:1.5mm",        "dilate:2", "erode:1.9mm", "open:2:border=mirror",
      "erode:3:shape=ball:border=mirror", "close:2.5:shape=ball"};
  const Words like_those = {"median:1", "close:2", "dilate:2:shape=ball", "open:2.1mm:shape=ball"};
  for (const auto& [chain, compared] : compare(isLongRun() ? chains + like_those : chains)) {
    EXPECT_EQ(compared.difference, 0) << chain;
    EXPECT_GT(compared.change, 1) << chain;
  }
}

// SciPy adds in double with taps in double. Ours: 2 r + 1 taps, each rounded, multiplied and added, (2 r + 1) + 2
// roundings of 2^-24 of the largest density at most for each axis; r is up to 12 here (sigma 3 voxels, truncate 4).
TEST_F(SciPy, GaussiansAreEqualButForRounding) {
  const Words chains = {"gaussian:1.5", "gaussian:3:truncate=4", "gaussian:1mm:truncate=2:border=mirror"};
  const Words like_those = {"gaussian:1.5:border=mirror", "gaussian:0.8mm"};
  for (const auto& [chain, compared] : compare(isLongRun() ? chains + like_those : chains)) {
    EXPECT_LE(compared.difference, 3 * (2 * 12 + 3) * std::ldexp(1, -24) * compared.largest) << chain;
    EXPECT_GT(compared.change, 10) << chain;
    RecordProperty(chain, std::to_string(compared.difference));
  }
}

// A gradient is 16 weighted densities at most and a scale, five roundings each of sums up to 18/12 of the largest
// density; over the smallest spacing, 0.7 mm.
TEST_F(SciPy, GradientsInsideAreEqualButForRounding) {
  for (const auto& [way, compared] : compare({"gradient/central", "gradient/sobel", "gradient/central4"})) {
    EXPECT_LE(compared.difference, 8 * std::ldexp(1, -24) * 1.5 * compared.largest / 0.7e-3) << way;
    EXPECT_GT(compared.change, 1e5) << way;  // the steepest
    RecordProperty(way, std::to_string(compared.difference / compared.change * 1e6) + "e-6");
  }
}

// SciPy's gaussian_filter with order=1 is another operator, the derivative of a sampled Gaussian; ours is the central
// difference of the smoothed field. Each smoothed density is off by 3 (2 r + 3) roundings of the largest density, r up
// to 5 here; two of them over twice the smallest spacing, and three roundings of the gradient.
TEST_F(SciPy, GaussianGradientsInsideAreEqualButForRounding) {
  for (const auto& [way, compared] : compare({"gradient/gaussian:1.5", "gradient/gaussian:1mm:border=mirror"})) {
    EXPECT_LE(compared.difference, (3 * (2 * 5 + 3) + 3) * std::ldexp(1, -24) * compared.largest / 0.7e-3) << way;
    EXPECT_GT(compared.change, 1e4) << way;
    RecordProperty(way, std::to_string(compared.difference / compared.change * 1e6) + "e-6");
  }
}

// Against ten lines of NumPy in double. With u = 2^-24 and L the largest density, a step's six flows, of weights whose
// sum is a half (dt is half of what is stable) and of at most 2 L each, are off by some 13 u of themselves: conductance
// 7, its product, two of the taps, three of the sums; differences by u 2 L, and the density at the end by u L: 15 u L
// in all. What is off goes into the next step: the flow d / (1 + (d / k)^2) has a slope between -1/8 and 1, so a step
// makes it 1 + 2 (1/8) (1/2) times as large at most.
TEST_F(SciPy, DiffusionsAreEqualButForRounding) {
  for (const auto& [chain, steps] : {std::pair("diffuse:1:kappa=300", 1), std::pair("diffuse:5:kappa=200", 5),
                                     std::pair("diffuse:12:kappa=1500", 12)}) {
    if (steps == 5 && !isLongRun()) continue;
    const Compared compared = compare({chain}).at(chain);
    const double grown = (std::pow(1.125, steps) - 1) / 0.125;
    EXPECT_LE(compared.difference, 15 * grown * std::ldexp(1, -24) * compared.largest) << chain;
    EXPECT_GT(compared.change, 10) << chain;
    RecordProperty(chain, std::to_string(compared.difference));
  }
}

// Ours goes to the surface, SciPy's to the centre of the nearest voxel beyond it. That is no nearer than the surface,
// and the surface's nearest point lies in a cell of which a corner is beyond: they are at most a voxel's diagonal
// apart. Of a smooth surface: beside single voxels of noise ours takes the tangent plane for the surface.
TEST_F(SciPy, DistancesAreAsFarApartAsAVoxelIsLong) {
  expectSuccess(run({"convert", "phantom:knot?size=30x27x25&spacing=0.7x0.9x1.3mm", "in.nrrd"}));
  const double diagonal_m = 1e-3 * std::sqrt(0.7 * 0.7 + 0.9 * 0.9 + 1.3 * 1.3);
  for (const auto& [chain, compared] : compare({"distance:2", "distance:6"})) {
    EXPECT_LE(compared.difference, diagonal_m) << chain;
    EXPECT_GT(compared.difference, 0) << chain;
    RecordProperty(chain, std::to_string(compared.difference / diagonal_m));
  }
}

}  // namespace scipy_test
}  // namespace palpate
