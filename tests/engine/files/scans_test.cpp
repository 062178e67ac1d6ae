// SPDX-License-Identifier: Apache-2.0
// The real scans in the folder that PALPATE_DATA names (docs: DATA.md there); skipped where it is not set.
#include <cstdlib>

#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/engine/files/files.hpp"

namespace palpate {
namespace scans_test {

struct Scan {
  std::string file;
  Vec3i size;
  Vec3 spacing_mm;
  float minimum;
  float maximum;
  std::string value_type;
};

class Scans : public testing::TestWithParam<Scan> {};

TEST_P(Scans, HaveTheirSizeSpacingAndRange) {
  const char* folder = std::getenv("PALPATE_DATA");
  if (folder == nullptr) GTEST_SKIP() << "set PALPATE_DATA to the folder of the scans";
  const Scan& scan = GetParam();
  const std::string path = std::string(folder) + "/" + scan.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Volume volume = loadVolume(path);
  EXPECT_EQ(volume.size(), scan.size);
  // The NIfTI header holds floats, DATA.md six digits.
  EXPECT_LE((volume.lattice().spacing_m * 1e3 - scan.spacing_mm).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(volume.minimum(), scan.minimum);
  EXPECT_EQ(volume.maximum(), scan.maximum);
  EXPECT_EQ(volume.facts().value_type, scan.value_type);
  EXPECT_NO_THROW(checkIsovalue(volume, defaultIsovalue(volume)));
}

INSTANTIATE_TEST_SUITE_P(
    Data, Scans,
    testing::Values(Scan{"ct_head_invesalius.nrrd", {256, 256, 108}, {0.957031, 0.957031, 1.5}, -1024, 2986, "int16"},
                    Scan{"mri_head_ch2.nii.gz", {181, 217, 181}, {1, 1, 1}, 0, 254, "uint8"},
                    Scan{"ct_chest_totalseg.nii.gz", {120, 126, 164}, {1.5, 1.5, 1.5}, -1078, 3343, "int16"},
                    Scan{"ct_chest_lidc2_u8.nrrd", {256, 256, 133}, {1.40625, 1.40625, 2.5}, 0, 255, "uint8"},
                    Scan{"microct_fiberform.nrrd", {100, 100, 100}, {0.0013, 0.0013, 0.0013}, 0, 255, "uint8"},
                    Scan{"mri_head_brainsmall.nrrd", {128, 128, 84}, {1, 1, 1}, 0, 202, "uint8"},
                    Scan{"ct_head_headsq.nrrd", {64, 64, 93}, {3.2, 3.2, 1.5}, 0, 3926, "int16"}),
    [](const auto& scan) { return scan.param.file.substr(0, scan.param.file.find('.')); });

}  // namespace scans_test
}  // namespace palpate
