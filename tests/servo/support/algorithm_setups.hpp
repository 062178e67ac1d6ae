// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/algorithm_setups.hpp: what each algorithm of the registry needs to feel a test's volume.
//
// Tests that run over the whole registry make their algorithms here. An algorithm that needs more than parameters (a
// transfer function, a mesh of the isosurface) gets it in setupFor().
#pragma once

#include "servo/algorithms/registry.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "support/analytic_volume.hpp"
#include "support/isosurface_mesh.hpp"

namespace palpate {

// `contrast`: how far the volume's densities rise above the isovalue.
inline AlgorithmSetup setupFor(std::string_view name, const AlgorithmParameters& parameters,
                               const AnalyticVolume& volume, double contrast) {
  AlgorithmSetup setup;
  setup.parameters = parameters;
  setup.scale = {contrast, volume.lattice.smallestSpacing()};
  if (algorithmEntry(name).needs.isosurface_mesh) {
    setup.isosurface = std::make_shared<const MeshObject>(IsosurfaceMesher(volume, parameters.isovalue).mesh());
  }
  return setup;
}

inline std::unique_ptr<Algorithm> makeFor(std::string_view name, const AlgorithmParameters& parameters,
                                          const AnalyticVolume& volume, double contrast) {
  return makeAlgorithm(name, setupFor(name, parameters, volume, contrast));
}

}  // namespace palpate
