// SPDX-License-Identifier: Apache-2.0
// palpate convert IN OUT: a volume in another format, or its isosurface as a mesh.
#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "apps/convert/convert_job.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "engine/files/volume_file.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {

void addConvertVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("convert", "write a volume in another format, or its isosurface as a mesh");
  auto request = std::make_shared<ConvertRequest>();
  auto unit = std::make_shared<std::string>();
  verb->add_option("in", request->in, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option(
          "out", request->out,
          fmt::format("the volume: {}; a closed mesh of its isosurface: {}", volumeFileSuffixes(), kMeshFileSuffixes))
      ->required();
  verb->add_option("--iso", request->isovalue,
                   "isovalue of the mesh [density]; as `palpate touch` chooses it if not given");
  verb->add_option(
      "--adaptivity", request->adaptivity,
      "0 to 1: a smaller mesh: above 0 it does not follow bends within a voxel, and has larger triangles where "
      "it is nearly flat (default 0)");
  verb->add_option("--unit", *unit, "of lengths in meshes and .vdb: mm or m (default mm; m for a level set's .vdb)")
      ->check(CLI::IsMember({"mm", "m"}));
  verb->add_flag("--exact", request->exact,
                 "refuse a volume if any of its numbers is not kept: one that no 32-bit float holds, NaN, padding");
  addVolumeOptions(*verb, request->in);
  verb->callback([request, unit] {
    if (!unit->empty()) request->unit = *unit == "m" ? LengthUnit::kMetre : LengthUnit::kMillimetre;
    Progress progress;
    const ConvertResult result = convert(*request, progress);
    printResult("{}\n", convertWords(*request, result));
  });
}

}  // namespace palpate
