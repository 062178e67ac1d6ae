// SPDX-License-Identifier: Apache-2.0
// tests/engine/filter_passes/filters_by_text.hpp: runs the text of the filter kernels (shaders/kernel_text.hpp) on the
// CPU. For gradients see by_text.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"
#include "shaders/kernel_text.hpp"
#include "tests/engine/passes/by_text.hpp"

namespace palpate::by_text {

inline float tapOf(const FilterStep& step, int first, int offset) {
  return step.taps[static_cast<std::size_t>(first) + std::abs(offset)];
}

inline float convolvedAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const int reach = step.reach[step.axis];
  const auto value = [&](int tap) { return at(field, voxel + tap * Vec3i::Unit(step.axis), step.border); };
  float sum = kernel_text::firstTap(tapOf(step, 0, reach), value(-reach));
  for (int tap = 1 - reach; tap <= reach; ++tap) sum = kernel_text::addTap(sum, tapOf(step, 0, tap), value(tap));
  return kernel_text::finite(sum);
}

inline float bilateralAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const int tap_y = step.reach.x() + 2;
  const int tap_z = tap_y + step.reach.y() + 1;
  const float density = at(field, voxel);
  kernel_text::BilateralSums sums = kernel_text::bilateralNothing();
  for (int z = -step.reach.z(); z <= step.reach.z(); ++z) {
    for (int y = -step.reach.y(); y <= step.reach.y(); ++y) {
      const float tap_yz = kernel_text::placeTap(tapOf(step, tap_y, y), tapOf(step, tap_z, z));
      for (int x = -step.reach.x(); x <= step.reach.x(); ++x) {
        sums = kernel_text::bilateralAdded(sums, kernel_text::placeTap(tapOf(step, 1, x), tap_yz),
                                           at(field, voxel + Vec3i(x, y, z), step.border), density, step.taps[0]);
      }
    }
  }
  return kernel_text::bilateralResult(density, sums);
}

inline float diffusedAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const float here = at(field, voxel);
  const auto inflow = [&](int axis) {
    return kernel_text::axisInflow(at(field, voxel - Vec3i::Unit(axis)), here, at(field, voxel + Vec3i::Unit(axis)),
                                   tapOf(step, 0, axis), tapOf(step, 3, axis), step.conductance == Conductance::kExp);
  };
  return kernel_text::diffused(here, inflow(0), inflow(1), inflow(2));
}

// ---- Ranks.

inline std::vector<int> ranksIn(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  std::vector<ShapeRow> rows = step.rows;
  for (int dk = -step.reach.z(); step.rows.empty() && dk <= step.reach.z(); ++dk) {
    for (int dj = -step.reach.y(); dj <= step.reach.y(); ++dj) rows.push_back({dj, dk, step.reach.x()});
  }
  std::vector<int> ranks;
  for (const ShapeRow& row : rows) {
    for (int di = -row.half; di <= row.half; ++di)
      ranks.push_back(kernel_text::rankOf(at(field, voxel + Vec3i(di, row.dj, row.dk), step.border)));
  }
  return ranks;
}

inline float extremeAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const bool highest = step.kind == StepKind::kHighestOnLine || step.kind == StepKind::kHighestInRows;
  const auto which = highest ? EXTREME_HIGHEST : EXTREME_LOWEST;
  int found = kernel_text::noExtreme(which);
  for (const int rank : ranksIn(field, voxel, step)) found = kernel_text::extremeOf(which, found, rank);
  return kernel_text::densityOf(found);
}

// filter_median_search.comp
inline float searchedMedianAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const std::vector<int> ranks = ranksIn(field, voxel, step);
  kernel_text::RankRange range = kernel_text::noRange();
  for (const int rank : ranks) range = kernel_text::widened(range, rank);
  while (range.lowest != range.highest) {
    const int middle = kernel_text::halfway(range.lowest, range.highest);
    const auto count = std::count_if(ranks.begin(), ranks.end(), [=](int rank) { return rank <= middle; });
    range = kernel_text::halved(range, static_cast<int>(count), (static_cast<int>(ranks.size()) + 1) / 2);
  }
  return kernel_text::densityOf(range.lowest);
}

// A column of the window across i, unsorted.
template <std::size_t kCount>
void fillColumn(int (&column)[kCount], const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  FilterStep across = step;
  across.reach.x() = 0;
  const std::vector<int> ranks = ranksIn(field, voxel, across);
  std::copy(ranks.begin(), ranks.end(), column);
}

// filter_median.comp, for windows that reach one voxel along each axis. The columns that neighbouring results share are
// merged first: those to the right of an even one.
inline float sortedMedianAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  int column[3][9];
  for (int c = 0; c < 3; ++c) {
    fillColumn(column[c], field, voxel + Vec3i(c - 1, 0, 0), step);
    kernel_text::sortNine(column[c]);
  }
  const bool even = voxel.x() % 2 == 0;
  int shared_ten[10];
  kernel_text::middleTen(column[even ? 1 : 0], column[even ? 2 : 1], shared_ten);
  return kernel_text::densityOf(kernel_text::tenthOf(shared_ten, column[even ? 0 : 2]));
}

// filter_median_wide.comp, for windows that reach two voxels.
inline float wideMedianAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  int column[5][25];
  for (int c = 0; c < 5; ++c) {
    fillColumn(column[c], field, voxel + Vec3i(c - 2, 0, 0), step);
    kernel_text::sortColumn(column[c]);
  }
  const int first = voxel.x() % 2 == 0 ? 1 : 0;  // first of the four shared columns
  int before[50], after[50], middle[26];
  kernel_text::mergeColumns(column[first], column[first + 1], before);
  kernel_text::mergeColumns(column[first + 2], column[first + 3], after);
  kernel_text::middleOfFour(before, after, middle);
  return kernel_text::densityOf(kernel_text::middleOf(middle, column[first == 1 ? 0 : 4]));
}

inline float medianAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  if (step.reach == Vec3i::Ones()) return sortedMedianAt(field, voxel, step);
  if (step.reach == Vec3i::Constant(2)) return wideMedianAt(field, voxel, step);
  return searchedMedianAt(field, voxel, step);
}

// ---- Distance.

inline bool isInside(const DenseField& field, const Vec3i& voxel) {
  return (voxel.array() >= 0).all() && (voxel.array() < field.size.array()).all();
}

inline std::uint32_t seedAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const float* edge = step.taps.data() + DISTANCE_EDGE_SQUARE;
  kernel_text::Crossing nearest = kernel_text::noCrossing();
  for (int way = 0; way < 27; ++way) {
    const Vec3i d(way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1);
    const float across = kernel_text::wayAcross(d.y(), d.z(), edge[1], edge[2]);
    nearest =
        kernel_text::nearerCrossing(nearest, at(field, voxel), at(field, voxel + d), step.taps[DISTANCE_ISOVALUE],
                                    kernel_text::waySquare(d.x(), edge[0], across), way, isInside(field, voxel + d));
  }
  return kernel_text::seedWord(nearest, at(field, voxel) > step.taps[DISTANCE_ISOVALUE]);
}

inline std::uint32_t spreadAt(const DenseField& field, std::span<const std::uint32_t> words, const Vec3i& voxel,
                              const FilterStep& step) {
  const float* edge = step.taps.data() + DISTANCE_EDGE_SQUARE;
  const int axis_1 = step.axis == 0 ? 1 : 0;
  const int axis_2 = step.axis == 2 ? 1 : 2;
  kernel_text::Nearest point = kernel_text::noPoint();
  kernel_text::Nearest across = kernel_text::noAcross();
  const bool inside = kernel_text::isInside(words[field.offset(voxel.x(), voxel.y(), voxel.z())]);
  for (int t = -step.reach[step.axis]; t <= step.reach[step.axis]; ++t) {
    const Vec3i other = voxel + t * Vec3i::Unit(step.axis);
    const std::uint32_t word =
        isInside(field, other) ? words[field.offset(other.x(), other.y(), other.z())] : DISTANCE_NONE;
    const bool known = word != DISTANCE_NONE;
    const float beside = kernel_text::pointAcross(word, known, axis_1, axis_2, edge[axis_1], edge[axis_2]);
    point = kernel_text::nearerPoint(point, word, static_cast<float>(kernel_text::offsetOf(word, step.axis)), beside,
                                     t * DISTANCE_PARTS, step.axis, edge[step.axis]);
    across = kernel_text::nearerAcross(across, word, known, inside,
                                       kernel_text::acrossBefore(word, step.axis, edge[0], edge[1]),
                                       kernel_text::squareAlong(static_cast<float>(t), edge[step.axis]), t, step.axis);
  }
  return kernel_text::wordWith(inside, point.bits, across.bits);
}

inline kernel_text::vec4 fieldAt(const DenseField& field, const Vec3i& voxel, const kernel_text::vec4& shift) {
  std::array<kernel_text::CellPlace, 3> place;
  for (int axis = 0; axis < 3; ++axis)
    place[static_cast<std::size_t>(axis)] = kernel_text::cellAt(voxel[axis], shift[axis], field.size[axis]);
  const Vec3i cell(place[0].cell, place[1].cell, place[2].cell);
  const auto corners = [&](int dk) {
    return kernel_text::vec4(at(field, cell + Vec3i(0, 0, dk)), at(field, cell + Vec3i(1, 0, dk)),
                             at(field, cell + Vec3i(0, 1, dk)), at(field, cell + Vec3i(1, 1, dk)));
  };
  return kernel_text::fieldIn(corners(0), corners(1), place[0].share, place[1].share, place[2].share);
}

inline float distanceAt(const DenseField& field, const Vec3i& voxel, std::uint32_t word, const FilterStep& step) {
  const float isovalue = step.taps[DISTANCE_ISOVALUE];
  const float band = step.taps[DISTANCE_BAND];
  const float slack = step.taps[DISTANCE_SLACK];
  const float* e = step.taps.data() + DISTANCE_EDGE;
  const kernel_text::vec4 edge(e[0], e[1], e[2], 1);
  const bool inside = at(field, voxel) > isovalue;
  float distance = band;
  float point = band;
  if (kernel_text::knowsPoint(word)) {
    const kernel_text::vec4 foot = kernel_text::pointShift(word);
    kernel_text::Tangent tangent = kernel_text::tangentOf(fieldAt(field, voxel, foot), edge, isovalue,
                                                          kernel_text::awayFrom(foot, edge), inside, true);
    point = std::sqrt(tangent.away_square);
    for (int projection = 0; projection < 2 && kernel_text::isOver(tangent, band); ++projection) {
      const kernel_text::vec4 away = kernel_text::risenBy(tangent);
      const kernel_text::vec4 shift = kernel_text::landingShift(away, edge);
      bool within = true;
      for (int axis = 0; axis < 3; ++axis)
        within = within && kernel_text::isWithin(shift[axis], voxel[axis], field.size[axis]);
      if (!within) break;
      const kernel_text::Tangent landed =
          kernel_text::tangentOf(fieldAt(field, voxel, shift), edge, isovalue, away, inside, false);
      if (!kernel_text::isBetter(landed, tangent, slack)) break;
      tangent = landed;
    }
    distance = kernel_text::distanceOver(tangent, slack);
  }
  const float* square = step.taps.data() + DISTANCE_EDGE_SQUARE;
  distance = kernel_text::heldDistance(distance, point, word,
                                       kernel_text::acrossSquare(word, square[0], square[1], square[2]), slack, band);
  return kernel_text::signedDistance(distance, step.taps[DISTANCE_UNIT], inside);
}

inline DenseField distance(const DenseField& field, std::span<const FilterStep> steps) {
  std::vector<std::uint32_t> words(field.values.size());
  forEachVoxel(field, [&](const Vec3i& voxel, std::size_t n) { words[n] = seedAt(field, voxel, steps[0]); });
  for (const FilterStep& step : steps.subspan(1, 3)) {
    const std::vector<std::uint32_t> known = words;
    forEachVoxel(field, [&](const Vec3i& voxel, std::size_t n) { words[n] = spreadAt(field, known, voxel, step); });
  }
  DenseField after = field;
  forEachVoxel(field, [&](const Vec3i& voxel, std::size_t n) {
    after.values[n] = distanceAt(field, voxel, words[n], steps[4]);
  });
  return after;
}

// ---- All filters.

inline float resultAt(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  switch (step.kind) {
    case StepKind::kConvolve:
      return convolvedAt(field, voxel, step);
    case StepKind::kBilateral:
      return bilateralAt(field, voxel, step);
    case StepKind::kDiffuse:
      return diffusedAt(field, voxel, step);
    case StepKind::kMedian:
      return medianAt(field, voxel, step);
    default:
      return extremeAt(field, voxel, step);
  }
}

inline DenseField filtered(DenseField field, std::span<const FilterStep> steps) {
  while (!steps.empty()) {
    if (steps[0].kind == StepKind::kDistanceSeed) {
      field = distance(field, steps.first(kDistanceSteps));
      steps = steps.subspan(kDistanceSteps);
      continue;
    }
    DenseField after = field;
    forEachVoxel(field, [&](const Vec3i& voxel, std::size_t n) { after.values[n] = resultAt(field, voxel, steps[0]); });
    field = std::move(after);
    steps = steps.subspan(1);
  }
  return field;
}

}  // namespace palpate::by_text
