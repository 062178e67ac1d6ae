// SPDX-License-Identifier: Apache-2.0
// palpate info FILE: size, spacing, type, range, histogram and suggested isovalues.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/load/stair_words.hpp"
#include "base/atomic_file.hpp"
#include "base/byte_size.hpp"
#include "base/json_text.hpp"
#include "base/units.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

constexpr int kBins = 24;
constexpr int kBarLength = 50;

// Numbers whose zeros have no sign: -0 + 0 is 0.
template <typename Numbers>
Numbers unsignedZeros(const Numbers& numbers) {
  return numbers + Numbers::Zero();
}

// The places where edits and paths may be: the range of voxel centres, in the world frame.
void printPlaces(const Volume& volume) {
  const Vec3 last_L = (volume.size() - Vec3i::Ones()).cast<double>();
  const WorldBox box = worldBoxOf(volume.lattice(), volume.size());
  const Vec3 low_mm = unsignedZeros<Vec3>(box.low_W * kMillimetresPerMetre);
  const Vec3 high_mm = unsignedZeros<Vec3>(box.high_W * kMillimetresPerMetre);
  const Vec3 middle_mm = unsignedZeros<Vec3>(volume.lattice().toWorld(last_L / 2) * kMillimetresPerMetre);
  printResult(
      "  places       x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g} mm; the middle {:.6g},{:.6g},{:.6g}\n",
      low_mm.x(), high_mm.x(), low_mm.y(), high_mm.y(), low_mm.z(), high_mm.z(), middle_mm.x(), middle_mm.y(),
      middle_mm.z());
}

void printFacts(const Volume& volume) {
  const VolumeFacts& facts = volume.facts();
  const Vec3 spacing_mm = volume.lattice().spacing_m * kMillimetresPerMetre;
  const Vec3 origin_mm = unsignedZeros<Vec3>(volume.lattice().origin_W * kMillimetresPerMetre);
  const Vec3 extent_mm = volume.size().cast<double>().cwiseProduct(spacing_mm);
  const Mat3 axes = unsignedZeros<Mat3>(volume.lattice().R_WL);
  printResult("{}\n", facts.source);
  printResult("  format       {} ({})\n", facts.format, facts.value_type);
  if (!facts.part.empty()) printResult("  part         {}\n", facts.part);
  printResult("  size         {} x {} x {} voxels\n", volume.size().x(), volume.size().y(), volume.size().z());
  printResult("  spacing      {:.6g} x {:.6g} x {:.6g} mm\n", spacing_mm.x(), spacing_mm.y(), spacing_mm.z());
  printResult("  extent       {:.4g} x {:.4g} x {:.4g} mm\n", extent_mm.x(), extent_mm.y(), extent_mm.z());
  printResult("  origin       {:.6g}, {:.6g}, {:.6g} mm (LPS)\n", origin_mm.x(), origin_mm.y(), origin_mm.z());
  printPlaces(volume);
  printResult("  axes         i ({:.4g}, {:.4g}, {:.4g})  j ({:.4g}, {:.4g}, {:.4g})  k ({:.4g}, {:.4g}, {:.4g})\n",
              axes(0, 0), axes(1, 0), axes(2, 0), axes(0, 1), axes(1, 1), axes(2, 1), axes(0, 2), axes(1, 2),
              axes(2, 2));
  if (!facts.orientation.empty()) printResult("  orientation  {}\n", facts.orientation);
  if (!facts.remark.empty()) printResult("  note         {}\n", facts.remark);
  if (facts.rounded.count > 0) printResult("  rounded      {}\n", facts.rounded.words());
  if (!facts.rescale_in_words.empty()) {
    printResult("  rescale      density = {}\n", facts.rescale_in_words);
  }
  if (facts.rescale_slope != 1 || facts.rescale_intercept != 0) {
    printResult("  rescale      density = {:g} * stored + {:g}\n", facts.rescale_slope, facts.rescale_intercept);
  }
  if (facts.kept_isovalue) printResult("  surface      at isovalue {:g}, which the file keeps\n", *facts.kept_isovalue);
  printResult("  bricks       {} of {} hold more than one value; {} stored\n", volume.storedBricks(),
              volume.brickCount().prod(), inMiB(volume.storedBytes()));
}

// At the isovalue that is felt without --iso.
void printStairs(const Volume& volume, const VolumeStatistics& statistics) {
  if (statistics.suggestions.empty()) return;
  const double isovalue = statistics.suggestions.front().isovalue;
  const std::string words = stairWords(volume, isovalue, Plan{}, FilterGiven::kAsOption);
  if (!words.empty()) printResult("  few values   {}\n", words);
}

void printHistogram(const Histogram& histogram) {
  const std::uint64_t most = *std::max_element(histogram.counts.begin(), histogram.counts.end());
  printResult("  histogram (length of a bar: logarithm of the voxel count)\n");
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    const std::uint64_t count = histogram.counts[bin];
    const double share = std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most));
    printResult("  {:>12.5g}  {:<{}}  {}\n", histogram.low + static_cast<double>(bin) * histogram.bin_width,
                std::string(static_cast<std::size_t>(std::lround(kBarLength * share)), '#'), kBarLength, count);
  }
}

void printStatistics(const VolumeStatistics& statistics) {
  printResult("  range        {:g} ... {:g}, mean {:.5g}\n", statistics.minimum + 0.0, statistics.maximum + 0.0,
              statistics.mean + 0.0);
  if (statistics.fill_share > 0) {
    printResult(
        "  no data?     {:.3g} % of the voxels hold {:g}, far below all others: "
        "if that marks what was not measured, the\n"
        "               isovalues below and edits take it for a density all the same; "
        "give --iso, or replace it in the file\n",
        100 * statistics.fill_share, statistics.minimum);
  }
  printHistogram(statistics.histogram);
  if (statistics.suggestions.empty()) {
    printResult("  isovalues    none: every voxel holds the same value, so there is no surface\n");
    return;
  }
  printResult("  isovalues worth trying (--iso), the default first\n");
  for (const IsovalueSuggestion& suggestion : statistics.suggestions) {
    printResult("  {:>12g}  {}\n", suggestion.isovalue, suggestion.reason);
  }
}

using Json = nlohmann::ordered_json;

Json threeOf(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// `palpate.info/1`. Lengths and positions in mm, world frame.
Json infoJson(const Volume& volume, const VolumeStatistics& statistics) {
  const VolumeFacts& facts = volume.facts();
  const Lattice& lattice = volume.lattice();
  Json json = {{"schema", "palpate.info/1"},
               {"volume", facts.source},
               {"format", facts.format},
               {"value_type", facts.value_type},
               {"part", facts.part},
               {"size_voxel", {volume.size().x(), volume.size().y(), volume.size().z()}},
               {"spacing_mm", threeOf(lattice.spacing_m * kMillimetresPerMetre)},
               {"origin_mm", threeOf(unsignedZeros<Vec3>(lattice.origin_W * kMillimetresPerMetre))},
               {"axes", Json::array()},
               {"orientation", facts.orientation},
               {"note", facts.remark},
               {"rounded", {{"count", facts.rounded.count}, {"most", facts.rounded.most}, {"of", facts.rounded.of}}},
               {"replaced", facts.replaced},
               {"clamped", facts.clamped},
               {"resampled", facts.resampled},
               {"minimum", statistics.minimum},
               {"maximum", statistics.maximum},
               {"mean", statistics.mean},
               {"isovalues", Json::array()}};
  for (const int axis : {0, 1, 2}) json["axes"].push_back(threeOf(unsignedZeros<Mat3>(lattice.R_WL).col(axis)));
  for (const IsovalueSuggestion& suggestion : statistics.suggestions) json["isovalues"].push_back(suggestion.isovalue);
  return json;
}

struct InfoArguments {
  std::string name;
  std::string json;
};

void sayWhatItIs(const InfoArguments& arguments) {
  std::optional<AtomicFile> file;
  if (!arguments.json.empty()) {
    checkNotInput(arguments.name, arguments.json);
    file.emplace(arguments.json);
  }
  Progress progress;
  progress.stage("loading " + arguments.name);
  const Volume volume = loadVolume(arguments.name);
  progress.done();
  printFacts(volume);
  const VolumeStatistics statistics = statisticsOf(volume, kBins);
  printStairs(volume, statistics);
  printStatistics(statistics);
  if (!file) return;
  file->write(jsonFileText(infoJson(volume, statistics)));
  file->commit();
}

}  // namespace

void addInfoVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("info", "say what a volume is: size, spacing, type, range, histogram, isovalues");
  auto arguments = std::make_shared<InfoArguments>();
  verb->add_option("volume", arguments->name, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option("--json", arguments->json, "write it into this file too")->type_name("FILE")->check(notEmpty);
  addVolumeOptions(*verb, arguments->name);
  verb->callback([arguments] { sayWhatItIs(*arguments); });
}

}  // namespace palpate
