// SPDX-License-Identifier: Apache-2.0
// apps/edit/stamp_files.hpp: makes stamps from mesh files, for one volume and brush profile. Recently used stamps are
// kept, so that a script can stamp the same mesh many times. Thread: one.
#pragma once

#include <list>
#include <string>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/edit/edit_text.hpp"

namespace palpate {

class StampFiles {
 public:
  StampFiles(const Lattice& lattice, const BrushProfile& profile) : lattice_(lattice), profile_(profile) {}

  // The stamp holds the distance from the mesh at the volume's smallest spacing, or coarser where that would need more
  // than kMaxMeshVoxels along an axis. Inside, it reaches as deep as the ramp (rampDepth() for `object` [density]).
  // Throws as readMeshFile() and prepareMesh() do, and Error(kBadInput) for a mesh that is not closed.
  [[nodiscard]] std::shared_ptr<const Stamp> stampOf(const std::string& file, double metres_per_unit, double object);
  // Of an edit that was read from text, whose mesh_file is not empty.
  [[nodiscard]] std::shared_ptr<const Stamp> stampOf(const EditText& edit);

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
  std::list<Kept> kept_;  // most recently used first
};

}  // namespace palpate
