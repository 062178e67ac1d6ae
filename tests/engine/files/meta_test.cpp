// SPDX-License-Identifier: Apache-2.0
#include "engine/files/volume_file.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace meta_test {

class Meta : public OneFile {
 protected:
  Meta() : OneFile("a.mha") {}
};

TEST_F(Meta, ReadsEveryNumberType) {
  const std::vector<double> values = rampValues(20);
  const auto check = [&](const std::string& type, const std::string& bytes, const std::string& name) {
    const Volume volume = load(metaHeader(type) + bytes);
    expectVolume(volume, plainLattice(), values);
    EXPECT_EQ(volume.facts().value_type, name);
  };
  check("MET_UCHAR", bytesOf<std::uint8_t>(values), "uint8");
  check("MET_CHAR", bytesOf<std::int8_t>(values), "int8");
  check("MET_USHORT", bytesOf<std::uint16_t>(values), "uint16");
  check("MET_SHORT", bytesOf<std::int16_t>(values), "int16");
  check("MET_UINT", bytesOf<std::uint32_t>(values), "uint32");
  check("MET_INT", bytesOf<std::int32_t>(values), "int32");
  check("MET_FLOAT", bytesOf<float>(values), "float32");
  check("MET_DOUBLE", bytesOf<double>(values), "float64");
}

TEST_F(Meta, ReadsBigEndianAndDetachedData) {
  std::string big = metaHeader("MET_SHORT");
  big.replace(big.find("MSB = False"), 11, "MSB = True");
  expectVolume(load(big + bytesOf<std::int16_t>(rampValues(-30), true)), plainLattice(), rampValues(-30));
  path_ = folder_.file("a.mhd");
  writeFile(folder_.file("a.raw"), data_);
  expectVolume(load(metaHeader("MET_SHORT", "ElementSpacing = 0.5 0.75 2\n", "a.raw")), plainLattice(),
               rampValues(-30));
  refuses(metaHeader("MET_SHORT", "", "missing.raw"), "not there", Error::Code::kNotFound);
}

TEST_F(Meta, KeepsAnObliqueLatticeCompressedOrNot) {
  for (const bool compressed : {false, true}) {
    writeWithItk(ItkWriter::kMeta, path_, itkImageOf(obliqueLattice(), rampValues()), compressed);
    expectVolume(loadVolume(path_), obliqueLattice(), rampValues(), 1e-8);
  }
}

TEST_F(Meta, AppliesTheSlopeToIntensities) {
  const std::string slope = "ElementToIntensityFunctionSlope = 0.5\nElementToIntensityFunctionOffset = 100\n";
  const Volume volume = load(metaHeader("MET_SHORT", "ElementSpacing = 0.5 0.75 2\n" + slope) + data_);
  std::vector<double> values = rampValues(-30);
  for (double& value : values) value = 0.5 * value + 100;
  expectVolume(volume, plainLattice(), values);
  EXPECT_EQ(volume.facts().rescale_slope, 0.5);
  EXPECT_EQ(volume.facts().rescale_intercept, 100);
  EXPECT_EQ(volume.facts().format, "MetaImage");
  EXPECT_EQ(volume.facts().orientation, "LPS file");
  EXPECT_EQ(volume.facts().remark, "");
}

// Of "2 3" the first was taken, 0 made every voxel 0, and ITK has no words for the others.
TEST_F(Meta, RefusesASlopeOrOffsetThatIsNotOneNumber) {
  for (const std::string key : {"ElementToIntensityFunctionSlope", "ElementToIntensityFunctionOffset"}) {
    for (const std::string bad : {"2 3", "inf", "-inf", "nan", "x", "2x", "1e999", ""}) {
      refuses(metaHeader("MET_SHORT", key + " = " + bad + "\n") + data_,
              key + " \"" + bad + "\" is not a finite number");
    }
  }
  for (const std::string zero : {"0", "-0", "0.0"}) {
    refuses(metaHeader("MET_SHORT", "ElementToIntensityFunctionSlope = " + zero + "\n") + data_, "Slope is 0");
  }
}

// MetaIO takes as many as it needs, and of a word such as "1x" its first letters.
TEST_F(Meta, RefusesAPlaceThatIsNotAllNumbers) {
  for (const std::string key : {"Offset", "Position", "Origin", "ElementSpacing", "ElementSize"}) {
    for (const std::string bad : {"1 2", "1 2 3 4", "1 2 3x", "1 2 nan", "1 2 inf", ""}) {
      refuses(metaHeader("MET_SHORT", key + " = " + bad + "\n") + data_, key + " \"" + bad + "\" is not ");
    }
  }
  for (const std::string key : {"TransformMatrix", "Rotation", "Orientation"}) {
    for (const std::string bad :
         {"1 0 0 0 1 0 0 0", "1 0 0 0 1 0 0 0 1 0", "1 0 0 0 1 0 0 0 1x", "nan 0 0 0 1 0 0 0 1"}) {
      refuses(metaHeader("MET_SHORT", key + " = " + bad + "\n") + data_,
              key + " \"" + bad + "\" is not 9 finite numbers");
    }
  }
}

TEST_F(Meta, RefusesBadSpacing) {
  for (const std::string spacing : {"0 1 1", "1 -1 1", "1 1 nan"}) {
    refuses(metaHeader("MET_SHORT", "ElementSpacing = " + spacing + "\n") + data_, "ElementSpacing");
  }
}

TEST_F(Meta, SaysWhenTheVoxelSizeIsMissing) {
  EXPECT_THAT(load(metaHeader("MET_SHORT", "") + data_).facts().remark, testing::HasSubstr("1 mm"));
}

TEST_F(Meta, RefusesWhatIsNoVolume) {
  std::string flat = metaHeader("MET_SHORT", "", "LOCAL", "5 12");
  flat.replace(flat.find("NDims = 3"), 9, "NDims = 2");
  refuses(flat + data_, "2 dimensions");
  refuses(metaHeader("MET_SHORT", "ElementNumberOfChannels = 3\n", "LOCAL", "5 2 2") + data_,
          "its voxels are colours or vectors of 3 components, and a density is one number");
  refuses(metaHeader("MET_SHORT", "ElementNumberOfChannels = x\n") + data_,
          "ElementNumberOfChannels \"x\" is no count");
  std::string series = metaHeader("MET_SHORT", "", "LOCAL", "5 2 2 3");
  series.replace(series.find("NDims = 3"), 9, "NDims = 4");
  refuses(series + data_, "series of 3");
}

TEST_F(Meta, RefusesSizesThatAreNoCounts) {
  for (const std::string sizes : {"5 0 3", "5 4.5 3", "5 -4 3", "5 x 3", "5 4 1e16"})
    refuses(metaHeader("MET_SHORT", "", "LOCAL", sizes) + data_,
            "its DimSize \"" + sizes + "\" is no list of counts; write the file again");
  const std::string eleven = "5 4 3 1 1 1 1 1 1 1 1";
  std::string header = metaHeader("MET_SHORT", "", "LOCAL", eleven);
  header.replace(header.find("NDims = 3"), 9, "NDims = 11");
  refuses(header + data_, "its NDims \"11\" is not the count of its DimSize");
  EXPECT_EQ(load(metaHeader("MET_SHORT", "ElementNumberOfChannels = 1\n") + data_).toDense(),
            asFloats(rampValues(-30)));
}

TEST_F(Meta, RefusesACountOfDimensionsThatIsNot) {
  for (const std::string count : {"99999999999999999999", "4", "-1", "x"}) {
    std::string header = metaHeader("MET_SHORT");
    header.replace(header.find("NDims = 3"), 9, "NDims = " + count);
    refuses(header + data_, "NDims");
  }
}

TEST_F(Meta, RefusesMoreThanMemoryAndShortData) {
  // 10^15 voxels as shorts of the file, as floats, in leaves and on the GPU: 18.2 bytes each.
  refuses(metaHeader("MET_SHORT", "", "LOCAL", "100000 100000 100000"),
          "it needs 1.7e+07 GiB with its copy for the GPU", Error::Code::kOutOfMemory);
  refuses(metaHeader("MET_SHORT") + data_.substr(1), "cannot hold");
}

}  // namespace meta_test
}  // namespace palpate
