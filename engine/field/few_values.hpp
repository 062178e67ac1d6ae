// SPDX-License-Identifier: Apache-2.0
// engine/field/few_values.hpp: whether a volume holds so few values that its isosurface is felt as stairs: a mask, or a
// map of labels.
//
// Between two voxels the surface lies where the interpolated density crosses the isovalue. Where both voxels are of a
// mask that is always the same place between them, so the surface goes up and down in whole voxels. In a scan the
// density rises over more than one voxel, and the surface lies anywhere between two.
//
// Thread: any, while nobody changes the volume. Cost: of a scan of 12 bits some microseconds, since its values are soon
// too many. Of one of 8 bits a pass over the stored bricks, which takes half as long as statisticsOf(). Of a mask or a
// map of labels a second pass, in which all values are looked up; together 10 to 25 ms for 256^3.
#pragma once

#include <optional>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

// As many as a byte holds, and so a map of labels in bytes. With fewer the maps of whole bodies (117 structures) are
// not recognised; with more the maps that another program numbers freely are, but scans of 12 bits are read whole.
inline constexpr std::size_t kFewValues = 256;

// Of the lines across the surface, the share that must be steps. A map of labels falls below it where its labels are
// smaller than some three voxels. A scan of four bits rises above it where its edges are sharper than two voxels; it is
// then felt as stairs too.
inline constexpr double kStepShare = 0.7;

struct FewValues {
  std::vector<float> values;  // all that the volume holds, ascending [density]; 2 to kFewValues
  // Lines of three voxels along an axis, two on one side of the isosurface, the third on the other: the share of lines
  // whose two are equal. Of the lines inward and those outward, the lesser share; 1 where there are none.
  double step_share = 1;
};

// Empty unless the isovalue parts the volume, the volume holds 2 to kFewValues values and kStepShare of the lines
// across the isosurface are steps. Two values always are. Lines that cross from one brick of 8^3 into another are not
// looked at.
[[nodiscard]] std::optional<FewValues> fewValuesOf(const Volume& volume, double isovalue);

}  // namespace palpate
