// SPDX-License-Identifier: Apache-2.0
// apps/edit/stamp_files.hpp: mesh files as stamps, for one volume and brush profile. Files that were used last are
// kept, so that a script may stamp the same mesh a thousand times. Thread: one.
#pragma once

#include <list>
#include <string>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"

namespace palpate {

class StampFiles {
 public:
  StampFiles(const Lattice& lattice, const BrushProfile& profile) : lattice_(lattice), profile_(profile) {}

  // Sampled at the volume's smallest spacing, coarser where that would take more than kMaxMeshVoxels along an axis; as
  // deep as the ramp to `object` [density] or to the background needs.
  // Throws Error: what readMeshFile() and prepareMesh() refuse; kBadInput for a mesh that is not closed.
  [[nodiscard]] std::shared_ptr<const Stamp> stampOf(const std::string& file, double metres_per_unit, double object);

 private:
  struct Kept {
    std::string file;
    double metres_per_unit;
    double depth_m;
    std::shared_ptr<const Stamp> stamp;
  };
  [[nodiscard]] std::shared_ptr<const Stamp> read(const std::string& file, double metres_per_unit,
                                                  double depth_m) const;
  void forget();

  Lattice lattice_;
  BrushProfile profile_;
  std::list<Kept> kept_;  // the last used first
};

}  // namespace palpate
