// SPDX-License-Identifier: Apache-2.0
// Helpers of the volume tests: a temporary folder, files written byte by byte, and the small image that they hold.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/support/few_descriptors.hpp"

namespace palpate {

// A new empty folder, removed with what is in it.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "palpate_volume_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

inline void writeFile(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The bytes of values of type T.
template <class T>
std::string bytesOf(const std::vector<double>& values, bool big_endian = false) {
  std::string bytes;
  for (const double value : values) {
    const T typed = static_cast<T>(value);
    std::string one(sizeof(T), '\0');
    std::memcpy(one.data(), &typed, sizeof(T));
    if (big_endian) std::reverse(one.begin(), one.end());
    bytes += one;
  }
  return bytes;
}

// The image of the format tests: 5 x 4 x 3 voxels of 0.5 x 0.75 x 2 mm.
inline const Vec3i kSize = {5, 4, 3};
inline const Vec3 kSpacing_mm = {0.5, 0.75, 2.0};

// Distinct values that fit in every type, i fastest: 0 to 59, plus `offset`.
inline std::vector<double> rampValues(double offset = 0) {
  std::vector<double> values(60);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(n) + offset;
  return values;
}

inline std::vector<float> asFloats(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

inline Lattice plainLattice() {
  return {Vec3::Zero(), Mat3::Identity(), kSpacing_mm * 1e-3};
}

// Axes turned by 30 degrees about z and then by 20 about x, and an origin off zero.
inline Lattice obliqueLattice() {
  const Mat3 R_WL =
      (Eigen::AngleAxisd(0.349, Vec3::UnitX()) * Eigen::AngleAxisd(0.5236, Vec3::UnitZ())).toRotationMatrix();
  return {Vec3(0.010, -0.020, 0.030), R_WL, kSpacing_mm * 1e-3};
}

// `tolerance`: of directions [-], and of lengths in metres; headers hold single precision in the worst case.
inline void expectLattice(const Lattice& got, const Lattice& want, double tolerance = 1e-12) {
  EXPECT_LE((got.origin_W - want.origin_W).norm(), tolerance) << got.origin_W.transpose();
  EXPECT_LE((got.spacing_m - want.spacing_m).norm(), tolerance) << got.spacing_m.transpose();
  EXPECT_LE((got.R_WL - want.R_WL).norm(), tolerance) << got.R_WL;
}

inline void expectVolume(const Volume& volume, const Lattice& lattice, const std::vector<double>& values,
                         double tolerance = 1e-12) {
  EXPECT_EQ(volume.size(), kSize);
  expectLattice(volume.lattice(), lattice, tolerance);
  EXPECT_EQ(volume.toDense(), asFloats(values));
}

// Expects an Error whose message is one line that starts with the input and holds `reason`.
template <class Work>
void expectRefusal(const Work& work, const std::string& input, const std::string& reason,
                   Error::Code code = Error::Code::kBadInput) {
  try {
    work();
    ADD_FAILURE() << "no error; expected: " << reason;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.code(), code) << message;
    EXPECT_THAT(message, testing::StartsWith(input + ": "));
    EXPECT_THAT(message, testing::HasSubstr(reason));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
  }
}

inline void expectLoadRefusal(const std::string& name, const std::string& reason,
                              Error::Code code = Error::Code::kBadInput) {
  expectRefusal([&] { static_cast<void>(loadVolume(name)); }, name, reason, code);
}

// Too few descriptors, for the program or for the child in which a library reads, are no damage: at every limit up to
// the first at which the volume loads. Returns at how many it does not.
inline int refusalsForDescriptors(const std::string& name) {
  for (int refusals = 0; refusals < 100; ++refusals) {
    const int spare = 1 + refusals;  // none is what every reader's first look is refused for
    std::string words;
    Error::Code code = Error::Code::kIo;
    try {
      const FewDescriptors few(spare);
      (void)loadVolume(name);
      return refusals;
    } catch (const Error& error) {
      words = error.what();
      code = error.code();
    }
    EXPECT_THAT(words, testing::HasSubstr("Too many open files")) << spare << " descriptors";
    EXPECT_THAT(words, testing::HasSubstr("ulimit -n")) << spare << " descriptors";
    EXPECT_EQ(code, Error::Code::kIo) << spare << " descriptors";
  }
  ADD_FAILURE() << "it does not load with any number of descriptors";
  return 100;
}

}  // namespace palpate
