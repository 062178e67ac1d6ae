// SPDX-License-Identifier: Apache-2.0
// A volume with two surfaces is converted, loaded, drilled into, saved and recovered, and how much memory that took at
// most is what the report says.
//
// PALPATE_LARGE: voxels along an edge (256; `./dev large` takes 2048, the largest that there is, 3 % of whose bricks
// have storage then: some minutes, 8 GiB and a free gigabyte on the disk).
#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/files/volume_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "program_test.hpp"

namespace palpate {
namespace large_volume_test {

constexpr double kGiB = 1024.0 * 1024 * 1024;
constexpr double kMostGiB = 8;  // promised of 2048^3 with a few per cent stored, the device's memory included

using LargeVolume = ProgramTest;

double bytesOf(const nlohmann::json& summary, const std::string& what) {
  for (const auto& figure : summary["memory"]) {
    if (figure["name"] == what) return figure["bytes"];
  }
  return -1;
}

TEST_F(LargeVolume, IsEditedSavedAndRecoveredInBoundedMemory) {
  const char* text = std::getenv("PALPATE_LARGE");
  const int edge = text != nullptr ? std::atoi(text) : 256;
  const auto palpate = [&](const Words& words) {
    const Outcome outcome = runPalpate({.arguments = words, .folder = folder(), .timeout_s = 3600});
    expectSuccess(outcome);
    return outcome;
  };
  // The shell's thickness in voxels keeps its surfaces apart at every size.
  static_cast<void>(
      palpate({"convert", fmt::format("phantom:shell?size={}&thickness={}", edge, edge * 60 / 2048), "large.vdb"}));
  static_cast<void>(palpate({"touch", "large.vdb", "--iso", "0", "--edit", "remove:radius=8mm", "--journal", "journal",
                             "--save", "sculpted.vdb", "--clock", "simulated", "--seconds", "5", "--out", "out"}));
  const nlohmann::json summary = nlohmann::json::parse(std::ifstream(file("out/summary.json")));
  EXPECT_GT(summary["edits"]["count"], 1);
  EXPECT_EQ(summary["edits"]["journal_saved"], summary["edits"]["journal_records"]);
  EXPECT_EQ(summary["edits"]["save_version"], summary["edits"]["count"]);

  const double peak_GiB = bytesOf(summary, "process peak") / kGiB;
  EXPECT_LE(peak_GiB, kMostGiB);
  // As much as the device and the CPU say that they hold of it, at least.
  EXPECT_GE(peak_GiB, (bytesOf(summary, "gpu total") + bytesOf(summary, "volume on the CPU")) / kGiB);

  // What was saved is what the journal makes of the volume.
  const std::string content = summary["edits"]["content"];
  EXPECT_THAT(palpate({"recover", "journal", "--out", "recovered.vdb"}).out, testing::HasSubstr("content " + content));
  const Volume sculpted = loadVolume(file("sculpted.vdb").string());
  EXPECT_EQ(fmt::format("{:016x}", contentHash(sculpted)), content);
  const double stored = static_cast<double>(sculpted.storedBricks()) / sculpted.brickCount().cast<double>().prod();
  fmt::print("{0} x {0} x {0} voxels, {1:.2g} % of the bricks stored: {2:.2f} GiB at most\n", edge, 100 * stored,
             peak_GiB);
}

}  // namespace large_volume_test
}  // namespace palpate
