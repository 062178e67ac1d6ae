// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/reference/nearest_across.hpp"
#include "shaders/filter_distance.layout.h"

namespace palpate::reference {
namespace {

// Offset of a surface point from a voxel, in steps of 1/8 voxel.
using Foot = std::optional<Vec3i>;

// The numbers of a distance.
struct Given {
  float isovalue, band, unit, slack;
  std::array<float, 3> edge, edge_square;

  explicit Given(const FilterStep& step)
      : isovalue(step.taps[DISTANCE_ISOVALUE]),
        band(step.taps[DISTANCE_BAND]),
        unit(step.taps[DISTANCE_UNIT]),
        slack(step.taps[DISTANCE_SLACK]),
        edge{step.taps[DISTANCE_EDGE], step.taps[DISTANCE_EDGE + 1], step.taps[DISTANCE_EDGE + 2]},
        edge_square{step.taps[DISTANCE_EDGE_SQUARE], step.taps[DISTANCE_EDGE_SQUARE + 1],
                    step.taps[DISTANCE_EDGE_SQUARE + 2]} {}
};

bool within(const DenseField& field, const Vec3i& voxel) {
  return (voxel.array() >= 0).all() && (voxel.array() < field.size.array()).all();
}

float at(const DenseField& field, const Vec3i& voxel) {
  const Vec3i inside = voxel.cwiseMax(Vec3i::Zero()).cwiseMin(field.size - Vec3i::Ones());
  return field.at(inside.x(), inside.y(), inside.z());
}

// `after_slice` is called after each slice; it may throw to stop the work.
template <typename Function>
void forEachVoxel(const DenseField& field, const std::function<void()>& after_slice, const Function& function) {
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) function(Vec3i(i, j, k), field.offset(i, j, k));
    }
    after_slice();
  }
}

// The nearest crossing on the lines to the 26 neighbours. Of equally near ones it is the first, i fastest.
Foot seedOf(const DenseField& field, const Vec3i& voxel, const Given& given) {
  const float here = at(field, voxel);
  float best = INFINITY;
  Foot foot;
  for (int n = 0; n < 27; ++n) {
    const Vec3i direction(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (!within(field, voxel + direction)) continue;
    const float there = at(field, voxel + direction);
    if ((here > given.isovalue) == (there > given.isovalue)) continue;
    const float share = (here / 2 - given.isovalue / 2) / (here / 2 - there / 2);
    const auto part = [&](int axis) {
      return static_cast<float>(direction[axis] * direction[axis]) * given.edge_square[static_cast<std::size_t>(axis)];
    };
    const float square = (share * share) * (part(0) + (part(1) + part(2)));
    if (!(square < best)) continue;
    best = square;
    foot.emplace();
    for (int axis = 0; axis < 3; ++axis) {
      const float steps = (share * static_cast<float>(direction[axis])) * 8.0F;
      (*foot)[axis] = static_cast<int>(std::floor(steps + 0.5F));
    }
  }
  return foot;
}

// For each voxel, the nearest of the points that the voxels within reach along the step's axis have found.
std::vector<Foot> spread(const DenseField& field, const std::vector<Foot>& feet, const FilterStep& step,
                         const std::function<void()>& after_slice) {
  const Given given(step);
  const int reach = step.reach[step.axis];
  const auto square = [&given](const Vec3i& foot, int axis) {
    const auto steps = static_cast<float>(foot[axis]);
    return (steps * steps) * given.edge_square[static_cast<std::size_t>(axis)];
  };
  std::vector<Foot> after(feet.size());
  forEachVoxel(field, after_slice, [&](const Vec3i& voxel, std::size_t offset) {
    float best = 4096.0F;  // eight voxels of the smallest spacing, beyond any band
    for (int shift = -reach; shift <= reach; ++shift) {
      const Vec3i other = voxel + shift * Vec3i::Unit(step.axis);
      if (!within(field, other)) continue;
      Foot foot = feet[field.offset(other.x(), other.y(), other.z())];
      if (!foot) continue;
      *foot += 8 * shift * Vec3i::Unit(step.axis);
      const int first = step.axis == 0 ? 1 : 0;
      const int second = step.axis == 2 ? 1 : 2;
      const float distance = square(*foot, step.axis) + (square(*foot, first) + square(*foot, second));
      if (!(distance < best)) continue;
      best = distance;
      after[offset] = foot;
    }
  });
  return after;
}

// Gradient (per voxel) and value of the trilinear field. Both are divided by four, so that no difference overflows.
struct Trilinear {
  std::array<float, 3> gradient{};
  float value = 0;
};

float lerp(float a, float b, float t) {
  return a + t * (b - a);
}

Trilinear trilinear(const DenseField& field, const Vec3i& cell, const std::array<float, 3>& share) {
  std::array<float, 8> f{};  // corners, i fastest
  for (int n = 0; n < 8; ++n) f[static_cast<std::size_t>(n)] = at(field, cell + Vec3i(n % 2, n / 2 % 2, n / 4)) / 4;
  const auto [x, y, z] = share;
  Trilinear result;
  result.gradient[0] = lerp(lerp(f[1] - f[0], f[3] - f[2], y), lerp(f[5] - f[4], f[7] - f[6], y), z);
  // Along i first, then j, then k.
  const std::array<float, 4> rows = {lerp(f[0], f[1], x), lerp(f[2], f[3], x), lerp(f[4], f[5], x),
                                     lerp(f[6], f[7], x)};
  result.gradient[1] = lerp(rows[1] - rows[0], rows[3] - rows[2], z);
  const std::array<float, 2> faces = {lerp(rows[0], rows[1], y), lerp(rows[2], rows[3], y)};
  result.gradient[2] = faces[1] - faces[0];
  result.value = lerp(faces[0], faces[1], z);
  return result;
}

float sum(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

// The tangent plane at a place near the surface, and where the voxel lies relative to it.
struct Tangent {
  std::array<float, 3> normal{};  // into the object
  float left = 0;                 // from the place to the surface, along the normal [unit]
  float rise = 0;                 // from the plane to the voxel, along the normal [unit]
  float height = 0;               // the same, positive away from the surface on the voxel's own side
  float side = 0;                 // from the normal to the voxel [unit]
  float away_square = 0;          // from the place to the voxel [unit^2]
};

// `shift`: from the voxel to the place [voxel]; `away`: from the place to the voxel [unit].
Tangent tangentAt(const DenseField& field, const Vec3i& voxel, const std::array<float, 3>& shift,
                  const std::array<float, 3>& away, const Given& given, bool clamp_left) {
  Vec3i cell;
  std::array<float, 3> share{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<int>(axis);
    cell[a] = voxel[a] + static_cast<int>(std::floor(shift[axis]));
    share[axis] = shift[axis] - std::floor(shift[axis]);
    if (cell[a] >= field.size[a] - 1) {
      cell[a] = std::max(field.size[a] - 2, 0);
      share[axis] = 1;
    }
  }
  Trilinear there = trilinear(field, cell, share);
  float largest = 0;  // component of the gradient; divided by it, the components' squares neither overflow nor vanish
  for (std::size_t axis = 0; axis < 3; ++axis) {
    there.gradient[axis] = there.gradient[axis] / given.edge[axis];
    largest = std::max(largest, std::fabs(there.gradient[axis]));
  }
  for (float& component : there.gradient) component = component / largest;
  const float length = std::sqrt(sum(there.gradient, there.gradient));
  Tangent tangent;
  for (std::size_t axis = 0; axis < 3; ++axis) tangent.normal[axis] = there.gradient[axis] / length;
  tangent.left = (there.value - given.isovalue / 4) / (length * largest);
  if (clamp_left && tangent.left > DISTANCE_LEFT) tangent.left = DISTANCE_LEFT;
  if (clamp_left && tangent.left < -DISTANCE_LEFT) tangent.left = -DISTANCE_LEFT;
  const float along = sum(tangent.normal, away);
  tangent.rise = along + tangent.left;
  tangent.height = at(field, voxel) > given.isovalue ? tangent.rise : -tangent.rise;
  tangent.away_square = sum(away, away);
  const float side_square = tangent.away_square - along * along;
  tangent.side = side_square > 0 ? std::sqrt(side_square) : 0.0F;
  return tangent;
}

// From a voxel to a surface point.
struct FootOffset {
  std::array<float, 3> shift{};  // [voxel]
  std::array<float, 3> away{};   // the way back [unit]
};

FootOffset offsetTo(const Vec3i& foot, const Given& given) {
  FootOffset offset;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    offset.shift[axis] = static_cast<float>(foot[static_cast<int>(axis)]) / 8.0F;
    offset.away[axis] = -offset.shift[axis] * given.edge[axis];
  }
  return offset;
}

// The unsigned distance of the voxel from the surface, estimated from tangent planes [unit].
float distanceFrom(const DenseField& field, const Vec3i& voxel, const Vec3i& foot, const Given& given) {
  auto [shift, away] = offsetTo(foot, given);
  Tangent tangent = tangentAt(field, voxel, shift, away, given, true);
  for (int projection = 0; projection < 2; ++projection) {
    if (!(tangent.height >= 0 && tangent.height < given.band + 1)) break;
    bool within_domain = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      away[axis] = tangent.rise * tangent.normal[axis];
      shift[axis] = -away[axis] / given.edge[axis];
      const auto place = static_cast<float>(voxel[static_cast<int>(axis)]);
      const auto last = static_cast<float>(field.size[static_cast<int>(axis)] - 1);
      within_domain = within_domain && shift[axis] >= -place && shift[axis] <= last - place;
    }
    if (!within_domain) break;
    const Tangent next = tangentAt(field, voxel, shift, away, given, false);
    if (!(std::fabs(next.left) <= DISTANCE_LEFT && next.height >= 0 &&
          (next.side < tangent.side || next.side <= given.slack)))
      break;
    tangent = next;
  }
  const auto [normal, left, rise, height, side, away_square] = tangent;
  if (!(height >= 0)) return std::sqrt(away_square);
  if (!(side > given.slack)) return height;
  const float partly = 2.0F * (side - given.slack);
  const float beside = partly < side ? partly : side;
  return std::sqrt(height * height + beside * beside);
}

// Clamps a distance. It is at most the distance to the nearest voxel across the isovalue, and at least that less a
// cell's diagonal.
float held(float distance, float point, const std::optional<float>& across_square, const Given& given) {
  if (!across_square) return given.band;
  const float farthest = std::sqrt(*across_square);
  const float nearest = farthest - 2.0F * given.slack;
  if (!(distance >= nearest)) distance = point;
  if (!(distance >= nearest)) distance = nearest;
  if (!(distance <= farthest)) distance = farthest;
  return distance < given.band ? distance : given.band;
}

std::vector<std::optional<float>> squaresAcross(const DenseField& field, std::span<const FilterStep> steps,
                                                const Given& given, std::function<void()> after_slice) {
  AcrossSearch search{given.isovalue, Vec3::Ones(), Vec3i::Zero(), std::move(after_slice)};
  for (int axis = 0; axis < 3; ++axis) search.edge_square[axis] = given.edge_square[static_cast<std::size_t>(axis)];
  for (const FilterStep& step : steps) {
    if (step.kind == StepKind::kDistanceSpread) search.reach[step.axis] = step.reach[step.axis];
  }
  return squaresAcross(field, search);
}

}  // namespace

DenseField signedDistance(const DenseField& field, std::span<const FilterStep> steps,
                          const std::function<void(double)>& progress) {
  const Given given(steps[0]);
  const double slices =
      static_cast<double>(steps.size() + 1) * field.size.z();  // the search for voxels across is one more round
  auto after_slice = [&, done = 0.0]() mutable {
    if (progress) progress(++done / slices);
  };
  std::vector<Foot> feet(field.values.size());
  forEachVoxel(field, std::ref(after_slice),
               [&](const Vec3i& voxel, std::size_t offset) { feet[offset] = seedOf(field, voxel, given); });
  const std::vector<std::optional<float>> across = squaresAcross(field, steps, given, std::ref(after_slice));
  for (const FilterStep& step : steps) {
    if (step.kind == StepKind::kDistanceSpread) feet = spread(field, feet, step, std::ref(after_slice));
  }
  DenseField after = field;
  forEachVoxel(field, std::ref(after_slice), [&](const Vec3i& voxel, std::size_t offset) {
    float distance = given.band;
    float point = given.band;
    if (feet[offset]) {
      distance = distanceFrom(field, voxel, *feet[offset], given);
      const FootOffset to_foot = offsetTo(*feet[offset], given);
      point = std::sqrt(sum(to_foot.away, to_foot.away));
    }
    distance = held(distance, point, across[offset], given);
    const bool inside = at(field, voxel) > given.isovalue;
    if (inside && !(distance > 1e-6F)) distance = 1e-6F;
    after.values[offset] = distance * given.unit;
    if (!inside) after.values[offset] = after.values[offset] > 0 ? -after.values[offset] : 0.0F;
  });
  return after;
}

}  // namespace palpate::reference
