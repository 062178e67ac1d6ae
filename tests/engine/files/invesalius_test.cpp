// SPDX-License-Identifier: Apache-2.0
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

}  // namespace invesalius_test
}  // namespace palpate
