// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/files/volume_file.hpp"
#include "engine/files/volume_name.hpp"
#include "tests/engine/files/packed_dicom.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace dicom_test {

class Dicom : public testing::Test {
 protected:
  // Slices whose file names run against their order in space.
  void writeSeries(const DicomFields& common, const std::vector<double>& z_mm, const std::string& prefix = "s") const {
    const std::vector<double> ramp = rampValues(-30);
    for (std::size_t n = 0; n < z_mm.size(); ++n) {
      DicomFields fields = common;
      fields.sop = fmt::format("{}.{}", common.series, n + 1);
      fields.position = fmt::format("10\\-20\\{}", z_mm[n]);
      const auto first = ramp.begin() + static_cast<std::ptrdiff_t>(n % 3 * 20);
      fields.pixels.assign(first, first + 20);
      writeSlice(fields, fmt::format("{}{}.dcm", prefix, z_mm.size() - n));
    }
  }
  void writeSlice(const DicomFields& fields, const std::string& name) const {
    writeFile(folder_.file(name), dicomBytes(fields));
  }
  void refuses(const std::string& reason) const { expectLoadRefusal(folder_.path(), reason); }

  TempFolder folder_;
};

TEST_F(Dicom, OrdersSlicesByPositionAndAppliesTheSlope) {
  writeSeries({}, {30, 32, 34});
  writeFile(folder_.file("readme.txt"), "no slice");
  const Volume volume = loadVolume(folder_.path());
  std::vector<double> values = rampValues(-30);
  for (double& value : values) value = 2 * value - 100;
  Lattice lattice = plainLattice();
  lattice.origin_W = Vec3(0.010, -0.020, 0.030);
  expectVolume(volume, lattice, values, 1e-9);
  EXPECT_EQ(volume.facts().format, "DICOM series");
  EXPECT_EQ(volume.facts().value_type, "int16");
  EXPECT_EQ(volume.facts().rescale_slope, 2);
  EXPECT_EQ(volume.facts().rescale_intercept, -100);
}

TEST_F(Dicom, ReadsBigEndianAndDeflatedSlices) {
  std::vector<double> values = rampValues(-30);
  for (double& value : values) value = 2 * value - 100;
  for (const char* syntax : {kBigEndianDicom, kDeflatedDicom}) {
    DicomFields fields;
    fields.syntax = syntax;
    writeSeries(fields, {30, 32, 34});
    EXPECT_EQ(loadVolume(folder_.path()).toDense(), asFloats(values)) << syntax;
  }
}

// GDCM fills up with zeros what is missing.
TEST_F(Dicom, RefusesLostPixelsInEverySyntax) {
  for (const char* syntax : {kLittleEndianDicom, kBigEndianDicom, kDeflatedDicom}) {
    DicomFields fields;
    fields.syntax = syntax;
    writeSeries(fields, {0, 2, 4});
    fields.pixels = std::vector<double>(10, 1);  // of 20; the element is that short
    fields.position = "10\\-20\\2";
    writeSlice(fields, "s2.dcm");
    refuses("slice s2.dcm is cut short or damaged");
    fields.pixels = rampValues();
    fields.pixels.resize(20);
    const std::string whole = dicomBytes(fields);
    for (const std::size_t lost : {1U, 2U, 8U, 20U}) {
      writeFile(folder_.file("s2.dcm"), whole.substr(0, whole.size() - lost));
      refuses("slice s2.dcm is cut short or damaged");
    }
    writeFile(folder_.file("s2.dcm"), whole + "x");
    refuses("slice s2.dcm is cut short or damaged");
  }
}

// A deflated data set of an odd number of bytes may have one byte of 0 behind it (PS3.5, A.5).
TEST_F(Dicom, TakesThePaddingOfADeflatedSlice) {
  DicomFields fields;
  fields.syntax = kDeflatedDicom;
  writeSeries(fields, {0, 2, 4});
  const std::string whole = readFile(folder_.file("s2.dcm"));
  writeFile(folder_.file("s2.dcm"), whole + std::string(1, '\0'));
  EXPECT_NO_THROW(static_cast<void>(loadVolume(folder_.path())));
  writeFile(folder_.file("s2.dcm"), whole + std::string(2, '\0'));
  refuses("cut short or damaged");
}

// There is one frame at least, so its pixels must be there.
TEST_F(Dicom, CountsPixelsWhateverTheNumberOfFramesIs) {
  for (const char* frames : {"0", "-1"}) {
    DicomFields fields;
    fields.frames = frames;
    fields.rows = 8;
    writeSeries(fields, {0, 2, 4});
    refuses("cut short or damaged");
  }
}

// Coronal slices: rows run left, columns run down; the normal, row x column, is anterior to posterior.
TEST_F(Dicom, KeepsObliqueOrientation) {
  for (int n = 0; n < 3; ++n) {
    DicomFields fields;
    fields.orientation = "1\\0\\0\\0\\0\\-1";
    fields.position = fmt::format("0\\{}\\0", 2 * n);
    fields.sop += std::to_string(n);
    fields.pixels = std::vector<double>(20, n);
    writeSlice(fields, fmt::format("{}.dcm", n));
  }
  const Volume volume = loadVolume(folder_.path());
  Mat3 R_WL;
  R_WL << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  expectLattice(volume.lattice(), {Vec3::Zero(), R_WL, kSpacing_mm * 1e-3}, 1e-9);
  EXPECT_EQ(volume.value({0, 0, 2}), 2 * 2 - 100);
}

TEST_F(Dicom, TakesTheSeriesThatIsNamed) {
  writeSeries({}, {0, 2, 4}, "a");
  DicomFields other;
  other.series = "1.2.3.9";
  writeSeries(other, {0, 1}, "b");
  refuses("the folder holds 2 series: 1: 1.2.3.4.5 (3 slices), 2: 1.2.3.9 (2 slices)");
  for (const char* name : {"1.2.3.9", "2"}) {
    const Volume volume = loadVolume(withSeries(folder_.path(), name));
    EXPECT_EQ(volume.size().z(), 2);
    EXPECT_EQ(volume.facts().part, "series 2 of 2: 1.2.3.9");
  }
  EXPECT_EQ(loadVolume(folder_.path() + "#1").size().z(), 3);
  for (const char* none : {"1.1", "0", "3", "-1", "1x", "99999999999999999999"}) {
    expectLoadRefusal(folder_.path() + "#" + none, "no series");
  }
  EXPECT_THROW((void)withSeries(folder_.path() + "#1", "2"), Error);
  EXPECT_THROW((void)withSeries(folder_.file("a1.dcm"), "2"), Error);
}

// With the words that a scanner gave it, and a series of one slice by its count.
TEST_F(Dicom, NamesSeriesByTheirDescription) {
  DicomFields fields;
  fields.description = "Head 1 mm";
  writeSeries(fields, {0, 2, 4}, "a");
  EXPECT_EQ(loadVolume(folder_.path()).facts().part, "series 1.2.3.4.5 \"Head 1 mm\"");
  DicomFields other;
  other.series = "1.2.3.9";
  writeSeries(other, {7}, "b");
  refuses(
      "the folder holds 2 series: 1: \"Head 1 mm\" 1.2.3.4.5 (3 slices), 2: 1.2.3.9 (1 slice); "
      "choose one: --series 1, or " +
      folder_.path() + "#1 as its name");
  EXPECT_EQ(loadVolume(folder_.path() + "#1").facts().part, "series 1 of 2: 1.2.3.4.5 \"Head 1 mm\"");
  expectLoadRefusal(folder_.path() + "#2", "the series has one slice; give the whole series");
  expectLoadRefusal(folder_.path() + "#3", "the folder has no series 3; choose one of 1: \"Head 1 mm\" 1.2.3.4.5 (3");
}

// A folder of one series needs no number, and says which it is.
TEST_F(Dicom, SaysWhichSeriesItIs) {
  writeSeries({}, {0, 2, 4});
  EXPECT_EQ(loadVolume(folder_.path()).facts().part, "series 1.2.3.4.5");
  EXPECT_EQ(loadVolume(folder_.path() + "#1").facts().part, "series 1.2.3.4.5");
}

TEST_F(Dicom, RefusesSlopesAndInterceptsThatAreNoNumbers) {
  for (const char* bad : {"inf", "nan", "1e999", "0x10", "two", "1\\2"}) {
    DicomFields fields;
    fields.slope = bad;
    writeSeries(fields, {0, 2, 4});
    refuses("RescaleSlope");
    fields = {};
    fields.intercept = bad;
    writeSeries(fields, {0, 2, 4});
    refuses("RescaleIntercept");
  }
  DicomFields flat;
  flat.slope = "0";  // every density would be the intercept
  writeSeries(flat, {0, 2, 4});
  refuses("RescaleSlope");
}

TEST_F(Dicom, SaysThatNoFileCanBeOpened) {
  writeSeries({}, {0, 2, 4});
  EXPECT_GT(refusalsForDescriptors(folder_.path()), 0);
  for (const char* name : {"s1.dcm", "s2.dcm", "s3.dcm"})
    writeFile(folder_.file(name), packedDicom(readFile(folder_.file(name)), DicomPacking::kJpegLossless));
  EXPECT_GT(refusalsForDescriptors(folder_.path()), 2);
}

// Pixels that are not there are no zeros.
TEST_F(Dicom, RefusesRowsAndColumnsBeyondThePixels) {
  for (const auto& [rows, columns] : {std::pair{5, 5}, std::pair{4, 6}, std::pair{4000, 5}, std::pair{65535, 65535}}) {
    DicomFields fields;
    fields.rows = rows;
    fields.columns = columns;
    writeSeries(fields, {0, 2, 4});
    refuses("cut short or damaged");
  }
}

// As on a CD: a directory of what is there, a report, a radiotherapy plan, which hold no image.
TEST_F(Dicom, PassesOverObjectsThatAreNoImages) {
  writeSeries({}, {0, 2, 4});
  const Volume alone = loadVolume(folder_.path());
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2";
  DicomFields fields;
  fields.pixels = std::vector<double>(20, 7);
  for (const auto& [name, object_class] :
       {std::pair("DICOMDIR", "1.2.840.10008.1.3.10"), std::pair("report.dcm", "1.2.840.10008.5.1.4.1.1.88.11"),
        std::pair("plan.dcm", "1.2.840.10008.5.1.4.1.1.481.5"), std::pair("raw.dcm", "1.2.840.10008.5.1.4.1.1.66")}) {
    std::string head = dicomHead(fields);
    const std::string wanted = dicomElement(2, 0x0002, "UI", object_class);
    const std::string had = dicomElement(2, 0x0002, "UI", ct);
    head.replace(head.find(had), had.size(), wanted);
    writeFile(folder_.file(name), head + dicomElement(8, 0x0016, "UI", object_class));
  }
  EXPECT_EQ(loadVolume(folder_.path()).toDense(), alone.toDense());
  // Nor is what has neither pixels nor a size nor a place, whatever its class: a maker's own, spectra.
  writeFile(folder_.file("own.dcm"), dicomHead(fields) + dicomElement(8, 0x0016, "UI", "1.2.3.4.5.6.7"));
  EXPECT_EQ(loadVolume(folder_.path()).toDense(), alone.toDense());
  // A slice of CT that lost its pixels is no such object.
  const std::string us = bytesOf<std::uint16_t>({4});
  for (const std::string& rest : {dicomElement(0x20, 0x0032, "DS", "0\\0\\2"), dicomElement(0x28, 0x0010, "US", us),
                                  dicomElement(0x28, 0x0011, "US", us)}) {
    writeFile(folder_.file("cut.dcm"), dicomHead(fields) + dicomElement(8, 0x0016, "UI", ct) + rest);
    refuses("slice cut.dcm has no pixels; copy the series again or take the file away");
  }
}

// Spectra have rows and columns, and no pixels.
TEST_F(Dicom, PassesOverSpectra) {
  writeSeries({}, {0, 2, 4});
  const std::string ct = dicomElement(2, 0x0002, "UI", "1.2.840.10008.5.1.4.1.1.2");
  const std::string spectra = "1.2.840.10008.5.1.4.1.1.4.2";
  std::string file = dicomHead({});
  file.replace(file.find(ct), ct.size(), dicomElement(2, 0x0002, "UI", spectra));
  const std::string us = bytesOf<std::uint16_t>({4});
  writeFile(folder_.file("x.dcm"), file + dicomElement(8, 0x0016, "UI", spectra) +
                                       dicomElement(0x28, 0x0010, "US", us) + dicomElement(0x28, 0x0011, "US", us));
  EXPECT_EQ(loadVolume(folder_.path()).size().z(), 3);
}

// A table of a million empty frames takes a few bytes each, and would become slices before anything is counted.
TEST_F(Dicom, RefusesSizesOfZeroAndMoreFramesThanAnyScan) {
  for (const auto& [rows, columns] : {std::pair{0, 5}, {4, 0}, {0, 0}}) {
    DicomFields fields;
    fields.rows = rows;
    fields.columns = columns;
    fields.pixels = std::vector<double>(20, 1);
    writeSlice(fields, "s.dcm");
    refuses(fmt::format("slice s.dcm has {} rows of {} columns; copy the series again", rows, columns));
  }
  DicomFields fields;
  fields.rows = fields.columns = 1;
  const std::size_t most = 64 * 16384;
  for (const std::size_t frames : {most, most + 1}) {
    fields.frames = std::to_string(frames);
    fields.pixels = std::vector<double>(frames, 1);
    writeSlice(fields, "s.dcm");
    refuses(frames == most ? "s.dcm holds 1048576 frames and does not say where each lies"
                           : "s.dcm holds more than 1048576 frames; split it in another program");
  }
}

// Slices of 64 x 64 pixels of noise on a ramp, as archives keep them.
class PackedDicom : public Dicom, public testing::WithParamInterface<DicomPacking> {
 protected:
  PackedDicom() {
    std::mt19937 random(11);
    for (int n = 0; n < 3; ++n) {
      DicomFields fields;
      fields.rows = fields.columns = 64;
      fields.sop = fmt::format("{}.{}", fields.series, n + 1);
      fields.position = fmt::format("0\\0\\{}", n);
      for (int p = 0; p < 64 * 64; ++p) fields.pixels.push_back(p % 64 * 9 + 100 * n + static_cast<int>(random() % 40));
      for (const double stored : fields.pixels) values_.push_back(2 * stored - 100);
      slices_.push_back(packedDicom(dicomBytes(fields), GetParam()));
    }
  }
  void write(const std::string& second) {
    for (int n = 0; n < 3; ++n) writeFile(folder_.file(fmt::format("s{}.dcm", n)), n == 1 ? second : slices_[n]);
  }
  // Of the second slice.
  [[nodiscard]] std::string frame() const {
    const Fragment at = fragmentOf(slices_[1]);
    return slices_[1].substr(at.first, at.end - at.first);
  }

  std::vector<std::string> slices_;
  std::vector<double> values_;
};
INSTANTIATE_TEST_SUITE_P(Packings, PackedDicom,
                         testing::Values(DicomPacking::kRle, DicomPacking::kJpegLossless, DicomPacking::kJpegLs,
                                         DicomPacking::kJpeg2000));

TEST_P(PackedDicom, IsReadAsItWas) {
  write(slices_[1]);
  EXPECT_EQ(loadVolume(folder_.path()).toDense(), asFloats(values_));
}

// A part of the frame is gone, and the lengths say nothing of it. What comes after the last byte of data (the end
// marker of JPEG) is kept, as by whoever mends a file.
TEST_P(PackedDicom, IsRefusedWherePartOfAFrameIsMissing) {
  const std::string whole = frame();
  std::mt19937 random(12);
  for (int n = 0; n < 20; ++n) {
    const std::size_t head = std::min<std::size_t>(whole.size() / 3, 700);
    const std::size_t kept = head + random() % (whole.size() - head - 200);
    const std::string marker = GetParam() == DicomPacking::kRle ? "" : "\xff\xd9";
    write(withFragment(slices_[1], whole.substr(0, kept) + marker));
    refuses("slice s1.dcm");
  }
}

// JPEG 2000 is not among these: it has neither a length nor a checksum within a frame, and OpenJPEG reads on.
class TellingDicom : public PackedDicom {};
INSTANTIATE_TEST_SUITE_P(Packings, TellingDicom,
                         testing::Values(DicomPacking::kRle, DicomPacking::kJpegLossless, DicomPacking::kJpegLs));

TEST_P(TellingDicom, IsRefusedWhereAStretchIsZero) {
  const std::string whole = frame();
  std::mt19937 random(13);
  for (int n = 0; n < 20; ++n) {
    std::string zeroed = whole;
    zeroed.replace(700 + random() % (whole.size() - 1400), 512, 512, '\0');
    write(withFragment(slices_[1], zeroed));
    refuses("slice s1.dcm");
  }
}

TEST_F(Dicom, RefusesMissingSlices) {
  writeSeries({}, {0, 2, 4, 10, 12, 14});
  refuses("2 slices are missing between s4.dcm and s3.dcm");  // names run backwards, positions do not
}

TEST_F(Dicom, RefusesUnevenSlices) {
  writeSeries({}, {0, 2, 4, 6.5, 8.5, 10.5});
  refuses("2.5 mm apart, others 2 mm");
}

TEST_F(Dicom, RefusesOneMissingSlice) {
  writeSeries({}, {0, 2, 4, 8});
  refuses("1 slice is missing between s2.dcm and s1.dcm; add what is missing");
}

// Up to two in a hundred of the gap, and a twentieth of a pixel (0.5 mm) aside; the spacing is the mean of the gaps.
TEST_F(Dicom, TakesRoundedPositions) {
  writeSeries({}, {0, 2, 4.03, 6});
  EXPECT_NEAR(loadVolume(folder_.path()).lattice().spacing_m.z(), 2e-3, 1e-12);
  writeSeries({}, {0, 2, 4.05, 6});
  refuses("2.05 mm apart, others 2 mm; resample the series evenly");
  const auto shifted = [&](double y_mm) {
    for (int n = 0; n < 4; ++n) {
      DicomFields fields;
      fields.position = fmt::format("0\\{}\\{}", n * y_mm, 2 * n);
      fields.sop += std::to_string(n);
      fields.pixels = std::vector<double>(20, n);
      writeSlice(fields, fmt::format("s{}.dcm", n + 1));
    }
  };
  shifted(0.024);
  EXPECT_EQ(loadVolume(folder_.path()).size(), Vec3i(5, 4, 4));
  shifted(0.026);
  refuses(
      "slices s1.dcm and s2.dcm are shifted sideways, as under a tilted gantry; give --resample, or "
      "resample the series upright");
}

// Gaps of 2 mm, then of 2.04, which each pass. The mean is 2.02 mm, so the slice in the middle is off by 0.02 mm for
// each slice before it: by less than half a gap, 1.01 mm, after 50, and by more after 51.
TEST_F(Dicom, RefusesSlicesWhoseGapsGrow) {
  for (const int half : {50, 51}) {
    std::vector<double> z_mm = {0};
    for (int n = 0; n < 2 * half; ++n) z_mm.push_back(z_mm.back() + (n < half ? 2 : 2.04));
    writeSeries({}, z_mm);
    if (half == 50) {
      EXPECT_EQ(loadVolume(folder_.path()).size().z(), 101);
    } else {
      refuses("lies 1.02 mm from where evenly spaced slices would have it; resample the series evenly");
    }
  }
}

TEST_F(Dicom, RefusesTwoSlicesAtOnePlace) {
  writeSeries({}, {0, 2, 2, 4});
  refuses("lie at one place");
}

TEST_F(Dicom, RefusesATiltedGantry) {
  for (int n = 0; n < 4; ++n) {
    DicomFields fields;
    fields.position = fmt::format("0\\{}\\{}", n, 2 * n);
    fields.pixels = std::vector<double>(20, n);
    writeSlice(fields, fmt::format("{}.dcm", n));
  }
  refuses("tilted gantry");
}

TEST_F(Dicom, RefusesSlicesThatDiffer) {
  writeSeries({}, {0, 2});
  DicomFields wide;
  wide.columns = 10;
  wide.rows = 2;
  writeSeries(wide, {4}, "w");
  refuses("differ in size");
}

// Each of size, pixel spacing and axes alone; a ten-thousandth of a pixel and a thousandth of an axis are rounding.
TEST_F(Dicom, RefusesOneSliceThatDiffersInAnything) {
  const auto write = [&](DicomFields last) {
    writeSeries({}, {0, 2});
    last.sop = "1.2.3.4.5.9";
    last.position = "10\\-20\\4";
    last.pixels = std::vector<double>(static_cast<std::size_t>(last.rows * last.columns), 1);
    writeSlice(last, "w.dcm");
  };
  const auto with = [](const auto& change) {
    DicomFields fields;
    change(fields);
    return fields;
  };
  write(with([](DicomFields& f) { f.pixel_spacing = "0.75005\\0.49997"; }));
  EXPECT_EQ(loadVolume(folder_.path()).size().z(), 3);
  write(with([](DicomFields& f) { f.orientation = "1\\0.0005\\0\\-0.0005\\1\\0"; }));
  EXPECT_EQ(loadVolume(folder_.path()).size().z(), 3);
  for (const DicomFields& other :
       {with([](DicomFields& f) { f.columns = 6; }), with([](DicomFields& f) { f.rows = 5; }),
        with([](DicomFields& f) { f.pixel_spacing = "0.7502\\0.5"; }),
        with([](DicomFields& f) { f.pixel_spacing = "0.75\\0.4998"; }),
        with([](DicomFields& f) { f.orientation = "1\\0\\0.002\\0\\1\\0"; }),
        with([](DicomFields& f) { f.orientation = "1\\0\\0\\0\\1\\0.002"; })}) {
    write(other);
    refuses("slices s2.dcm and w.dcm differ in size, spacing or orientation; keep one scan in a folder");
  }
}

TEST_F(Dicom, RefusesBadOrMissingGeometry) {
  for (const std::string spacing : {"0\\1", "-1\\1", ""}) {
    DicomFields fields;
    fields.pixel_spacing = spacing;
    writeSeries(fields, {0, 2, 4});
    refuses("PixelSpacing");
  }
  DicomFields lost;
  lost.position = "";
  lost.pixels = std::vector<double>(20, 1);
  for (int n = 1; n < 4; ++n) writeSlice(lost, fmt::format("s{}.dcm", n));
  refuses("no position");
}

// GDCM puts the patient's axes and 1 mm where it understands none; a position of "nan" scrambled slices.
TEST_F(Dicom, RefusesGeometryThatIsNoNumbers) {
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "1e300", "0x2", "2x", "2,0", "+-2", "", " "}) {
    SCOPED_TRACE(bad);
    DicomFields fields;
    fields.position = fmt::format("0\\0\\{}", bad);
    writeSeries({}, {0, 2, 4});
    fields.pixels = std::vector<double>(20, 1);
    writeSlice(fields, "s2.dcm");
    refuses("ImagePositionPatient");
    fields = {};
    fields.orientation = fmt::format("1\\0\\0\\0\\{}\\0", bad);
    writeSeries(fields, {0, 2, 4});
    refuses("ImageOrientationPatient");
    if (std::string(bad) == "1e300") continue;  // a pixel that large is refused for the memory or not at all
    fields = {};
    fields.pixel_spacing = fmt::format("{}\\0.5", bad);
    writeSeries(fields, {0, 2, 4});
    refuses("PixelSpacing");
  }
  for (const char* bad : {"0\\0\\0\\0\\0\\0", "1\\0\\0\\0\\2\\0", "1\\0\\0\\0\\1", "1\\0\\0\\0\\1\\0\\0"}) {
    DicomFields fields;
    fields.orientation = bad;
    writeSeries(fields, {0, 2, 4});
    refuses("ImageOrientationPatient");
  }
  for (const char* bad : {"nan", "two", "2\\2"}) {
    DicomFields fields;
    fields.spacing_between_slices = bad;
    writeSeries(fields, {0, 2, 4});
    refuses("SpacingBetweenSlices");
  }
}

// As DICOM writes numbers (PS3.5, 6.2, DS): blanks around them, a sign, an exponent.
TEST_F(Dicom, TakesDecimalStringsOfEveryForm) {
  DicomFields fields;
  fields.pixel_spacing = " +7.5E-1 \\ .5";
  fields.orientation = "1.\\0\\-0\\ 0\\+1 \\0e5";
  fields.spacing_between_slices = "-2";
  writeSeries(fields, {0, 2, 4});
  Lattice lattice = plainLattice();
  lattice.origin_W = Vec3(0.010, -0.020, 0);
  expectLattice(loadVolume(folder_.path()).lattice(), lattice, 1e-12);
}

TEST_F(Dicom, RefusesColour) {
  DicomFields fields;
  fields.samples = 3;
  for (int n = 0; n < 2; ++n) {
    fields.position = fmt::format("0\\0\\{}", n);
    fields.pixels = std::vector<double>(60, 1);
    writeSlice(fields, fmt::format("{}.dcm", n));
  }
  refuses("the pixels of slice 0.dcm are colours of 3 components, and a density is one number");
}

// PET: slices of one series that are scaled each by its own slope.
TEST_F(Dicom, TellsTheRangeOfSlopesThatDiffer) {
  for (int n = 0; n < 3; ++n) {
    DicomFields fields;
    fields.sop += std::to_string(n);
    fields.position = fmt::format("0\\0\\{}", 2 * n);
    fields.slope = std::vector<std::string>{"2", "0.5", "4"}[static_cast<std::size_t>(n)];
    fields.pixels = std::vector<double>(20, 100 * n);
    writeSlice(fields, fmt::format("{}.dcm", n));
  }
  const Volume volume = loadVolume(folder_.path());
  EXPECT_EQ(volume.facts().rescale_in_words, "slope * stored + intercept, by slice: slope 0.5 to 4, intercept -100");
  EXPECT_EQ(volume.facts().rescale_slope, 1);
  EXPECT_EQ(volume.facts().rescale_intercept, 0);
  // 0, 100 and 200, times the slope, less 100.
  for (const auto& [k, density] : {std::pair(0, -100.0F), {1, -50.0F}, {2, 700.0F}})
    EXPECT_EQ(volume.value({1, 2, k}), density);
}

TEST_F(Dicom, HasNoRangeOfSlopesThatAreAllTheSame) {
  writeSeries({}, {0, 2, 4});
  EXPECT_EQ(loadVolume(folder_.path()).facts().rescale_in_words, "");
}

// 1e37 times 29, the highest of the ramp, is below 3.4e38; 1e38 times 4 is not: of the last slice all of 10 to 29, of
// the middle one -10 to -4 and 4 to 9, of the first all of -30 to -11.
TEST_F(Dicom, SlopesBeyondTheRangeOfAFloatAreToldAndMended) {
  DicomFields fields;
  fields.slope = "1e37";
  fields.intercept = "0";
  writeSeries(fields, {0, 2, 4});
  EXPECT_NO_THROW(static_cast<void>(loadVolume(folder_.path())));
  fields.slope = "1e38";
  writeSeries(fields, {0, 2, 4});
  refuses("53 of its 60 voxels are beyond the range of a float, 3.4e38, the first at index (0, 0, 0)");
  const Volume volume = loadVolume(folder_.path() + "?nan=7");
  EXPECT_EQ(volume.value({0, 0, 0}), 7);
  EXPECT_EQ(volume.value({0, 2, 1}), 0);  // the tenth of the middle slice
  EXPECT_THAT(volume.facts().remark, testing::HasSubstr("53 of 60 voxels are beyond the range of a float"));
}

TEST_F(Dicom, RefusesAnEmptySlice) {
  writeSeries({}, {0, 2, 4});
  writeFile(folder_.file("s2.dcm"), "");
  refuses("slice s2.dcm is empty: a file of 0 bytes");
}

TEST_F(Dicom, RefusesOneSliceAndFoldersWithout) {
  refuses("no DICOM slices");
  writeSeries({}, {0});
  refuses("one slice");
  expectLoadRefusal(folder_.file("s1.dcm"), "give the folder");
}

// The header tells the size, so memory is refused before the pixels' meaning is looked at.
TEST_F(Dicom, CountsMemoryBeforeItReadsTables) {
  DicomFields fields;
  fields.slope = "two";
  writeSeries(fields, {0, 2, 4});
  refuses("RescaleSlope");
  expectRefusal([&] { static_cast<void>(loadVolume(folder_.path(), 100)); }, folder_.path(), "GiB",
                Error::Code::kOutOfMemory);
}

TEST_F(Dicom, RefusesMoreThanTheBudget) {
  writeSeries({}, {0, 2, 4});
  expectRefusal([&] { static_cast<void>(loadVolume(folder_.path(), 100)); }, folder_.path(), "GiB",
                Error::Code::kOutOfMemory);
}

}  // namespace dicom_test
}  // namespace palpate
