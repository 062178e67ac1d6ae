// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "engine/files/volume_file.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace nrrd_test {

class Nrrd : public OneFile {
 protected:
  Nrrd() : OneFile("a.nrrd") {}
};

TEST_F(Nrrd, ReadsEveryNumberType) {
  const std::vector<double> values = rampValues(20);
  const auto check = [&](const std::string& type, const std::string& bytes, const std::string& name) {
    const Volume volume = load(nrrdHeader(type, "raw") + "\n" + bytes);
    expectVolume(volume, plainLattice(), values);
    EXPECT_EQ(volume.facts().value_type, name);
    EXPECT_EQ(volume.facts().format, "NRRD");
  };
  check("uint8", bytesOf<std::uint8_t>(values), "uint8");
  check("signed char", bytesOf<std::int8_t>(values), "int8");
  check("ushort", bytesOf<std::uint16_t>(values), "uint16");
  check("short", bytesOf<std::int16_t>(values), "int16");
  check("uint32", bytesOf<std::uint32_t>(values), "uint32");
  check("int", bytesOf<std::int32_t>(values), "int32");
  check("int64", bytesOf<std::int64_t>(values), "int64");
  check("uint64", bytesOf<std::uint64_t>(values), "uint64");
  check("float", bytesOf<float>(values), "float32");
  check("double", bytesOf<double>(values), "float64");
}

TEST_F(Nrrd, ReadsBigEndianGzipAndText) {
  const std::vector<double> values = rampValues(-30);
  std::string big = nrrdHeader("int16", "raw");
  big.replace(big.find("little"), 6, "big");
  expectVolume(load(big + "\n" + bytesOf<std::int16_t>(values, true)), plainLattice(), values);
  writeGzip(folder_.file("data.gz"), data_);
  expectVolume(load(nrrdHeader("int16", "gzip") + "\n" + readFile(folder_.file("data.gz"))), plainLattice(), values);
  std::string text;
  for (const double value : values) text += std::to_string(static_cast<int>(value)) + " ";
  expectVolume(load(nrrdHeader("int16", "ascii") + "\n" + text + "\n"), plainLattice(), values);
}

// 2^24 + n has a float for even n. For odd n the two nearest floats are 1 away. Of a double that is n + 1/3, a float
// has 24 bits: with n from 2^20 on, its step is 1/8, so 1/3 becomes 3/8, by 1/24. Whether the numbers lie bare in the
// file or are packed, they are counted once each, also in bricks that are not whole.
TEST_F(Nrrd, TellsOfNumbersThatAFloatCannotHold) {
  std::vector<double> integers, thirds;
  for (std::size_t n = 0; n < rampValues(0).size(); ++n) {
    integers.push_back(16777216.0 + static_cast<double>(n));
    thirds.push_back(1048576.0 + static_cast<double>(n) + 1.0 / 3);
  }
  const std::string odd = std::to_string(integers.size() / 2), all = std::to_string(thirds.size());
  const std::string words = odd + " of its int32 values are no 32-bit floats and were rounded, by 1 at most";
  EXPECT_EQ(load(nrrdHeader("int", "raw") + "\n" + bytesOf<std::int32_t>(integers)).facts().rounded.words(), words);
  writeGzip(folder_.file("data.gz"), bytesOf<std::int32_t>(integers));
  EXPECT_EQ(load(nrrdHeader("int", "gzip") + "\n" + readFile(folder_.file("data.gz"))).facts().rounded.words(), words);
  EXPECT_EQ(load(nrrdHeader("double", "raw") + "\n" + bytesOf<double>(thirds)).facts().rounded.words(),
            all + " of its float64 values are no 32-bit floats and were rounded, by 0.0417 at most");
  // 2^63 - 1 is one less than its float; a double could not tell.
  std::vector<double> largest(integers.size(), 0);
  std::string bytes = bytesOf<std::int64_t>(largest);
  bytes.replace(0, 8, "\xff\xff\xff\xff\xff\xff\xff\x7f", 8);
  EXPECT_EQ(load(nrrdHeader("int64", "raw") + "\n" + bytes).facts().rounded.words(),
            "1 of its int64 values are no 32-bit floats and were rounded, by 1 at most");
}

TEST_F(Nrrd, ReadsDetachedData) {
  const std::vector<double> values = rampValues(-30);
  path_ = folder_.file("a.nhdr");
  writeFile(folder_.file("a.raw"), data_);
  expectVolume(load(nrrdHeader("int16", "raw", "data file: a.raw\n")), plainLattice(), values);
  writeGzip(folder_.file("a.raw.gz"), data_);
  expectVolume(load(nrrdHeader("int16", "gzip", "data file: a.raw.gz\n")), plainLattice(), values);
  refuses(nrrdHeader("int16", "raw", "data file: missing.raw\n"), "not there", Error::Code::kNotFound);
  writeFile(folder_.file("a.raw"), data_.substr(1));
  refuses(nrrdHeader("int16", "raw", "data file: a.raw\n"), "cannot hold");
}

TEST_F(Nrrd, KeepsAnObliqueLattice) {
  writeWithItk(ItkWriter::kNrrd, path_, itkImageOf(obliqueLattice(), rampValues()), true);
  expectVolume(loadVolume(path_), obliqueLattice(), rampValues(), 1e-9);
}

// i runs right, j anterior, k superior in both; only the frame in which the file says so differs.
TEST_F(Nrrd, TurnsRasAndLasToLps) {
  const auto geometry = [](const std::string& space, const std::string& i, const std::string& j,
                           const std::string& origin) {
    return "space: " + space + "\nspace directions: " + i + " " + j + " (0,0,2)\nspace origin: " + origin + "\n";
  };
  const Lattice lattice = {Vec3(-0.010, 0.020, 0.030), Vec3(-1, -1, 1).asDiagonal(), kSpacing_mm * 1e-3};
  const auto check = [&](const std::string& text, const std::string& words) {
    const Volume volume = load(nrrdHeader("int16", "raw", "", text) + "\n" + data_);
    expectVolume(volume, lattice, rampValues(-30));
    EXPECT_EQ(volume.facts().orientation, words);
  };
  const std::string ras = "RAS file turned to LPS", las = "LAS file turned to LPS", lps = "LPS file";
  check(geometry("right-anterior-superior", "(0.5,0,0)", "(0,0.75,0)", "(10,-20,30)"), ras);
  check(geometry("RAS", "(0.5,0,0)", "(0,0.75,0)", "(10,-20,30)"), ras);
  check(geometry("left-anterior-superior", "(-0.5,0,0)", "(0,0.75,0)", "(-10,-20,30)"), las);
  check(geometry("LAS", "(-0.5,0,0)", "(0,0.75,0)", "(-10,-20,30)"), las);
  check(geometry("left-posterior-superior", "(-0.5,0,0)", "(0,-0.75,0)", "(-10,20,30)"), lps);
  check(geometry("LPS", "(-0.5,0,0)", "(0,-0.75,0)", "(-10,20,30)"), lps);
  check(geometry("scanner-xyz", "(-0.5,0,0)", "(0,-0.75,0)", "(-10,20,30)"), "space \"scanner-xyz\" taken as LPS");
  EXPECT_EQ(load(nrrdHeader("int16", "raw") + "\n" + data_).facts().orientation,
            "no space in the file: axes taken as LPS");
}

TEST_F(Nrrd, HonoursUnitsOfLength) {
  Lattice lattice = plainLattice();
  lattice.spacing_m *= 1e-3;
  const std::string geometry = "spacings: 0.5 0.75 2\nunits: \"um\" \"um\" \"um\"\n";
  expectVolume(load(nrrdHeader("int16", "raw", "", geometry) + "\n" + data_), lattice, rampValues(-30));
  refuses(nrrdHeader("int16", "raw", "", "spacings: 1 1 1\nunits: \"ell\" \"ell\" \"ell\"\n") + "\n" + data_,
          "its unit of length \"ell\" is not known; use mm, um, cm or m");
  // Each by every name; "???" says nothing.
  const std::string vectors = "space: LPS\nspace directions: (0.5,0,0) (0,0.75,0) (0,0,2)\nspace origin: (3,4,5)\n";
  for (const auto& [unit, metres] :
       {std::pair("mm", 1e-3), std::pair("millimeter", 1e-3), std::pair("millimeters", 1e-3), std::pair("???", 1e-3),
        std::pair("um", 1e-6), std::pair("micrometer", 1e-6), std::pair("microns", 1e-6), std::pair("micron", 1e-6),
        std::pair("cm", 1e-2), std::pair("centimeter", 1e-2), std::pair("m", 1.0), std::pair("meter", 1.0)}) {
    SCOPED_TRACE(unit);
    const std::string units = fmt::format("space units: \"{0}\" \"{0}\" \"{0}\"\n", unit);
    const Volume volume = load(nrrdHeader("int16", "raw", "", vectors + units) + "\n" + data_);
    expectLattice(volume.lattice(), {Vec3(3, 4, 5) * metres, Mat3::Identity(), kSpacing_mm * metres}, 1e-12);
  }
}

TEST_F(Nrrd, SaysWhenTheVoxelSizeIsMissing) {
  EXPECT_THAT(load(nrrdHeader("int16", "raw", "", "") + "\n" + data_).facts().remark, testing::HasSubstr("1 mm"));
}

TEST_F(Nrrd, RefusesBadSpacing) {
  for (const std::string spacing : {"0 1 1", "1 -1 1", "1 1 inf"}) {
    refuses(nrrdHeader("int16", "raw", "", "spacings: " + spacing + "\n") + "\n" + data_, "not positive");
  }
  refuses(nrrdHeader("int16", "raw", "", "space: LPS\nspace directions: (1,0,0) (0,0,0) (0,0,1)\n") + "\n" + data_,
          "zero vector");
}

// ITK puts 1 for what is no number.
TEST_F(Nrrd, RefusesAnAxisThatHasNoSpacing) {
  const auto header = [](const std::string& geometry) { return nrrdHeader("int16", "raw", "", geometry) + "\n"; };
  refuses(header("spacings: 0.5 0.75 nan\n") + data_, "not positive");
  refuses(header("spacings: 0.5 0.75 x\n") + data_, "not positive");
  for (const std::string last : {"none", "(0,0)", "(0,0,1,0)"}) {
    refuses(header("space: LPS\nspace directions: (1,0,0) (0,1,0) " + last + "\n") + data_, "not three vectors");
  }
  EXPECT_THAT(load(header("spacings: nan nan NaN\n") + data_).facts().remark, testing::HasSubstr("1 mm is assumed"));
}

TEST_F(Nrrd, ReadsHex) {
  std::string digits;
  for (const char c : data_) digits += fmt::format("{:02x}", static_cast<unsigned char>(c));
  expectVolume(load(nrrdHeader("int16", "hex") + "\n" + digits + "\n"), plainLattice(), rampValues(-30));
  refuses(nrrdHeader("int16", "hex") + "\n" + digits + "00", "more voxels than its header asks for");
  refuses(nrrdHeader("int16", "hex") + "\n" + digits.substr(1) + " ", "fewer voxels than its header asks for");
}

TEST_F(Nrrd, RefusesShearedAxes) {
  refuses(nrrdHeader("int16", "raw", "", "space: LPS\nspace directions: (1,0,0) (0.5,1,0) (0,0,1)\n") + "\n" + data_,
          "sheared");
}

TEST_F(Nrrd, RefusesWhatIsNoVolume) {
  std::string flat = nrrdHeader("int16", "raw", "", "");
  flat.replace(flat.find("dimension: 3\nsizes: 5 4 3"), 25, "dimension: 2\nsizes: 5 12");
  refuses(flat + "\n" + data_, "2 dimensions");
  std::string vectors = nrrdHeader("int16", "raw", "", "kinds: vector domain domain domain\n");
  vectors.replace(vectors.find("dimension: 3\nsizes: 5 4 3"), 25, "dimension: 4\nsizes: 5 2 2 3");
  refuses(vectors + "\n" + data_, "5 components");
  std::string series = nrrdHeader("int16", "raw", "", "kinds: domain domain domain domain\n");
  series.replace(series.find("dimension: 3\nsizes: 5 4 3"), 25, "dimension: 4\nsizes: 5 2 2 3");
  refuses(series + "\n" + data_, "series of 3");
}

// Four axes; `header` says what they are, sizes included.
std::string fourAxes(const std::string& type, const std::string& header) {
  return "NRRD0004\ntype: " + type + "\ndimension: 4\nendian: little\nencoding: raw\n" + header + "\n";
}

// The format's page lists the kinds, and lets axes out of space have a spacing of NaN or a direction of none.
TEST_F(Nrrd, TellsWhatVoxelsOfSeveralNumbersAre) {
  const std::string none_first = "space: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n";
  for (const auto& [header, words] : {
           std::pair<std::string, std::string>("sizes: 3 5 4 3\nkinds: RGB-color domain domain domain\n"
                                               "spacings: nan 1 1 1\n",
                                               "colours of 3 components"),
           {"sizes: 5 4 3 3\nkinds: domain domain domain RGB-color\nspacings: 1 1 1 nan\n", "colours of 3 components"},
           {"sizes: 4 5 3 3\nkinds: 4-color space space space\n" + none_first, "colours of 4 components"},
           {"sizes: 3 5 4 3\nkinds: vector space space space\n" + none_first, "vectors of 3 components"},
           {"sizes: 2 5 4 3\nkinds: complex domain domain domain\n", "complex numbers of 2 components"},
           {"sizes: 9 5 2 2\nkinds: 3D-matrix space space space\n" + none_first, "matrices of 9 components"},
           {"sizes: 3 5 4 3\n" + none_first, "colours or vectors of 3 components"},
           {"sizes: 7 5 4 1\n" + none_first, "vectors of 7 components"},
           {"sizes: 3 5 4 3\nspacings: nan 1 1 1\n", "colours or vectors of 3 components"},
       }) {
    SCOPED_TRACE(header);
    refuses(fourAxes("int16", header) + data_, "its voxels are " + words + ", and a density is one number");
  }
  // Without a word on the axes it is the type that speaks for colours.
  refuses(fourAxes("uchar", "sizes: 3 5 4 3\nspacings: 1 1 1 1\n") + data_, "colours or vectors of 3 components");
  refuses(fourAxes("int16", "sizes: 3 5 4 2\nspacings: 1 1 1 1\n") + data_, "series of 2 volumes");
  refuses(fourAxes("int16", "sizes: 5 4 3 2\nspacings: 1 1 1 nan\n") + data_, "series of 2 volumes");
  refuses(fourAxes("int16", "sizes: 2 5 4 3\nkinds: time space space space\n" + none_first) + data_,
          "series of 2 volumes");
  refuses(fourAxes("int16", "sizes: 5 4 3 2\nspacings: nan nan nan nan\n") + data_, "series of 2 volumes");
}

TEST_F(Nrrd, RefusesMoreAxesThanTheFormatHas) {
  std::string sizes = "sizes: 5 4 3";
  for (int axis = 0; axis < 14; ++axis) sizes += " 1";
  refuses(fourAxes("int16", sizes + "\n") + data_, "17 dimensions");
}

TEST_F(Nrrd, ReadsOneTimePoint) {
  std::string series = nrrdHeader("int16", "raw", "", "spacings: 0.5 0.75 2 nan\nkinds: domain domain domain domain\n");
  series.replace(series.find("dimension: 3\nsizes: 5 4 3"), 25, "dimension: 4\nsizes: 5 4 3 1");
  expectVolume(load(series + "\n" + data_), plainLattice(), rampValues(-30));
}

TEST_F(Nrrd, RefusesMoreThanMemoryBeforeReadingIt) {
  std::string huge = nrrdHeader("int16", "raw");
  huge.replace(huge.find("5 4 3"), 5, "100000 100000 100000");
  // 10^15 voxels as floats, in leaves and on the GPU: 16.2 bytes each.
  refuses(huge + "\n", "it needs 1.51e+07 GiB with its copy for the GPU", Error::Code::kOutOfMemory);
}

// ITK's NRRD library writes such a value into a buffer of its own and aborts.
TEST_F(Nrrd, RefusesALongValueThatIsNoNumber) {
  for (const std::string key : {"sizes", "spacings", "space directions", "kinds", "type", "encoding"}) {
    std::string header = nrrdHeader("int16", "raw");
    const std::size_t at = header.find("\n" + key + ":");
    if (at != std::string::npos) header.erase(at + 1, header.find('\n', at + 1) - at);
    header += key + ": " + std::string(1000, 'x') + "\n\n";
    writeFile(path_, header + data_);
    EXPECT_THROW(static_cast<void>(loadVolume(path_)), Error) << key;
  }
}

TEST_F(Nrrd, RefusesGzipThatCannotHoldTheVoxels) {
  std::string lie = nrrdHeader("int16", "gzip");
  lie.replace(lie.find("5 4 3"), 5, "500 400 300");
  refuses(lie + "\n0123456789", "compressed");
}

}  // namespace nrrd_test
}  // namespace palpate
