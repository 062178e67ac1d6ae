// SPDX-License-Identifier: Apache-2.0
// InVesalius projects (.inv3): a tar, usually gzipped, with main.plist (what it is) and matrix.dat (the voxels, C order
// z, y, x). Source of the format: InVesalius 3, invesalius/project.py, Project.SavePlistProject.
//
// InVesalius keeps its slices flipped in y against DICOM: index j runs anterior. It keeps no position, so the world's
// origin is the centre of voxel (0, 0, 0). Archive and property list are read in a child process.
#include <cmath>
#include <cstring>
#include <functional>

#include <fmt/format.h>

#include "base/child_process.hpp"
#include "base/module.hpp"
#include "base/shared_buffer.hpp"
#include "base/units.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/invesalius_archive.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

// Runs `work` in a child process, since libraries read property lists and archives.
std::string inChild(const std::string& name, double raw_bytes, const std::function<std::string()>& work) {
  constexpr double kMostUnpacked = 1032;  // unpacked bytes for each packed byte
  const auto file_bytes = static_cast<double>(fileBytes(name, name));
  ChildLimits limits = limitsForFile(file_bytes, raw_bytes);
  // The whole archive is unpacked, at 1 GiB a second or more. Even a small file may take 4 s.
  limits.cpu_s += std::floor(file_bytes * kMostUnpacked / (1024.0 * (1 << 20)));
  ChildOutcome outcome = runInChild(name, 1, limits, [&](std::size_t) { return work(); });
  if (!outcome.trouble) return std::move(outcome.results[0]);
  if (outcome.trouble->error) throw Error(*outcome.trouble->error);
  refuseProject(name, fmt::format("it cannot be read ({})", outcome.trouble->words));
}

}  // namespace

Volume readInvesalius(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const InvesaliusModule& project_reader = loadModule<InvesaliusModule>();  // not to be loaded after a fork
  InvesaliusProject project;
  const std::string facts_bytes = inChild(name, 0, [&] {
    const InvesaliusProject read = project_reader.readProject(name, wanted.memory_budget_bytes);
    return std::string(reinterpret_cast<const char*>(&read), sizeof read);
  });
  std::memcpy(static_cast<void*>(&project), facts_bytes.data(), sizeof project);
  Lattice lattice;
  lattice.spacing_m = Vec3(project.spacing_mm.data()) * kMetresPerMillimetre;
  lattice.R_WL = Vec3(1, -1, 1).asDiagonal();
  checkLattice(lattice, name);

  const SharedBuffer raw(static_cast<std::size_t>(project.size.cast<long long>().prod()) * byteSize(project.type));
  static_cast<void>(inChild(name, static_cast<double>(raw.bytes().size()), [&] {
    project_reader.readMatrix(name, project, raw.bytes());
    return std::string();
  }));
  VolumeFacts facts;
  facts.source = name;
  facts.instead_of_nan = wanted.instead_of_nan;
  facts.format = "InVesalius";
  facts.value_type = nameOf(project.type);
  facts.orientation = "InVesalius axes: left, anterior, superior";
  RoundedNumbers rounded;
  Volume::BrickSource bricks = rawBricks(raw.bytes(), project.type, project.size, 1, 0, &rounded);
  Volume volume = Volume::fromLayers(project.size, lattice, std::move(facts), [&](int) { return bricks; });
  volume.noteRounding(rounded.of(nameOf(project.type), false));
  return volume;
}

}  // namespace palpate
