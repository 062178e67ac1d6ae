// SPDX-License-Identifier: Apache-2.0
#include "apps/rivals/openvdb_rivals.hpp"

#include <algorithm>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/GridOperators.h>
#include <tbb/global_control.h>

#include "base/units.hpp"

namespace palpate {

struct OpenVdbRivals::State {
  openvdb::FloatGrid::Ptr grid;
  openvdb::CoordBBox box;
  unsigned threads = 1;
};

namespace {

using State = OpenVdbRivals::State;

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

// A filter of tools::Filter, which changes its grid: each run has a copy.
Rival filter(const std::shared_ptr<State>& state, const std::string& way,
             const std::function<void(openvdb::tools::Filter<openvdb::FloatGrid>&)>& work) {
  return {"OpenVDB", way, [=](std::vector<float>* result) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, state->threads);
            const openvdb::FloatGrid::Ptr grid = state->grid->deepCopy();
            const RunCost cost = costOf([&] {
              openvdb::tools::Filter<openvdb::FloatGrid> made(*grid);
              work(made);
            });
            if (result != nullptr) copyTo(*grid, *state, *result);
            return cost;
          }};
}

}  // namespace

OpenVdbRivals::OpenVdbRivals(const RivalField& field, unsigned threads) : state_(std::make_shared<State>()) {
  openvdb::initialize();
  state_->threads = threads;
  state_->box =
      openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(field.size.x() - 1, field.size.y() - 1, field.size.z() - 1));
  // A background that no voxel has, or voxels of that density would not be active.
  const float background = *std::min_element(field.densities.begin(), field.densities.end()) - 1;
  state_->grid = openvdb::FloatGrid::create(background);
  openvdb::math::Mat4d to_world = openvdb::math::Mat4d::identity();
  for (int axis = 0; axis < 3; ++axis) to_world(axis, axis) = field.spacing_m[axis] / kMetresPerMillimetre;
  state_->grid->setTransform(openvdb::math::Transform::createLinearTransform(to_world));
  const openvdb::tools::Dense<const float, openvdb::tools::LayoutXYZ> dense(state_->box, field.densities.data());
  openvdb::tools::copyFromDense(dense, *state_->grid, 0.0F);
  state_->grid->tree().voxelizeActiveTiles();  // filters pass over tiles
}

bool OpenVdbRivals::hasAny(const std::string& job) {
  return job == "gradient central" || job == "gaussian:1.5" || job == "median:1";
}

std::vector<Rival> OpenVdbRivals::rivalsOf(const std::string& job) const {
  const std::shared_ptr<State> state = state_;
  if (job == "gradient central") {
    return {{"OpenVDB", "tools::gradient", [state](std::vector<float>* result) {
               const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, state->threads);
               openvdb::VectorGrid::Ptr gradient;
               const RunCost cost = costOf([&] { gradient = openvdb::tools::gradient(*state->grid); });
               if (result != nullptr) copyTo(*gradient, *state, *result);
               return cost;
             }}};
  }
  using Filter = openvdb::tools::Filter<openvdb::FloatGrid>;
  if (job == "gaussian:1.5") {
    return {filter(state, "Filter::gaussian(1), four box means: sigma 1.6", [](Filter& f) { f.gaussian(1, 1); })};
  }
  if (job == "median:1") {
    return {filter(state, "Filter::median(1)", [](Filter& f) { f.median(1, 1); })};
  }
  return {};
}

}  // namespace palpate
