// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "engine/files/volume_file.hpp"
#include "tests/engine/files/known_leaks.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace nifti_test {

// NIfTI's identity is RAS: seen from LPS, i and j run backwards.
Lattice rasLattice() {
  return {Vec3::Zero(), Vec3(-1, -1, 1).asDiagonal(), kSpacing_mm * 1e-3};
}

class Nifti : public testing::Test {
 protected:
  [[nodiscard]] Volume load(const NiftiFields& fields, const std::string& data) const {
    writeFile(path_, niftiHeader(fields) + data);
    return loadVolume(path_);
  }
  void refuses(const NiftiFields& fields, const std::string& reason, Error::Code code = Error::Code::kBadInput) const {
    writeFile(path_, niftiHeader(fields) + data_);
    expectLoadRefusal(path_, reason, code);
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a.nii");
  std::string data_ = bytesOf<std::int16_t>(rampValues(-30));
};

TEST_F(Nifti, ReadsEveryNumberTypeInBothByteOrders) {
  const std::vector<double> values = rampValues(20);
  for (const bool big : {false, true}) {
    const auto check = [&](int datatype, int bits, const std::string& bytes, const std::string& name) {
      NiftiFields fields;
      fields.datatype = datatype;
      fields.bits = bits;
      fields.big_endian = big;
      const Volume volume = load(fields, bytes);
      expectVolume(volume, rasLattice(), values);
      EXPECT_EQ(volume.facts().value_type, name);
    };
    check(2, 8, bytesOf<std::uint8_t>(values, big), "uint8");
    check(256, 8, bytesOf<std::int8_t>(values, big), "int8");
    check(4, 16, bytesOf<std::int16_t>(values, big), "int16");
    check(512, 16, bytesOf<std::uint16_t>(values, big), "uint16");
    check(8, 32, bytesOf<std::int32_t>(values, big), "int32");
    check(768, 32, bytesOf<std::uint32_t>(values, big), "uint32");
    check(16, 32, bytesOf<float>(values, big), "float32");
    check(64, 64, bytesOf<double>(values, big), "float64");
    check(1024, 64, bytesOf<std::int64_t>(values, big), "int64");
    check(1280, 64, bytesOf<std::uint64_t>(values, big), "uint64");
  }
}

// Seven dimensions are the most, all but three of them one voxel thick.
TEST_F(Nifti, CountsDimensions) {
  NiftiFields fields;
  fields.dim = {7, 5, 4, 3, 1, 1, 1, 1};
  expectVolume(load(fields, data_), rasLattice(), rampValues(-30));
  fields.dim = {7, 5, 4, 1, 1, 1, 1, 3};
  refuses(fields, "it is a series of 3 volumes; extract one of them");
  fields.dim = {1, 60, 1, 1, 1, 1, 1, 1};
  refuses(fields, "it has 1 dimensions; give a volume");
}

// In one file at or behind its header of 348 bytes, or where nothing is said at 352; in a pair anywhere.
TEST_F(Nifti, FindsTheValuesWhereTheHeaderSays) {
  const auto at = [&](bool one_file, float offset, const std::string& between) {
    NiftiFields fields;
    fields.one_file = one_file;
    std::string head = niftiHeader(fields);
    overwrite(head, 108, bytesOf<float>({offset}));
    if (one_file) return head.substr(0, 348) + between + data_;
    writeFile(folder_.file("p.img"), between + data_);
    return head;
  };
  for (const auto& [offset, bytes] :
       {std::pair(348.0F, 0), std::pair(352.0F, 4), std::pair(0.0F, 4), std::pair(400.0F, 52)}) {
    writeFile(path_, at(true, offset, std::string(static_cast<std::size_t>(bytes), 'x')));
    expectVolume(loadVolume(path_), rasLattice(), rampValues(-30));
  }
  for (const float offset : {0.0F, 7.0F}) {
    writeFile(folder_.file("p.hdr"), at(false, offset, std::string(static_cast<std::size_t>(offset), 'x')));
    expectVolume(loadVolume(folder_.file("p.hdr")), rasLattice(), rampValues(-30));
  }
  for (const float offset : {347.0F, 352.5F, -1.0F, 2e12F, std::nanf("")}) {
    writeFile(path_, at(true, offset, "xxxx"));
    expectLoadRefusal(path_, "is no place in a file; write the file again");
  }
}

// Half a turn about x: i runs right, j posterior, k inferior. With qfac -1 the third axis is the other way round.
TEST_F(Nifti, TurnsHalfTurnsAndHandedness) {
  NiftiFields fields;
  fields.quaternion = {1, 0, 0};
  Lattice lattice = {Vec3::Zero(), Vec3(-1, 1, -1).asDiagonal(), kSpacing_mm * 1e-3};
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-9);
  fields.pixdim[0] = -1;
  lattice.R_WL.col(2) *= -1;
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-9);
  fields.quaternion = {0, 1, 0};  // about y
  lattice.R_WL = Vec3(1, -1, 1).asDiagonal();
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-9);
  fields.pixdim[0] = 0;  // not said: as 1
  lattice.R_WL.col(2) *= -1;
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-9);
}

// Up to a hundredth of the shortest voxel, which is 0.005 mm, at the farthest corner.
TEST_F(Nifti, TakesRoundingForNoDisagreement) {
  const auto remarkOf = [&](float offset, float step) {
    NiftiFields fields;
    fields.sform_code = 1;
    fields.sform = {0.5F, 0, 0, 0, 0, 0.75F, 0, offset, 0, 0, 2 + step, 0};
    return load(fields, data_).facts().remark;
  };
  EXPECT_EQ(remarkOf(0, 0), "");
  EXPECT_EQ(remarkOf(0.0049F, 0), "");
  EXPECT_EQ(remarkOf(0.0051F, 0), "its qform and its sform place voxels up to 0.0051 mm apart; the sform is taken");
  EXPECT_EQ(remarkOf(0, 0.0024F), "");  // the last slice is two steps away
  EXPECT_EQ(remarkOf(0, 0.0026F), "its qform and its sform place voxels up to 0.0052 mm apart; the sform is taken");
}

TEST_F(Nifti, AppliesSlopeAndIntercept) {
  NiftiFields fields;
  fields.slope = 0.5F;
  fields.intercept = 100;
  const Volume volume = load(fields, data_);
  std::vector<double> values = rampValues(-30);
  for (double& value : values) value = 0.5 * value + 100;
  expectVolume(volume, rasLattice(), values);
  EXPECT_EQ(volume.facts().rescale_slope, 0.5);
  EXPECT_EQ(volume.facts().rescale_intercept, 100);
  EXPECT_EQ(volume.facts().value_type, "int16");
}

// A slope of 1 with an intercept is a scaling too, and a slope of 0 says that there is none, whatever the intercept is
// (nifti1.h, "DATA SCALING"); for integers and floats, as they lie in memory and turned.
TEST_F(Nifti, AppliesAnInterceptAloneAndNoneToASlopeOfZero) {
  const std::vector<double> values = rampValues(20);
  for (const bool big : {false, true}) {
    const auto check = [&](int datatype, int bits, const std::string& bytes) {
      for (const float slope : {0.0F, 1.0F, -1.0F, 2.0F}) {
        for (const float intercept : {0.0F, -7.5F}) {
          NiftiFields fields;
          fields.datatype = datatype;
          fields.bits = bits;
          fields.big_endian = big;
          fields.slope = slope;
          fields.intercept = intercept;
          std::vector<double> want = values;
          for (double& value : want) value = slope == 0 ? value : slope * value + intercept;
          SCOPED_TRACE(testing::Message() << datatype << " " << slope << " " << intercept << " " << big);
          expectVolume(load(fields, bytes), rasLattice(), want);
        }
      }
    };
    check(2, 8, bytesOf<std::uint8_t>(values, big));
    check(4, 16, bytesOf<std::int16_t>(values, big));
    check(8, 32, bytesOf<std::int32_t>(values, big));
    check(16, 32, bytesOf<float>(values, big));
    check(64, 64, bytesOf<double>(values, big));
  }
}

TEST_F(Nifti, ReadsCompressedFilesAndPairs) {
  writeGzip(folder_.file("b.nii.gz"), niftiHeader({}) + data_);
  expectVolume(loadVolume(folder_.file("b.nii.gz")), rasLattice(), rampValues(-30));
  NiftiFields pair;
  pair.one_file = false;
  writeFile(folder_.file("c.hdr"), niftiHeader(pair));
  writeFile(folder_.file("c.img"), data_);
  expectVolume(loadVolume(folder_.file("c.hdr")), rasLattice(), rampValues(-30));
  expectVolume(loadVolume(folder_.file("c.img")), rasLattice(), rampValues(-30));
}

// A quarter turn about z: i runs anterior, j right. RAS offset (10, 20, 30) mm.
TEST_F(Nifti, TurnsQuaternionsAndMatricesToLps) {
  Mat3 R_WL;
  R_WL << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  const Lattice lattice = {Vec3(-0.010, -0.020, 0.030), R_WL, kSpacing_mm * 1e-3};
  NiftiFields fields;
  fields.quaternion = {0, 0, 0.70710678F};
  fields.offset = {10, 20, 30};
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-6);
  fields = {};
  fields.qform_code = 0;
  fields.sform_code = 1;
  fields.sform = {0, -0.75F, 0, 10, 0.5F, 0, 0, 20, 0, 0, 2, 30};
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-6);
}

TEST_F(Nifti, KeepsAnObliqueLattice) {
  writeWithItk(ItkWriter::kNifti, folder_.file("o.nii.gz"), itkImageOf(obliqueLattice(), rampValues()), true);
  expectVolume(loadVolume(folder_.file("o.nii.gz")), obliqueLattice(), rampValues(), 1e-6);
}

TEST_F(Nifti, HonoursUnitsOfLength) {
  NiftiFields fields;
  fields.offset = {-10, -20, 30};
  Lattice lattice = rasLattice();
  lattice.origin_W = Vec3(10, 20, 30);
  lattice.spacing_m *= 1e3;
  fields.units = 1;  // metres
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-6);
  fields.units = 3;  // micrometres
  lattice.origin_W *= 1e-6;
  lattice.spacing_m *= 1e-6;
  expectVolume(load(fields, data_), lattice, rampValues(-30), 1e-12);
}

// The matrix is in the file's unit as the quaternion's offset is; pixdim is not asked for voxel sizes.
TEST_F(Nifti, HonoursUnitsOfLengthInMatrices) {
  for (const auto& [units, metres] : std::map<int, double>{{1, 1.0}, {2, 1e-3}, {3, 1e-6}, {0, 1e-3}}) {
    NiftiFields fields;
    fields.units = units;
    fields.qform_code = 0;
    fields.sform_code = 1;
    fields.sform = {0, -0.75F, 0, 10, 0.5F, 0, 0, 20, 0, 0, 2, 30};
    Mat3 R_WL;
    R_WL << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    const Lattice lattice = {Vec3(-10, -20, 30) * metres, R_WL, kSpacing_mm * metres};
    const Volume volume = load(fields, data_);
    expectVolume(volume, lattice, rampValues(-30), 30 * metres * 1e-6);
    EXPECT_THAT(volume.facts().remark, testing::AnyOf("", testing::StartsWith("it is 0.006 mm long")));
    EXPECT_THAT(volume.facts().orientation, testing::HasSubstr("sform"));
  }
}

// Without a form the axes are right, anterior, superior, as the words say.
TEST_F(Nifti, TakesAFileWithoutAFormAsRas) {
  NiftiFields fields;
  fields.qform_code = 0;
  fields.offset = {10, 20, 30};  // of no meaning
  const Volume volume = load(fields, data_);
  expectVolume(volume, rasLattice(), rampValues(-30));
  EXPECT_THAT(volume.facts().orientation, testing::HasSubstr("taken as RAS"));
}

// i and j meet at 84 degrees: cos is 0.1045.
TEST_F(Nifti, SaysThatAMatrixIsSheared) {
  NiftiFields fields;
  fields.qform_code = 0;
  fields.sform_code = 1;
  fields.sform = {0.5F, 0.75F * 0.1045F, 0, 0, 0, 0.75F * 0.9945F, 0, 0, 0, 0, 2, 0};
  refuses(fields, "sheared: two of its axes meet at 84");
  fields.qform_code = 1;  // which is not
  const Volume volume = load(fields, data_);
  expectVolume(volume, rasLattice(), rampValues(-30));
  EXPECT_THAT(volume.facts().remark, testing::HasSubstr("sheared"));
  EXPECT_THAT(volume.facts().remark, testing::HasSubstr("qform is taken"));
}

// The sform, but where the qform alone is in the scanner's frame. The two are 5 mm apart.
TEST_F(Nifti, SaysWhichOfTwoFormsItTakes) {
  for (const auto& [qform, sform, takes_sform] :
       {std::tuple{1, 1, true}, std::tuple{1, 4, false}, std::tuple{2, 4, true}}) {
    NiftiFields fields;
    fields.qform_code = qform;
    fields.sform_code = sform;
    fields.sform = {0.5F, 0, 0, 3, 0, 0.75F, 0, 4, 0, 0, 2, 0};
    Lattice lattice = rasLattice();
    if (takes_sform) lattice.origin_W = Vec3(-3e-3, -4e-3, 0);
    const Volume volume = load(fields, data_);
    expectVolume(volume, lattice, rampValues(-30), 1e-9);
    EXPECT_EQ(volume.facts().remark,
              std::string("its qform and its sform place voxels up to 5 mm apart; the ") +
                  (takes_sform ? "sform is taken" : "qform is taken, whose frame is the scanner's"));
    EXPECT_EQ(volume.facts().orientation,
              std::string("RAS file turned to LPS, by its ") + (takes_sform ? "sform" : "qform"));
    fields.offset = {3, 4, 0};
    EXPECT_EQ(load(fields, data_).facts().remark, "");
  }
}

TEST_F(Nifti, SaysThatMatrixAndVoxelSizesDisagree) {
  NiftiFields fields;
  fields.qform_code = 0;
  fields.sform_code = 1;
  fields.sform = {0.6F, 0, 0, 0, 0, 0.75F, 0, 0, 0, 0, 2, 0};
  const Volume volume = load(fields, data_);
  EXPECT_NEAR(volume.lattice().spacing_m.x(), 0.6e-3, 1e-9);
  EXPECT_THAT(volume.facts().remark, testing::HasSubstr("0.6 mm long along i, its pixdim 0.5 mm"));
}

TEST_F(Nifti, RefusesFormsThatPlaceNothing) {
  const float nan = std::nanf("");
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, 3e38F}) {
    NiftiFields fields;
    fields.sform_code = 1;
    fields.sform = {0.5F, 0, 0, bad, 0, 0.75F, 0, 0, 0, 0, 2, 0};
    refuses(fields, "no place of a voxel");
    fields = {};
    fields.offset[1] = bad;
    refuses(fields, "no place of a voxel");
  }
  NiftiFields flat;
  flat.sform_code = 1;
  flat.sform = {0.5F, 0, 0, 0, 0, 0.75F, 0, 0, 0, 0, 0, 0};
  refuses(flat, "no length along axis k");
}

TEST_F(Nifti, RefusesAUnitThatThereIsNot) {
  for (const int unit : {4, 5, 7, 8 + 6}) {
    NiftiFields fields;
    fields.units = unit;
    refuses(fields, "xyzt_units");
  }
}

TEST_F(Nifti, RefusesAHandednessThatIsNoNumber) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    NiftiFields fields;
    fields.pixdim[0] = bad;
    refuses(fields, "no place of a voxel");
  }
}

TEST_F(Nifti, RefusesBadVoxelSizes) {
  for (const float size : {0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    NiftiFields fields;
    fields.pixdim[2] = size;
    refuses(fields, "not positive");
  }
}

TEST_F(Nifti, RefusesWhatIsNoVolumeOfNumbers) {
  NiftiFields flat;
  flat.dim = {2, 5, 12, 1, 1, 1, 1, 1};
  refuses(flat, "2 dimensions");
  NiftiFields series;
  series.dim = {4, 5, 4, 1, 3, 1, 1, 1};
  refuses(series, "series of 3");
  NiftiFields several;
  for (const auto& [datatype, words] : {std::pair(128, "its voxels are colours of 3 components"),
                                        {2304, "its voxels are colours of 4 components"},
                                        {32, "its voxels are complex numbers of 2 components"},
                                        {1792, "its voxels are complex numbers of 2 components"}}) {
    several.datatype = datatype;
    refuses(several, words);
  }
}

// The fifth axis has the components of a voxel, whatever the fourth has.
TEST_F(Nifti, RefusesComponentsAlongAnAxis) {
  NiftiFields fields;
  fields.dim = {5, 5, 2, 2, 1, 3, 1, 1};
  refuses(fields, "its voxels are vectors of 3 components, and a density is one number");
  fields.dim = {5, 5, 2, 1, 2, 3, 1, 1};
  refuses(fields, "vectors of 3 components");
  std::string bytes = niftiHeader(fields);
  overwrite(bytes, 68, bytesOf<std::int16_t>({2003}));  // intent: RGB
  writeFile(path_, bytes + data_);
  expectLoadRefusal(path_, "its voxels are colours of 3 components, and a density is one number");
}

TEST_F(Nifti, ReadsOneTimePoint) {
  NiftiFields series;
  series.dim = {4, 5, 4, 3, 1, 1, 1, 1};
  expectVolume(load(series, data_), rasLattice(), rampValues(-30));
}

TEST_F(Nifti, RefusesAnalyzeAndNifti2) {
  NiftiFields pair;
  pair.one_file = false;
  std::string bytes = niftiHeader(pair);
  overwrite(bytes, 344, std::string(4, '\0'));
  writeFile(folder_.file("old.hdr"), bytes);
  writeFile(folder_.file("old.img"), data_);
  expectLoadRefusal(folder_.file("old.hdr"), "left from right");
  bytes = std::string(540, '\0');
  overwrite(bytes, 0, bytesOf<std::int32_t>({540}));
  writeFile(path_, bytes);
  expectLoadRefusal(path_, "NIfTI-2");
}

TEST_F(Nifti, RefusesMoreThanMemoryBeforeReadingIt) {
  NiftiFields huge;
  huge.dim = {3, 32767, 32767, 32767, 1, 1, 1, 1};
  refuses(huge, "GiB", Error::Code::kOutOfMemory);
}

// ITK's NIfTI library aborts on some of these and loops for ever on others.
TEST_F(Nifti, RefusesAMatrixOfNoNumbers) {
  for (const float number : {std::nanf(""), std::numeric_limits<float>::infinity(), 3e38F}) {
    for (const std::size_t at : {0U, 3U, 5U, 10U}) {
      NiftiFields fields;
      fields.qform_code = 0;
      fields.sform_code = 1;
      fields.sform = {0.5F, 0, 0, 0, 0, 0.75F, 0, 0, 0, 0, 2, 0};
      fields.sform[at] = number;
      writeFile(path_, niftiHeader(fields) + data_);
      EXPECT_THROW(static_cast<void>(loadVolume(path_)), Error) << number << " at " << at;
    }
  }
}

TEST_F(Nifti, RefusesVoxelsOfWhichNoneIsANumber) {
  NiftiFields fields;
  fields.datatype = 16;
  fields.bits = 32;
  std::vector<double> values(60, std::nan(""));
  writeFile(path_, niftiHeader(fields) + bytesOf<float>(values));
  expectLoadRefusal(path_, "all of its 60 voxels");
  values[59] = 7;
  const Volume volume = load(fields, bytesOf<float>(values));
  EXPECT_EQ(volume.value({4, 3, 2}), 7);
  EXPECT_EQ(volume.value({0, 0, 0}), 0);
  EXPECT_THAT(volume.facts().remark, testing::HasSubstr("59 of 60"));
}

TEST_F(Nifti, AppliesAnInterceptToFloatsOfSlopeOneAndNoneWithoutASlope) {
  NiftiFields fields;
  fields.datatype = 16;
  fields.bits = 32;
  fields.slope = 1;
  fields.intercept = -1000;
  EXPECT_EQ(load(fields, bytesOf<float>(rampValues())).toDense(), asFloats(rampValues(-1000)));
  fields.slope = 0;
  EXPECT_EQ(load(fields, bytesOf<float>(rampValues())).toDense(), asFloats(rampValues()));
  fields.slope = std::nanf("");
  writeFile(path_, niftiHeader(fields) + bytesOf<float>(rampValues()));
  expectLoadRefusal(path_, "scl_slope");
}

TEST_F(Nifti, RefusesGzipThatIsCutOrChanged) {
  const std::string name = folder_.file("a.nii.gz");
  std::vector<float> values(27'000);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n * 7919 % 4096);
  saveVolume(Volume::fromDense(Vec3i::Constant(30), plainLattice(), values, {}), name);
  const std::string whole = readFile(name);
  for (const std::size_t length : {whole.size() / 2, whole.size() - 4, whole.size() - 1}) {
    writeFile(name, whole.substr(0, length));
    expectLoadRefusal(name, "end early");
  }
  std::string wrong_checksum = whole;
  wrong_checksum[whole.size() - 8] = static_cast<char>(wrong_checksum[whole.size() - 8] ^ 1);
  writeFile(name, wrong_checksum);
  expectLoadRefusal(name, "data check");
  writeGzip(name, niftiHeader({}) + data_ + "more");
  expectLoadRefusal(name, "more voxels");
  writeGzip(name, niftiHeader({}) + data_.substr(2));
  expectLoadRefusal(name, "fewer voxels");
}

// A damaged gzip of as many bytes as the values need is not taken for the values.
TEST_F(Nifti, RefusesPlainBytesNamedAsGzip) {
  NiftiFields pair;
  pair.one_file = false;
  writeFile(folder_.file("c.hdr"), niftiHeader(pair));
  writeFile(folder_.file("c.img.gz"), data_);
  expectLoadRefusal(folder_.file("c.hdr"), "compressed data are damaged");
}

TEST_F(Nifti, RefusesShortData) {
  writeFile(path_, niftiHeader({}) + data_.substr(2));
  expectLoadRefusal(path_, "cannot hold");
}

}  // namespace nifti_test
}  // namespace palpate
