// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/scene_objects.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "apps/mesh/mesh_file.hpp"
#include "apps/scene/object_table.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "base/vec.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/objects/shapes.hpp"

namespace palpate {
namespace {

using Outlines = std::vector<std::vector<Vec3>>;

constexpr int kPoints = 48;              // along a line, so that hidden parts of it can be found
constexpr double kPlaneSquare_m = 0.04;  // side of the square that stands for a plane on the picture
constexpr double kCrease = 0.87;         // cosine of the angle from which an edge of a mesh is drawn, 30 degrees
constexpr std::size_t kMostEdges = 4000;

void addLine(const Vec3& a_W, const Vec3& b_W, Outlines& lines) {
  std::vector<Vec3> line;
  for (int i = 0; i <= kPoints; ++i) line.push_back(a_W + (b_W - a_W) * (static_cast<double>(i) / kPoints));
  lines.push_back(std::move(line));
}

void addCircle(const Vec3& centre_W, double radius_m, int axis, Outlines& lines) {
  std::vector<Vec3> line;
  for (int i = 0; i <= 2 * kPoints; ++i) {
    const double angle = std::numbers::pi * i / kPoints;
    Vec3 p_W = centre_W;
    p_W[(axis + 1) % 3] += radius_m * std::cos(angle);
    p_W[(axis + 2) % 3] += radius_m * std::sin(angle);
    line.push_back(p_W);
  }
  lines.push_back(std::move(line));
}

void addSquare(const ObjectSpec& spec, Outlines& lines) {
  const Vec3 n_W = spec.normal_W.stableNormalized();
  const Vec3 u_W = n_W.unitOrthogonal() * (0.5 * kPlaneSquare_m);
  const Vec3 v_W = n_W.cross(u_W);
  const Vec3 corners[] = {u_W + v_W, v_W - u_W, -u_W - v_W, u_W - v_W};
  for (std::size_t i = 0; i < 4; ++i)
    addLine(spec.position_W + corners[i], spec.position_W + corners[(i + 1) % 4], lines);
}

void addBox(const ObjectSpec& spec, const Mat3& R_WB, Outlines& lines) {
  const auto corner = [&](int i) -> Vec3 {
    const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    return spec.position_W + R_WB * (0.5 * sign.cwiseProduct(spec.size_m));
  };
  for (int i = 0; i < 8; ++i) {
    for (const int step : {1, 2, 4}) {
      if ((i & step) == 0) addLine(corner(i), corner(i + step), lines);
    }
  }
}

// Edges at which the mesh ends or has a crease.
void addCreases(const TriangleMesh& mesh, Outlines& lines) {
  struct Sides {
    int count = 0;
    Vec3 normal_W = Vec3::Zero();
    bool turns = false;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Sides> edges;
  for (const auto& t : mesh.triangles) {
    const Vec3& a_W = mesh.vertices_W[t[0]];
    const Vec3 normal_W = (mesh.vertices_W[t[1]] - a_W).cross(mesh.vertices_W[t[2]] - a_W).normalized();
    for (std::size_t i = 0; i < 3; ++i) {
      Sides& sides = edges[std::minmax(t[i], t[(i + 1) % 3])];
      if (++sides.count > 1) sides.turns = sides.turns || normal_W.dot(sides.normal_W) < kCrease;
      sides.normal_W = normal_W;
    }
  }
  std::size_t drawn = 0;
  for (const auto& [edge, sides] : edges) {
    if (!sides.turns && sides.count > 1) continue;
    if (++drawn > kMostEdges) return;
    addLine(mesh.vertices_W[edge.first], mesh.vertices_W[edge.second], lines);
  }
}

double metresPerUnit(const std::string& unit) {
  if (unit == "m") return 1;
  if (unit == "cm") return 1e-2;
  if (unit == "in") return 25.4e-3;
  return kMetresPerMillimetre;
}

// Whether a file's name holds ":position=" or the like: in --object `file` was then not the last key.
bool holdsKey(const std::string& file) {
  const auto options = objectOptions();
  return std::any_of(options.begin(), options.end(), [&](const ObjectOption& option) {
    return file.find(fmt::format(":{}=", option.word)) != std::string::npos ||
           file.find(fmt::format(":{}=", option.key)) != std::string::npos;
  });
}

TriangleMesh readObjectFile(const std::string& file) {
  try {
    return readMeshFile(file);
  } catch (const Error& error) {
    if (error.code() != Error::Code::kNotFound || !holdsKey(file)) throw;
    throw Error(error.code(), error.input(), error.reason(),
                "all behind 'file=' is the file's name: give the other keys before 'file='");
  }
}

std::shared_ptr<const MeshObject> meshObject(const ObjectSpec& spec, const std::string& name) {
  TriangleMesh mesh = readObjectFile(spec.file);
  const Mat3 R_WF = rotationOf(spec.rotation_deg) * (metresPerUnit(spec.unit) * spec.scale);
  for (Vec3& vertex : mesh.vertices_W) vertex = spec.position_W + R_WF * vertex;
  return std::make_shared<const MeshObject>(std::move(mesh), name);
}

void add(const ObjectSpec& spec, const std::string& name, SceneObjects& scene) {
  const Mat3 R_WB = rotationOf(spec.rotation_deg);
  switch (spec.kind) {
    case ObjectKind::kPlane:
      scene.objects.push_back(std::make_shared<const PlaneObject>(spec.position_W, spec.normal_W, name));
      addSquare(spec, scene.outlines);
      return;
    case ObjectKind::kSphere:
      scene.objects.push_back(std::make_shared<const SphereObject>(spec.position_W, spec.radius_m, name));
      for (int axis = 0; axis < 3; ++axis) addCircle(spec.position_W, spec.radius_m, axis, scene.outlines);
      return;
    case ObjectKind::kBox:
      scene.objects.push_back(std::make_shared<const BoxObject>(spec.position_W, spec.size_m, R_WB, name));
      addBox(spec, R_WB, scene.outlines);
      return;
    case ObjectKind::kMesh:
      const auto mesh = meshObject(spec, name);
      scene.notes.insert(scene.notes.end(), mesh->notes().begin(), mesh->notes().end());
      addCreases(mesh->mesh(), scene.outlines);
      scene.objects.push_back(mesh);
      return;
  }
}

}  // namespace

SceneObjects makeSceneObjects(const std::vector<ObjectSpec>& specs) {
  SceneObjects scene;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const bool is_mesh = specs[i].kind == ObjectKind::kMesh;
    const std::string name =
        is_mesh ? specs[i].file : fmt::format("object {} ({})", i + 1, objectKindName(specs[i].kind));
    add(specs[i], name, scene);
    scene.names.push_back(name);
  }
  return scene;
}

std::vector<std::string> notesOnStart(const SceneObjects& objects, const Vec3& start_W) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < objects.objects.size(); ++i) {
    const ContactObject& object = *objects.objects[i];
    const ObjectPoint nearest = object.nearest(start_W);
    if (!object.solid() || !(nearest.normal_W.dot(nearest.p_W - start_W) > 0)) continue;
    notes.push_back(objects.names[i] +
                    ": the tool starts inside it and does not feel it until it has been outside; move it, or the path");
  }
  return notes;
}

}  // namespace palpate
