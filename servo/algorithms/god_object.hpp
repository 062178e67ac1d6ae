// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/god_object.hpp: constraint-based contact with a mesh of the isosurface (Zilles and Salisbury 1995).
//
// The mesh is an object among objects (servo/objects/object_contacts.hpp), and these hold the VHIP. So all that this
// file adds is a volume whose plane is never found. Frames, force convention, thread: algorithm.hpp. The window is not
// read. So n means nothing, and an edit is not felt until the mesh is extracted anew.
// Fall-throughs: the VHIP is kept 1 um in front of the mesh, and searches begin 2 um before the start of the motion. So
// only two kinds of mesh let the tool in. One is not closed, where a triangle too thin for a plane was left out. The
// other is so large that float vertices are off by more than that.
#pragma once

#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class NoVolume {
 public:
  static constexpr bool kMayPull = false;
  explicit NoVolume(const AlgorithmParameters&) noexcept {}
  void reset(const Vec3&) noexcept {}
  bool find(const SampleWindow&, const Vec3&, std::uint32_t&) noexcept { return false; }
  [[nodiscard]] ContactPlane plane() const noexcept { return {}; }
};

using GodObject = VhipAlgorithm<NoVolume>;

}  // namespace palpate
