// SPDX-License-Identifier: Apache-2.0
// The module "embree": mesh_tree.hpp on Embree, in its robust mode. rtcIntersect1 and rtcPointQuery use no heap, lock
// or system call (tests/servo/objects proves it).
#include <algorithm>
#include <limits>

#include <embree3/rtcore.h>

#include "base/error.hpp"
#include "servo/meshes/mesh_tree.hpp"

namespace palpate {
namespace {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};

template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

void check(RTCDevice device, const std::string& name) {
  if (device != nullptr && rtcGetDeviceError(device) == RTC_ERROR_NONE) return;
  throw Error(Error::Code::kOutOfMemory, name, "Embree could not build the mesh's search tree",
              "free memory or give a mesh with fewer triangles");
}

// What Embree hands to the filter: its own context first, then ours.
struct RayQuery {
  RTCIntersectContext context;
  const FrontFaces* only;
};

// Ignores back faces: a line leaves the mesh through them.
void passBackFaces(const RTCFilterFunctionNArguments* args) {
  const FrontFaces& only = *reinterpret_cast<const RayQuery*>(args->context)->only;
  if (!(only.normals[RTCHitN_primID(args->hit, args->N, 0)].dot(only.way) < 0)) args->valid[0] = 0;
}

class EmbreeTree final : public MeshTree {
 public:
  // One thread, the caller's: the tree of a mesh takes milliseconds, and a servo's machine needs no idle workers.
  EmbreeTree(std::span<const Eigen::Vector3f> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
             const std::string& name)
      : device_(rtcNewDevice("threads=1")) {
    check(device_.get(), name);
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(),
                     static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    const Owned<RTCGeometry> geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                                RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
    auto* numbers = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
    check(corners != nullptr && numbers != nullptr ? device_.get() : nullptr, name);
    for (const Eigen::Vector3f& vertex : vertices) corners = std::copy_n(vertex.data(), 3, corners);
    for (const auto& triangle : triangles) numbers = std::copy(triangle.begin(), triangle.end(), numbers);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene_.get(), geometry.get());
    rtcCommitScene(scene_.get());
    check(device_.get(), name);
  }

  [[nodiscard]] std::optional<unsigned> firstMet(const Eigen::Vector3f& from, const Eigen::Vector3f& way,
                                                 const FrontFaces* only) const noexcept override {
    RayQuery query{{}, only};
    rtcInitIntersectContext(&query.context);
    if (only != nullptr) query.context.filter = passBackFaces;
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
    rtcIntersect1(scene_.get(), &query.context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return ray.hit.primID;
  }

  void visitNear(const Eigen::Vector3f& x, Visit visit, void* search) const noexcept override {
    struct Call {
      Visit visit;
      void* search;
    } call{visit, search};
    const auto pass = [](RTCPointQueryFunctionArguments* args) {
      const auto& to = *static_cast<const Call*>(args->userPtr);
      const std::optional<float> radius = to.visit(to.search, args->primID);
      if (radius) args->query->radius = *radius;
      return radius.has_value();
    };
    RTCPointQuery query{x.x(), x.y(), x.z(), 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &query, &context, pass, &call);
  }

 private:
  Owned<RTCDevice> device_;
  Owned<RTCScene> scene_;
};

std::unique_ptr<MeshTree> build(std::span<const Eigen::Vector3f> vertices,
                                std::span<const std::array<std::uint32_t, 3>> triangles, const std::string& name) {
  return std::make_unique<EmbreeTree>(vertices, triangles, name);
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::EmbreeModule palpate_embree = {palpate::build};
