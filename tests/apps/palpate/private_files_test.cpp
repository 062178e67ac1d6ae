// SPDX-License-Identifier: Apache-2.0
// Whatever holds a patient's densities may be read by its owner alone, under the usual umask: volumes, meshes, journals
// and their folders. Reports and tables are files like any other. A file that somebody has opened to others stays so.
#include <sys/stat.h>

#include "program_test.hpp"

namespace palpate {
namespace private_files_test {

namespace fs = std::filesystem;

class PrivateFiles : public ProgramTest {
 protected:
  PrivateFiles() : before_(umask(022)) {}
  ~PrivateFiles() override { umask(before_); }

  [[nodiscard]] unsigned rightsOf(const fs::path& name) const {
    return static_cast<unsigned>(fs::status(folder() / name).permissions());
  }

 private:
  mode_t before_;
};

TEST_F(PrivateFiles, DensitiesAreTheirOwnersAlone) {
  expectSuccess(run(quickTouch("phantom:sphere?size=32", {"--edit", "remove:radius=2mm", "--approach", "1", "--journal",
                                                          "deep/journal", "--save", "sculpted.nrrd"})));
  expectSuccess(run({"recover", "deep/journal", "--out", "back.vdb"}));
  expectSuccess(
      run({"edit", "sculpted.nrrd", "edited.vdb", "--journal", "kept", "--do", "remove:radius=3mm:at=0,0,0"}));
  expectSuccess(run({"filter", "edited.vdb", "--out", "smooth.vdb", "--filter", "gaussian:1"}));
  expectSuccess(run({"gradient", "edited.vdb", "--out", "gradient.vdb"}));
  expectSuccess(run({"convert", "edited.vdb", "mesh.stl"}));
  for (const char* name : {"sculpted.nrrd", "back.vdb", "edited.vdb", "smooth.vdb", "gradient.vdb", "mesh.stl",
                           "deep/journal/journal.palpate", "kept/journal.palpate"})
    EXPECT_EQ(rightsOf(name), 0600U) << name;
  for (const char* name : {"deep", "deep/journal", "kept"}) EXPECT_EQ(rightsOf(name), 0700U) << name;
  EXPECT_EQ(rightsOf("out/summary.json"), 0644U);
}

TEST_F(PrivateFiles, WhatWasOpenedToOthersStaysSo) {
  fs::create_directory(file("shared"));
  fs::permissions(file("shared"), static_cast<fs::perms>(0755));
  for (int i = 0; i < 2; ++i) {
    expectSuccess(run({"convert", "phantom:sphere?size=16", "shared/a.nrrd"}));
    EXPECT_EQ(rightsOf("shared/a.nrrd"), i == 0 ? 0600U : 0664U);
    fs::permissions(file("shared/a.nrrd"), static_cast<fs::perms>(0664));
  }
  EXPECT_EQ(rightsOf("shared"), 0755U);
  expectSuccess(run(quickTouch("phantom:sphere?size=16")));
  fs::permissions(file("out/summary.json"), static_cast<fs::perms>(0600));
  expectSuccess(run(quickTouch("phantom:sphere?size=16")));
  EXPECT_EQ(rightsOf("out/summary.json"), 0600U);
}

}  // namespace private_files_test
}  // namespace palpate
