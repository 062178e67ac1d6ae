// SPDX-License-Identifier: Apache-2.0
#include "servo/meshes/mesh_object.hpp"

#include <limits>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/triangle_mesh.hpp"

namespace palpate {
namespace {

constexpr double kMargin_m = 1e-3;  // by which the part of a line that is searched exceeds the box of the mesh

void check(RTCDevice device, const std::string& name) {
  if (device != nullptr && rtcGetDeviceError(device) == RTC_ERROR_NONE) return;
  throw Error(Error::Code::kOutOfMemory, name, "Embree could not build the mesh's search tree",
              "free memory or give a mesh with fewer triangles");
}

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

struct MeshObject::Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};

struct MeshObject::State {
  template <class Handle>
  using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

  PreparedMesh prepared;
  Vec3 middle_W = Vec3::Zero();  // origin of Embree's coordinates
  Vec3 half_m = Vec3::Zero();    // of the box around the mesh, with a margin [m]
  [[nodiscard]] std::optional<std::array<double, 2>> near(const Vec3& from_W, const Vec3& way_W) const noexcept;
  Owned<RTCDevice> device;
  Owned<RTCScene> scene;

  [[nodiscard]] const Vec3& corner(unsigned triangle, std::size_t i) const {
    return prepared.mesh.vertices_W[prepared.mesh.triangles[triangle][i]];
  }
  void build(const std::string& name);
};

namespace {

// What Embree hands to the filter: its own context first, then ours.
struct RayQuery {
  RTCIntersectContext context;
  const std::vector<Vec3>* normals_W;
  Vec3 way_W;
};

// Ignores back faces: a line leaves the mesh through them.
void passBackFaces(const RTCFilterFunctionNArguments* args) {
  const auto* query = reinterpret_cast<const RayQuery*>(args->context);
  const unsigned triangle = RTCHitN_primID(args->hit, args->N, 0);
  if (!((*query->normals_W)[triangle].dot(query->way_W) < 0)) args->valid[0] = 0;
}

}  // namespace

void MeshObject::State::build(const std::string& name) {
  const TriangleMesh& mesh = prepared.mesh;
  // One thread, the caller's: the tree of a mesh takes milliseconds, and a servo's machine needs no idle workers.
  device.reset(rtcNewDevice("threads=1"));
  check(device.get(), name);
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  const std::unique_ptr<std::remove_pointer_t<RTCGeometry>, Release> geometry(
      rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices_W.size()));
  auto* triangles = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  check(vertices != nullptr && triangles != nullptr ? device.get() : nullptr, name);
  for (const Vec3& vertex_W : mesh.vertices_W) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(vertex_W[axis] - middle_W[axis]);
  }
  for (const auto& triangle : mesh.triangles) triangles = std::copy(triangle.begin(), triangle.end(), triangles);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene.get(), geometry.get());
  rtcCommitScene(scene.get());
  check(device.get(), name);
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
  RayQuery query{{}, &state_->prepared.normals_W, length * all_way_W};
  rtcInitIntersectContext(&query.context);
  if (solid()) query.context.filter = passBackFaces;
  const Eigen::Vector3f from = (from_W - state_->middle_W).cast<float>();
  const Eigen::Vector3f way = query.way_W.cast<float>();
  RTCRayHit ray{};
  ray.ray.org_x = from.x();
  ray.ray.org_y = from.y();
  ray.ray.org_z = from.z();
  ray.ray.dir_x = way.x();
  ray.ray.dir_y = way.y();
  ray.ray.dir_z = way.z();
  ray.ray.tnear = 0;
  ray.ray.tfar = 1;
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene.get(), &query.context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  Vec3 normal_W = state_->prepared.normals_W[ray.hit.primID];
  double approach_m = normal_W.dot(query.way_W);
  if (approach_m > 0) {
    normal_W = -normal_W;
    approach_m = -approach_m;
  }
  if (!(approach_m < 0)) return std::nullopt;
  const double share = std::clamp(normal_W.dot(state_->corner(ray.hit.primID, 0) - from_W) / approach_m, 0.0, 1.0);
  return ObjectEntry{(*near)[0] + share * length, {from_W + share * query.way_W, normal_W}};
}

ObjectPoint MeshObject::nearest(const Vec3& x_W) const noexcept {
  struct Search {
    const State* state;
    Vec3 x_W;
    double best_m2 = std::numeric_limits<double>::infinity();
    double facing_m = 0;
    ObjectPoint best;
  } search{state_.get(), x_W, std::numeric_limits<double>::infinity(), 0, {}};
  const auto visit = [](RTCPointQueryFunctionArguments* args) {
    auto& s = *static_cast<Search*>(args->userPtr);
    const auto corner = [&](std::size_t i) -> const Vec3& { return s.state->corner(args->primID, i); };
    const Vec3 p_W = nearestInTriangle(s.x_W, corner(0), corner(1), corner(2));
    const double distance_m2 = (s.x_W - p_W).squaredNorm();
    const Vec3& normal_W = s.state->prepared.normals_W[args->primID];
    const double facing_m = std::abs(normal_W.dot(s.x_W - p_W));
    constexpr double kSame = 1e-9;  // relative difference of squared distances that counts as a shared edge
    if (distance_m2 > s.best_m2 * (1 + kSame)) return false;
    if (distance_m2 >= s.best_m2 * (1 - kSame) && facing_m <= s.facing_m) return false;
    s.best_m2 = distance_m2;
    s.facing_m = facing_m;
    s.best = {p_W, normal_W};
    // A little more than the distance, to allow for the rounding of float.
    args->query->radius = static_cast<float>(std::sqrt(distance_m2) * 1.0001 + 1e-6);
    return true;
  };
  const Eigen::Vector3f x = (x_W - state_->middle_W).cast<float>();
  RTCPointQuery query{x.x(), x.y(), x.z(), 0, std::numeric_limits<float>::infinity()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(state_->scene.get(), &query, &context, visit, &search);
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
