// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/GridOperators.h>
#include <tbb/global_control.h>

#include "apps/rivals/rivals.hpp"
#include "base/units.hpp"

namespace palpate {

struct OpenVdbRivals::State {
  RivalField field;
  unsigned threads = 1;
  openvdb::CoordBBox box{};
  openvdb::FloatGrid::Ptr grid{};  // made on first use
};

namespace {

using State = OpenVdbRivals::State;
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

}  // namespace

OpenVdbRivals::OpenVdbRivals(const RivalField& field, unsigned threads)
    : state_(std::make_shared<State>(State{field, threads})) {
  openvdb::initialize();
  const openvdb::Coord last(field.size.x() - 1, field.size.y() - 1, field.size.z() - 1);
  state_->box = openvdb::CoordBBox(openvdb::Coord(0), last);
}

std::vector<Rival> OpenVdbRivals::rivalsOf(const std::string& job) const {
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

}  // namespace palpate
