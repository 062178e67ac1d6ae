// SPDX-License-Identifier: Apache-2.0
// A volume that cannot be used: one line that names it, the reason and the remedy; its exit status; no output folder.
#include <functional>
#include <limits>
#include <random>

#include "nrrd_bytes.hpp"
#include "program_test.hpp"

namespace palpate {
namespace refused_volume_test {

namespace fs = std::filesystem;

struct BadVolume {
  const char* name;
  std::function<std::string(const fs::path&)> make;  // makes it in a folder and says what to give to the program
  const char* reason;
  int status;
  Words flags = {};
};

std::string save(const fs::path& folder, const char* name, const std::string& bytes) {
  std::ofstream(folder / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return name;
}

std::string noise(std::size_t count) {
  std::mt19937 random(7);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

auto changed(const std::function<void(NrrdBytes&)>& change) {
  return [change](const fs::path& folder) {
    NrrdBytes nrrd = ballNrrd();
    change(nrrd);
    return save(folder, "scan.nrrd", nrrd.bytes());
  };
}

auto named(const char* name, const std::string& bytes) {
  return [=](const fs::path& folder) { return save(folder, name, bytes); };
}

auto given(const char* name) {
  return [name](const fs::path&) { return std::string(name); };
}

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

std::vector<BadVolume> badVolumes() {
  const std::string good = ballNrrd().bytes();
  return {
      {"Missing", given("nowhere.nrrd"), "no such file", 3},
      {"MissingFolder", given("nowhere/scan.nrrd"), "no such file", 3},
      {"EndlessName", [](const fs::path&) { return std::string(300, 'a'); }, "name too long", 4},
      {"Truncated", named("scan.nrrd", good.substr(0, good.size() / 2)), "", 2},
      {"TruncatedInHeader", named("scan.nrrd", good.substr(0, 40)), "", 2},
      {"NoiseAsNrrd", named("scan.nrrd", noise(5000)), "", 2},
      {"NoiseAsNifti", named("scan.nii.gz", noise(5000)), "", 2},
      {"NoiseAsMeta", named("scan.mha", noise(5000)), "", 2},
      {"NoiseAsVdb", named("scan.vdb", noise(5000)), "", 2},
      {"NoiseAsInvesalius", named("scan.inv3", noise(5000)), "", 2},
      {"WrongSuffix", named("scan.nii", good), "NRRD data", 2},
      {"UnknownSuffix", named("scan.txt", "hello"), "suffix", 2},
      {"EmptyFile", named("scan.nrrd", ""), "", 2},
      {"EmptyFolder",
       [](const fs::path& f) {
         fs::create_directory(f / "series");
         return std::string("series");
       },
       "", 2},
      {"NoVoxels", changed([](NrrdBytes& n) {
         n.sizes = "0 0 0";
         n.values.clear();
       }),
       "0 0 0", 2},
      {"Constant", changed([](NrrdBytes& n) { n.values.assign(4096, 5); }), "every voxel is 5", 2},
      {"ConstantWithIsovalue",
       changed([](NrrdBytes& n) { n.values.assign(4096, 5); }),
       "every voxel is 5",
       2,
       {"--iso", "5"}},
      {"OneByOne", changed([](NrrdBytes& n) { n.sizes = "1 1 4096"; }), "1 x 1 x 4096", 2},
      {"Nan", changed([](NrrdBytes& n) { n.values[77] = kNan; }), "", 2},
      {"Infinity", changed([](NrrdBytes& n) { n.values[77] = kInfinity; }), "", 2},
      {"MinusInfinity", changed([](NrrdBytes& n) { n.values[77] = -kInfinity; }), "", 2},
      {"ZeroSpacing", changed([](NrrdBytes& n) { n.spacings = "1 0 1"; }), "spacing", 2},
      {"NegativeSpacing", changed([](NrrdBytes& n) { n.spacings = "1 1 -1"; }), "spacing", 2},
      {"LargerThanMemory", changed([](NrrdBytes& n) { n.sizes = "16000 16000 16000"; }), "GiB", 5},
      {"IsovalueAboveRange", named("scan.nrrd", good), "isovalue 501 is outside", 2, {"--iso", "501"}},
      {"IsovalueBelowRange", named("scan.nrrd", good), "isovalue -9000 is outside", 2, {"--iso", "-9000"}},
      {"UnknownPhantom", given("phantom:pear"), "no phantom \"pear\"", 2},
      {"UnknownPhantomKey", given("phantom:sphere?radius=3"), "no key \"radius\"", 2},
      {"PhantomWithoutSpacing", given("phantom:sphere?size=16&spacing=0mm"), "not positive", 2},
      {"PhantomLargerThanMemory", given("phantom:sphere?size=2040&noise=0.1"), "GiB", 5},
      {"PhantomWithTooManyBricks", given("phantom:sphere?size=16000"), "16777216 bricks", 5},
      {"PhantomOneByOne", given("phantom:sphere?size=1x1x64"), "size=1x1x64", 2},
  };
}

class RefusedVolume : public ProgramTest, public testing::WithParamInterface<BadVolume> {};

TEST_P(RefusedVolume, InOneLineAndWithoutAnOutputFolder) {
  const std::string volume = GetParam().make(folder());
  const Outcome outcome = run(quickTouch(volume, GetParam().flags));
  expectRefusal(outcome, volume, GetParam().reason, GetParam().status);
  EXPECT_FALSE(exists("out"));
  EXPECT_EQ(outcome.out, "");
}

INSTANTIATE_TEST_SUITE_P(Each, RefusedVolume, testing::ValuesIn(badVolumes()),
                         [](const auto& volume) { return std::string(volume.param.name); });

// Otherwise the tests above would pass for a reason that is none.
class AcceptedVolume : public ProgramTest {};

TEST_F(AcceptedVolume, IsTheSameFileWithoutTheFault) {
  write("scan.nrrd", ballNrrd().bytes());
  expectSuccess(run(quickTouch("scan.nrrd", {"--iso", "0"})));
  EXPECT_TRUE(exists("out/summary.json"));
}

TEST_F(AcceptedVolume, NameWithALineBreakStaysOneLine) {
  const Outcome outcome = run({"info", "no\nsuch\x1b[2Jfile"});
  expectRefusal(outcome, "no?such?[2Jfile", "no such file", 3);
}

}  // namespace refused_volume_test
}  // namespace palpate
