// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/god_object.hpp: constraint-based contact with a mesh of the isosurface (Zilles and Salisbury 1995).
//
// The mesh is an object among objects (servo/objects/object_contacts.hpp), which hold the VHIP; all that stands here is
// a volume that is never found. Frames, force convention, thread: algorithm.hpp. The window is not read, so n means
// nothing, and an edit is not felt until the mesh is extracted anew.
// Fall-throughs: the VHIP is kept 1 um in front of the mesh, and ways are searched from 2 um before their beginning. So
// only two kinds of mesh let the tool in: one that is not closed (where a triangle too thin for a plane was left out),
// and one so large that float vertices are off by more than that.
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
