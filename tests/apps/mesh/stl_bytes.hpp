// SPDX-License-Identifier: Apache-2.0
// tests/apps/mesh/stl_bytes.hpp: a mesh as the bytes of a text or binary STL file.
#pragma once

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "base/triangle_mesh.hpp"

namespace palpate {

inline std::string stlText(const TriangleMesh& mesh, const std::string& name = "a b c") {
  std::string text = "solid " + name + "\n";
  for (const auto& triangle : mesh.triangles) {
    text += "  facet normal 0 0 1\n    outer loop\n";
    for (const std::uint32_t corner : triangle) {
      const Vec3& v = mesh.vertices_W[corner];
      text += fmt::format("      vertex {} {} {}\n", v.x(), v.y(), v.z());
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

inline std::string binaryStl(const TriangleMesh& mesh, std::string title = "solid") {
  title.resize(80, ' ');
  const auto add = [&](auto value) { title.append(reinterpret_cast<const char*>(&value), sizeof value); };
  add(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int n = 0; n < 3; ++n) add(0.0F);
    for (const std::uint32_t corner : triangle) {
      for (const double x : mesh.vertices_W[corner]) add(static_cast<float>(x));
    }
    add(std::uint16_t{0});
  }
  return title;
}

}  // namespace palpate
