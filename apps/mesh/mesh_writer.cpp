// SPDX-License-Identifier: Apache-2.0
// STL: 80 bytes, a count, 50 bytes a triangle. PLY: http://paulbourke.net/dataformats/ply. OBJ: vertices count from 1.
#include "apps/mesh/mesh_writer.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

bool endsWith(const std::string& name, std::string_view suffix) {
  if (name.size() < suffix.size()) return false;
  return std::equal(suffix.begin(), suffix.end(), name.end() - static_cast<std::ptrdiff_t>(suffix.size()),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

// Gathers small pieces into large ones.
class Pieces {
 public:
  explicit Pieces(const ByteSink& sink) : sink_(sink) {}
  void text(std::string_view bytes) {
    buffer_ += bytes;
    if (buffer_.size() > 60'000) flush();
  }
  template <class T>
  void number(T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    text({bytes, sizeof value});
  }
  void point(const Eigen::Vector3f& p) {
    for (int axis = 0; axis < 3; ++axis) number(p[axis]);
  }
  void flush() {
    sink_(buffer_);
    buffer_.clear();
  }

 private:
  const ByteSink& sink_;
  std::string buffer_;
};

void writeStl(const TriangleMesh& mesh, double scale, Pieces& out) {
  std::string title = "binary STL, written by Palpate";
  title.resize(80, ' ');
  out.text(title);
  out.number(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices_W[t[0]], &b = mesh.vertices_W[t[1]], &c = mesh.vertices_W[t[2]];
    const Vec3 across = (b - a).cross(c - a);
    const double length = across.norm();
    out.point((length > 0 ? Vec3(across / length) : Vec3(Vec3::Zero())).cast<float>());
    for (const Vec3& corner : {a, b, c}) out.point((corner * scale).cast<float>());
    out.number(std::uint16_t{0});
  }
}

void writePly(const TriangleMesh& mesh, double scale, Pieces& out) {
  out.text(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment written by Palpate\nelement vertex {}\n"
                  "property float x\nproperty float y\nproperty float z\nelement face {}\n"
                  "property list uchar int vertex_indices\nend_header\n",
                  mesh.vertices_W.size(), mesh.triangles.size()));
  for (const Vec3& v : mesh.vertices_W) out.point((v * scale).cast<float>());
  for (const auto& t : mesh.triangles) {
    out.number(std::uint8_t{3});
    for (const std::uint32_t corner : t) out.number(corner);
  }
}

void writeObj(const TriangleMesh& mesh, double scale, Pieces& out) {
  out.text("# written by Palpate\n");
  for (const Vec3& v : mesh.vertices_W) {
    const Eigen::Vector3f p = (v * scale).cast<float>();
    out.text(fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z()));
  }
  for (const auto& t : mesh.triangles) out.text(fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
}

}  // namespace

bool isMeshFileName(const std::string& name) {
  return endsWith(name, ".stl") || endsWith(name, ".obj") || endsWith(name, ".ply");
}

std::size_t collapsedTriangles(const TriangleMesh& mesh, double units_per_metre) {
  const auto at = [&](std::uint32_t vertex) -> Vec3 {
    return (mesh.vertices_W[vertex] * units_per_metre).cast<float>().cast<double>();
  };
  const auto collapses = [&](const auto& t) {
    // Of floats, the cross product is off by some 1e-15 of the edges' lengths; corners that a float tells apart lie
    // farther from a line than that, but for slivers a million times as long as wide.
    const Vec3 ab = at(t[1]) - at(t[0]), ac = at(t[2]) - at(t[0]);
    return ab.cross(ac).norm() <= 1e-12 * ab.norm() * ac.norm();
  };
  return static_cast<std::size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), collapses));
}

void writeMesh(const TriangleMesh& mesh, const std::string& name, double units_per_metre, const ByteSink& sink) {
  const auto refuse = [&](const std::string& reason, const std::string& remedy) {
    throw Error(Error::Code::kBadInput, name, reason, remedy);
  };
  if (!isMeshFileName(name)) {
    refuse("its suffix names no format that meshes are written in", fmt::format("use one of {}", kMeshFileSuffixes));
  }
  if (mesh.triangles.empty()) refuse("the mesh has no triangles", "choose another isovalue");
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max() ||
      mesh.vertices_W.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    refuse("the mesh has more triangles than the format can count", "raise --adaptivity");
  }
  Pieces out(sink);
  if (endsWith(name, ".stl")) writeStl(mesh, units_per_metre, out);
  if (endsWith(name, ".ply")) writePly(mesh, units_per_metre, out);
  if (endsWith(name, ".obj")) writeObj(mesh, units_per_metre, out);
  out.flush();
}

}  // namespace palpate
