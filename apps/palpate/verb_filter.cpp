// SPDX-License-Identifier: Apache-2.0
// palpate filter IN -o OUT --filter CHAIN: a volume through filters into another file.
#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "apps/filter/filter_job.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/filter/filter_spec.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

std::string filterList() {
  std::string text =
      "Filters, a chain of NAME:SIZE[:KEY=VALUE] with blanks between (sizes in voxels, or with mm, um, cm, m):\n";
  for (const FilterWords& words : filterTable())
    text += fmt::format("  {}:{}  {}\n      {}\n", words.name, words.size, words.what, words.keys);
  return text +
         "Example: palpate filter scan.nii.gz -o smooth.vdb --filter \"gaussian:0.8mm\"\n"
         "docs/filters.md says what each does, what it costs and when to use it";
}

}  // namespace

void addFilterVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("filter", "write a volume after smoothing it or changing its shape");
  verb->footer(filterList());
  auto request = std::make_shared<FilterRequest>();
  verb->add_option("in", request->in, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option("-o,--out", request->out, "the volume to write: " + volumeFileSuffixes())->required();
  verb->add_option("--filter", request->filter, "chain of filters: \"gaussian:0.8mm\"")->required();
  verb->add_option("--iso", request->isovalue,
                   "where the object begins, for a distance (default: the volume's own) [density]");
  verb->add_option("--gpu", request->gpu, "part of the Vulkan device's name; the best one if not given");
  addVolumeOptions(*verb, request->in);
  verb->callback([request] {
    Progress progress;
    const FilterResult result = filterFile(*request, progress);
    printText(filterWords(*request, result));
  });
}

}  // namespace palpate
