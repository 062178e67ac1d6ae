// SPDX-License-Identifier: Apache-2.0
// The module "rivals": its table, and the rivals on OpenVDB.
#include <algorithm>
#include <cmath>
#include <limits>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/GridOperators.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/RayTracer.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include "apps/rivals/itk_jobs.hpp"
#include "apps/rivals/rivals_module.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

struct State {
  RivalField field;
  unsigned threads = 1;
  openvdb::CoordBBox box{};
  openvdb::FloatGrid::Ptr grid{};       // made on first use
  openvdb::FloatGrid::Ptr level_set{};  // likewise, of the isovalue:
  double level_set_of = 0;
};

using Filter = openvdb::tools::Filter<openvdb::FloatGrid>;

void copyTo(const openvdb::FloatGrid& grid, const State& state, std::vector<float>& result) {
  result.resize(state.box.volume());
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(state.box, result.data());
  openvdb::tools::copyToDense(grid, dense);
}

void copyTo(const openvdb::VectorGrid& grid, const State& state, std::vector<float>& result) {
  result.clear();
  const auto at = grid.getConstAccessor();
  const openvdb::Coord end = state.box.max();
  for (int k = 0; k <= end.z(); ++k) {
    for (int j = 0; j <= end.y(); ++j) {
      for (int i = 0; i <= end.x(); ++i) {
        const openvdb::Vec3f value = at.getValue({i, j, k});
        result.insert(result.end(), {value.x(), value.y(), value.z()});
      }
    }
  }
}

openvdb::FloatGrid::Ptr gridOf(const State& state) {
  const RivalField& field = state.field;
  // The background must differ from every voxel; voxels of this density would not be active.
  const float background = *std::min_element(field.densities.begin(), field.densities.end()) - 1;
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(background);
  openvdb::math::Mat4d to_world = openvdb::math::Mat4d::identity();
  for (int axis = 0; axis < 3; ++axis) to_world(axis, axis) = field.spacing_m[axis] / kMetresPerMillimetre;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(to_world));
  const openvdb::tools::Dense<const float, openvdb::tools::LayoutXYZ> dense(state.box, field.densities.data());
  openvdb::tools::copyFromDense(dense, *grid, 0.0F);
  grid->tree().voxelizeActiveTiles();  // filters skip tiles
  return grid;
}

// `run` leaves its result in a grid.
template <class Grid>
Rival rival(const std::shared_ptr<State>& state, const std::string& way,
            const std::function<RunCost(typename Grid::Ptr&)>& run) {
  if (!state->grid) state->grid = gridOf(*state);
  return {"OpenVDB", way, [=](std::vector<float>* result) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, state->threads);
            typename Grid::Ptr grid;
            const RunCost cost = run(grid);
            if (result != nullptr) copyTo(*grid, *state, *result);
            return cost;
          }};
}

// A run of tools::Filter, which works in place; so each run gets a copy.
Rival filter(const std::shared_ptr<State>& state, const std::string& way, const std::function<void(Filter&)>& work) {
  return rival<openvdb::FloatGrid>(state, way, [=](openvdb::FloatGrid::Ptr& grid) {
    grid = state->grid->deepCopy();
    return costOf([&] {
      Filter made(*grid);
      work(made);
    });
  });
}

// OpenVDB's ray tracer wants cubes, and distances in a narrow band.
openvdb::FloatGrid::Ptr levelSetOf(const State& state, double isovalue) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*state.grid, points, triangles, quads, isovalue);
  const double edge_mm = state.field.spacing_m.minCoeff() / kMetresPerMillimetre;
  const auto cubes = openvdb::math::Transform::createLinearTransform(edge_mm);
  return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*cubes, points, triangles, quads);
}

void prepareLevelSet(State& state, double isovalue) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, state.threads);
  if (!state.grid) state.grid = gridOf(state);
  if (!state.level_set || state.level_set_of != isovalue) state.level_set = levelSetOf(state, isovalue);
  state.level_set_of = isovalue;
}

openvdb::Vec3R asVdb(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

class Library final : public OpenVdbRivals::Library {
 public:
  Library(const RivalField& field, unsigned threads) : state_(std::make_shared<State>(State{field, threads})) {
    openvdb::initialize();
    const openvdb::Coord last(field.size.x() - 1, field.size.y() - 1, field.size.z() - 1);
    state_->box = openvdb::CoordBBox(openvdb::Coord(0), last);
  }
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& job) const override;
  [[nodiscard]] std::vector<Rival> picturesOf(const RivalView& view) const override;
  [[nodiscard]] std::vector<float> distancesOf(const RivalView& view) const override;

 private:
  std::shared_ptr<State> state_;
};

std::vector<Rival> Library::rivalsOf(const std::string& job) const {
  if (job == "gradient central") {
    return {rival<openvdb::VectorGrid>(state_, "tools::gradient", [state = state_](openvdb::VectorGrid::Ptr& gradient) {
      return costOf([&] { gradient = openvdb::tools::gradient(*state->grid); });
    })};
  }
  if (job == "gaussian:1.5") {
    return {filter(state_, "Filter::gaussian(1), four box means: sigma 1.6", [](Filter& f) { f.gaussian(1, 1); })};
  }
  if (job == "median:1") return {filter(state_, "Filter::median(1)", [](Filter& f) { f.median(1, 1); })};
  return {};
}

std::vector<Rival> Library::picturesOf(const RivalView& view) const {
  prepareLevelSet(*state_, view.isovalue);
  return {
      {"OpenVDB", "LevelSetRayTracer, of a level set made before", [state = state_, view](std::vector<float>* result) {
         namespace tools = openvdb::tools;
         const tbb::global_control all(tbb::global_control::max_allowed_parallelism, state->threads);
         const Camera& from = view.camera;
         tools::Film film(static_cast<std::size_t>(from.width), static_cast<std::size_t>(from.height));
         constexpr double kFocalLength = 1;
         const double high = 2 * std::tan(from.vertical_fov_rad / 2);
         tools::PerspectiveCamera camera(film, openvdb::Vec3R(0), asVdb(from.position_W / kMetresPerMillimetre),
                                         kFocalLength, high * from.width / from.height);
         camera.lookAt(asVdb((from.position_W + from.forward_W) / kMetresPerMillimetre), asVdb(from.up_W));
         const RunCost cost = costOf([&] {
           const tools::DiffuseShader<> shader;
           tools::LevelSetRayTracer tracer(*state->level_set, shader, camera);
           tracer.render();
         });
         if (result == nullptr) return cost;
         result->clear();
         for (std::size_t y = 0; y < film.height(); ++y) {
           for (std::size_t x = 0; x < film.width(); ++x) {
             const auto& pixel = film.pixel(x, y);
             result->push_back(pixel.r + pixel.g + pixel.b > 0 ? 1.0F : 0.0F);
           }
         }
         return cost;
       }}};
}

std::vector<float> Library::distancesOf(const RivalView& view) const {
  prepareLevelSet(*state_, view.isovalue);
  const openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid> surface(*state_->level_set);
  const openvdb::Vec3R eye_mm = asVdb(view.camera.position_W / kMetresPerMillimetre);
  std::vector<float> distances_m;
  for (int y = 0; y < view.camera.height; ++y) {
    for (int x = 0; x < view.camera.width; ++x) {
      const openvdb::math::Ray<double> ray(eye_mm, asVdb(view.camera.rayThrough(x + 0.5, y + 0.5)));
      openvdb::Vec3R hit_mm;
      const bool hits = surface.intersectsWS(ray, hit_mm);
      distances_m.push_back(hits ? static_cast<float>((hit_mm - eye_mm).length() * kMetresPerMillimetre)
                                 : std::numeric_limits<float>::infinity());
    }
  }
  return distances_m;
}

std::shared_ptr<const OpenVdbRivals::Library> open(const RivalField& field, unsigned threads) {
  return std::make_shared<const Library>(field, threads);
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::RivalsModule palpate_rivals = {palpate::itkJobs, palpate::open};
