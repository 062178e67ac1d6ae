// SPDX-License-Identifier: Apache-2.0
#include "servo/meshes/mesh_object.hpp"

#include <limits>

#include "base/module.hpp"
#include "base/triangle_mesh.hpp"
#include "servo/meshes/mesh_tree.hpp"

namespace palpate {
namespace {

constexpr double kMargin_m = 1e-3;  // by which the part of a line that is searched exceeds the box of the mesh

// The point of a triangle nearest to x (Ericson 2005, section 5.1.5).
Vec3 nearestInTriangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

}  // namespace

struct MeshObject::State {
  PreparedMesh prepared;
  Vec3 middle_W = Vec3::Zero();  // origin of the tree's coordinates
  Vec3 half_m = Vec3::Zero();    // of the box around the mesh, with a margin [m]
  [[nodiscard]] std::optional<std::array<double, 2>> near(const Vec3& from_W, const Vec3& way_W) const noexcept;
  std::unique_ptr<MeshTree> tree;

  [[nodiscard]] const Vec3& corner(unsigned triangle, std::size_t i) const {
    return prepared.mesh.vertices_W[prepared.mesh.triangles[triangle][i]];
  }
  void build(const std::string& name);
};

void MeshObject::State::build(const std::string& name) {
  std::vector<Eigen::Vector3f> vertices;
  vertices.reserve(prepared.mesh.vertices_W.size());
  for (const Vec3& vertex_W : prepared.mesh.vertices_W) vertices.push_back((vertex_W - middle_W).cast<float>());
  tree = loadModule<EmbreeModule>().build(vertices, prepared.mesh.triangles, name);
}

MeshObject::MeshObject(TriangleMesh mesh, const std::string& name) : state_(std::make_unique<State>()) {
  state_->prepared = prepareMesh(std::move(mesh), name);
  Vec3 low_W = state_->prepared.mesh.vertices_W.front();
  Vec3 high_W = low_W;
  for (const Vec3& vertex_W : state_->prepared.mesh.vertices_W) {
    low_W = low_W.cwiseMin(vertex_W);
    high_W = high_W.cwiseMax(vertex_W);
  }
  state_->middle_W = 0.5 * (low_W + high_W);
  state_->half_m = 0.5 * (high_W - low_W) + Vec3::Constant(kMargin_m);
  state_->build(name);
}

MeshObject::~MeshObject() = default;

// The shares of a line between which it is near the mesh. Rays are in float and must be finite, but a HIP that a broken
// device reports may be anywhere.
std::optional<std::array<double, 2>> MeshObject::State::near(const Vec3& from_W, const Vec3& way_W) const noexcept {
  double enters = 0;
  double leaves = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(from_W[axis]) || !std::isfinite(way_W[axis])) return std::nullopt;
    const double low = middle_W[axis] - half_m[axis] - from_W[axis];
    const double high = middle_W[axis] + half_m[axis] - from_W[axis];
    if (way_W[axis] == 0) {
      if (low > 0 || high < 0) return std::nullopt;
      continue;
    }
    enters = std::max(enters, std::min(low / way_W[axis], high / way_W[axis]));
    leaves = std::min(leaves, std::max(low / way_W[axis], high / way_W[axis]));
  }
  if (!(enters <= leaves)) return std::nullopt;
  return std::array{enters, leaves};
}

std::optional<ObjectEntry> MeshObject::firstEntry(const Vec3& all_from_W, const Vec3& all_to_W) const noexcept {
  const Vec3 all_way_W = all_to_W - all_from_W;
  const auto near = state_->near(all_from_W, all_way_W);
  if (!near) return std::nullopt;
  const double length = (*near)[1] - (*near)[0];
  const Vec3 from_W = all_from_W + (*near)[0] * all_way_W;
  const FrontFaces fronts{state_->prepared.normals_W, length * all_way_W};
  const std::optional<unsigned> met = state_->tree->firstMet((from_W - state_->middle_W).cast<float>(),
                                                             fronts.way.cast<float>(), solid() ? &fronts : nullptr);
  if (!met) return std::nullopt;
  Vec3 normal_W = state_->prepared.normals_W[*met];
  double approach_m = normal_W.dot(fronts.way);
  if (approach_m > 0) {
    normal_W = -normal_W;
    approach_m = -approach_m;
  }
  if (!(approach_m < 0)) return std::nullopt;
  const double share = std::clamp(normal_W.dot(state_->corner(*met, 0) - from_W) / approach_m, 0.0, 1.0);
  return ObjectEntry{(*near)[0] + share * length, {from_W + share * fronts.way, normal_W}};
}

ObjectPoint MeshObject::nearest(const Vec3& x_W) const noexcept {
  struct Search {
    const State* state;
    Vec3 x_W;
    double best_m2 = std::numeric_limits<double>::infinity();
    double facing_m = 0;
    ObjectPoint best;
  } search{state_.get(), x_W, std::numeric_limits<double>::infinity(), 0, {}};
  const auto visit = [](void* the_search, unsigned triangle) -> std::optional<float> {
    auto& s = *static_cast<Search*>(the_search);
    const auto corner = [&](std::size_t i) -> const Vec3& { return s.state->corner(triangle, i); };
    const Vec3 p_W = nearestInTriangle(s.x_W, corner(0), corner(1), corner(2));
    const double distance_m2 = (s.x_W - p_W).squaredNorm();
    const Vec3& normal_W = s.state->prepared.normals_W[triangle];
    const double facing_m = std::abs(normal_W.dot(s.x_W - p_W));
    constexpr double kSame = 1e-9;  // relative difference of squared distances that counts as a shared edge
    if (distance_m2 > s.best_m2 * (1 + kSame)) return std::nullopt;
    if (distance_m2 >= s.best_m2 * (1 - kSame) && facing_m <= s.facing_m) return std::nullopt;
    s.best_m2 = distance_m2;
    s.facing_m = facing_m;
    s.best = {p_W, normal_W};
    // A little more than the distance, to allow for the rounding of float.
    return static_cast<float>(std::sqrt(distance_m2) * 1.0001 + 1e-6);
  };
  state_->tree->visitNear((x_W - state_->middle_W).cast<float>(), visit, &search);
  if (!solid() && search.best.normal_W.dot(x_W - search.best.p_W) < 0) search.best.normal_W *= -1;
  return search.best;
}

bool MeshObject::solid() const noexcept {
  return state_->prepared.closed;
}

const std::vector<std::string>& MeshObject::notes() const noexcept {
  return state_->prepared.notes;
}

const TriangleMesh& MeshObject::mesh() const noexcept {
  return state_->prepared.mesh;
}

}  // namespace palpate
