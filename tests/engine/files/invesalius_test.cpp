// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "engine/files/volume_file.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace invesalius_test {

class Invesalius : public testing::Test {
 protected:
  void refuses(const Members& members, const std::string& reason, Error::Code code = Error::Code::kBadInput) const {
    writeTarGz(path_, members);
    expectLoadRefusal(path_, reason, code);
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a.inv3");
  std::string data_ = bytesOf<std::int16_t>(rampValues(-30));
};

TEST_F(Invesalius, ReadsTheMatrixWithYRunningAnterior) {
  Lattice lattice = plainLattice();
  lattice.R_WL = Vec3(1, -1, 1).asDiagonal();
  const std::pair<std::string, std::string> plist = {"case/main.plist", invesaliusPlist()};
  const std::pair<std::string, std::string> matrix = {"case/matrix.dat", data_};
  const std::pair<std::string, std::string> mask = {"case/mask_0.dat", std::string(100000, 'm')};
  for (const Members& members : {Members{plist, mask, matrix}, Members{mask, matrix, plist}}) {
    writeTarGz(path_, members);
    const Volume volume = loadVolume(path_);
    expectVolume(volume, lattice, rampValues(-30));
    EXPECT_EQ(volume.facts().value_type, "int16");
  }
}

TEST_F(Invesalius, ReadsOtherTypes) {
  writeTarGz(path_, {{"main.plist",
                      invesaliusPlist("<integer>3</integer><integer>4</integer><integer>5</integer>", "float64")},
                     {"matrix.dat", bytesOf<double>(rampValues(0.5))}});
  EXPECT_EQ(loadVolume(path_).toDense(), asFloats(rampValues(0.5)));
}

TEST_F(Invesalius, RefusesWhatIsMissing) {
  refuses({{"matrix.dat", data_}}, "no main.plist");
  refuses({{"main.plist", invesaliusPlist()}}, "no matrix.dat");
  refuses({{"main.plist", "<plist><dict></dict></plist>"}, {"matrix.dat", data_}}, "no matrix");
  refuses({{"main.plist", "nothing"}, {"matrix.dat", data_}}, "cannot be read");
  refuses({{"main.plist", ""}, {"matrix.dat", data_}}, "0 bytes");
}

TEST_F(Invesalius, RefusesBadNumbers) {
  const std::string shape = "<integer>3</integer><integer>4</integer><integer>5</integer>";
  refuses({{"main.plist", invesaliusPlist(shape, "text")}, {"matrix.dat", data_}}, "\"text\"");
  refuses({{"main.plist", invesaliusPlist("<integer>3</integer>")}, {"matrix.dat", data_}}, "three numbers");
  refuses({{"main.plist", invesaliusPlist("<integer>3</integer><string>4</string><integer>5</integer>")},
           {"matrix.dat", data_}},
          "no number");
  for (const std::string spacing : {"0.0", "-1.0"}) {
    refuses(
        {{"main.plist", invesaliusPlist(shape, "int16", "<real>1</real><real>" + spacing + "</real><real>1</real>")},
         {"matrix.dat", data_}},
        "not positive");
  }
  refuses({{"main.plist", invesaliusPlist()}, {"matrix.dat", data_.substr(2)}}, "118 bytes");
}

TEST_F(Invesalius, RefusesMoreThanMemoryBeforeReadingIt) {
  refuses(
      {{"main.plist", invesaliusPlist("<integer>100000</integer><integer>100000</integer><integer>100000</integer>")},
       {"matrix.dat", data_}},
      "GiB", Error::Code::kOutOfMemory);
}

// Bytes in which deflate finds nothing to pack: it stores them as they are.
std::string noise(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

// The archive is read 64 KiB at a time. The voxels here take 17 such pieces, and the mask behind them 4 more, which
// nobody needs for a voxel: what is wrong there is seen by reading on to the end, and in no other way.
class LongInvesalius : public Invesalius {
 protected:
  LongInvesalius() {
    const std::string shape = "<integer>72</integer><integer>80</integer><integer>96</integer>";
    writeTarGz(path_, {{"main.plist", invesaliusPlist(shape)}, {"matrix.dat", matrix_}, {"mask_0.dat", mask_}});
    whole_ = readFile(path_);
  }
  [[nodiscard]] std::vector<float> voxels() const {
    std::vector<std::int16_t> values(matrix_.size() / sizeof(std::int16_t));
    std::memcpy(values.data(), matrix_.data(), matrix_.size());
    return {values.begin(), values.end()};
  }
  void refusesBytes(const std::string& bytes) const {
    writeFile(path_, bytes);
    expectLoadRefusal(path_, "cannot be read");
  }
  void refusesAChangeAt(std::size_t at) const {
    std::string damaged = whole_;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    refusesBytes(damaged);
  }

  const Vec3i size_ = {96, 80, 72};
  const std::string matrix_ = noise(std::size_t{2} * 96 * 80 * 72, 3);  // int16
  const std::string mask_ = noise(300'000, 5);
  std::string whole_;
};

TEST_F(LongInvesalius, GivesEveryVoxel) {
  ASSERT_GT(matrix_.size(), std::size_t{1} << 20);
  ASSERT_GT(whole_.size(), matrix_.size() + mask_.size());  // so nothing was packed
  const Volume volume = loadVolume(path_);
  EXPECT_EQ(volume.size(), size_);
  EXPECT_EQ(volume.toDense(), voxels());
}

// A gzip member ends with the CRC-32 of what it holds and with its length, four bytes each.
TEST_F(LongInvesalius, RefusesAWrongChecksum) {
  refusesAChangeAt(whole_.size() - 8);
}

TEST_F(LongInvesalius, RefusesALostEnd) {
  refusesBytes(whole_.substr(0, whole_.size() - 4));
}

// The stream unpacks all the same; only its checksum tells.
TEST_F(LongInvesalius, RefusesAChangedByteOfAnyMember) {
  for (const std::string* member : {&matrix_, &mask_}) {
    const std::size_t at = whole_.find(member->substr(100'000, 16));
    ASSERT_NE(at, std::string::npos);  // stored as it is
    refusesAChangeAt(at);
  }
}

// Some tar programs fill up the archive behind its end. That is part of the file too.
TEST_F(LongInvesalius, RefusesAWrongChecksumOfThePadding) {
  writeGzip(folder_.file("zeros"), std::string(300'000, '\0'));
  whole_ += readFile(folder_.file("zeros"));
  writeFile(path_, whole_);
  EXPECT_EQ(loadVolume(path_).toDense(), voxels());
  refusesAChangeAt(whole_.size() - 8);
}

}  // namespace invesalius_test
}  // namespace palpate
