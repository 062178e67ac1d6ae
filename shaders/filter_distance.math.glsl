// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance.math.glsl: arithmetic of the signed distance, in three parts. Seed: where a line between two
// voxels meets the surface, and the word that keeps such a point and the nearest voxel across
// (filter_distance.layout.h). Spread: which of two words knows the nearer point or voxel. Finish: the distance from the
// surface, within the bounds that the voxel across sets.
//
// Lengths are in units of the smallest spacing. Densities are halved or quartered before they are subtracted, so that
// no difference overflows; that loses bits of denormals only. Read by GLSL and by C++ (shaders/kernel_text.hpp), after
// numbers.math.glsl.

// ---- Seed: the nearest place at which the line to one of a voxel's 26 neighbours meets the surface.

struct Crossing {
  float square;  // squared length of the way to the crossing [unit^2]; DISTANCE_NOWHERE: there is none
  float share;   // of the way to the neighbour, 0 ... 1
  int way;       // (dz + 1) * 9 + (dy + 1) * 3 + dx + 1
};

PALPATE_TEXT Crossing noCrossing() {
  Crossing none;
  none.square = DISTANCE_NOWHERE;
  none.share = 0.0f;
  none.way = 0;
  return none;
}

// The share of the way from one voxel to another at which the surface lies.
PALPATE_TEXT float crossingOf(float here, float there, float isovalue) {
  precise float to_surface = 0.5f * here - 0.5f * isovalue;
  precise float to_there = 0.5f * here - 0.5f * there;
  precise float share = to_surface / to_there;
  return share;
}

// Squared length of the way to a neighbour: waySquare(). Its part across i: wayAcross(). Edges are passed squared.
PALPATE_TEXT float wayAcross(int dy, int dz, float edge_y, float edge_z) {
  precise float square = float(dy * dy) * edge_y + float(dz * dz) * edge_z;
  return square;
}
PALPATE_TEXT float waySquare(int dx, float edge_x, float across) {
  precise float square = float(dx * dx) * edge_x + across;
  return square;
}

// The nearer of `best` and the crossing on the way to a neighbour. A neighbour of density `there` counts only in the
// domain.
PALPATE_TEXT Crossing nearerCrossing(Crossing best, float here, float there, float isovalue, float way_square, int way,
                                     bool in_domain) {
  const float share = crossingOf(here, there, isovalue);
  precise float square = (share * share) * way_square;
  const bool nearer = in_domain && (here > isovalue) != (there > isovalue) && square < best.square;
  Crossing nearest;
  nearest.square = nearer ? square : best.square;
  nearest.share = nearer ? share : best.share;
  nearest.way = nearer ? way : best.way;
  return nearest;
}

// An offset [voxel] in the steps of a word, 1/8 voxel each.
PALPATE_TEXT int steppedOffset(float voxels) {
  precise float steps = voxels * float(DISTANCE_PARTS);
  return int(floor(steps + 0.5f));
}

// Makes a word from the bits of its surface point and of its voxel across. The last bit but one is the opposite of the
// bit before it.
PALPATE_TEXT uint wordWith(bool inside, uint point, uint across) {
  return (inside ? DISTANCE_INSIDE : 0u) | ((~across & 0x20000000u) << 1) | across | point;
}

PALPATE_TEXT uint pointBits(int x, int y, int z) {
  return uint(x + DISTANCE_POINT_MIDDLE) | (uint(y + DISTANCE_POINT_MIDDLE) << DISTANCE_POINT_BITS) |
         (uint(z + DISTANCE_POINT_MIDDLE) << (2 * DISTANCE_POINT_BITS));
}

PALPATE_TEXT bool knowsPoint(uint word) { return (word & DISTANCE_POINT) != 0u; }
PALPATE_TEXT bool knowsAcross(uint word) { return (word & DISTANCE_ACROSS) != 0u; }
PALPATE_TEXT bool isInside(uint word) { return (word & DISTANCE_INSIDE) != 0u; }

// Offset of the surface point along an axis, in steps.
PALPATE_TEXT int offsetOf(uint word, int axis) {
  return int((word >> uint(axis * DISTANCE_POINT_BITS)) & 127u) - DISTANCE_POINT_MIDDLE;
}

// Distance of the voxel across along an axis, in either direction [voxel].
PALPATE_TEXT int acrossOf(uint word, int axis) {
  return int((word >> uint(DISTANCE_ACROSS_FIRST + axis * DISTANCE_ACROSS_BITS)) & 7u);
}
PALPATE_TEXT uint acrossBits(int steps, int axis) {
  return uint(steps < 0 ? -steps : steps) << uint(DISTANCE_ACROSS_FIRST + axis * DISTANCE_ACROSS_BITS);
}

// A voxel's first word: its side, and a surface point if a crossing was found.
PALPATE_TEXT uint seedWord(Crossing crossing, bool inside) {
  precise float x = crossing.share * float(crossing.way % 3 - 1);
  precise float y = crossing.share * float(crossing.way / 3 % 3 - 1);
  const int dz = crossing.way / 9 - 1;
  precise float z = crossing.share * float(dz);
  const uint point = pointBits(steppedOffset(x), steppedOffset(y), steppedOffset(z));
  return wordWith(inside, crossing.square < DISTANCE_NOWHERE ? point : 0u, 0u);
}

// ---- Spread: the nearest surface point and the nearest voxel across that the voxels on a line know.
//
// The nearest voxel across in the box is found exactly, one axis after another. In the pass along the first axis it
// lies on the line itself. In the second pass, a voxel on the other side is itself a voxel across. A voxel on the same
// side knows the nearest one on its own line along the first axis. The third pass works likewise. Squares are added up
// one axis after another, and rounding keeps their order. A voxel that knows nothing may be skipped. If it lay across,
// the first voxel across on the way to it would know its side and be nearer.

struct Nearest {
  float square;  // squared length of the way to the point or voxel
  uint bits;     // its bits, in their place in a word
};

PALPATE_TEXT Nearest nothingWithin(float square, uint bits) {
  Nearest none;
  none.square = square;
  none.bits = bits;
  return none;
}
PALPATE_TEXT Nearest noPoint() { return nothingWithin(DISTANCE_FARTHEST, 0u); }
PALPATE_TEXT Nearest noAcross() { return nothingWithin(DISTANCE_NOWHERE, 0u); }

PALPATE_TEXT float squareAlong(float steps, float edge_square) {
  precise float square = (steps * steps) * edge_square;
  return square;
}

// Squared length of the way to a word's surface point along the two other axes [step^2]. `known`: there is such a word.
PALPATE_TEXT float pointAcross(uint word, bool known, int axis_1, int axis_2, float edge_1, float edge_2) {
  precise float across = squareAlong(float(offsetOf(word, axis_1)), edge_1) +
                         squareAlong(float(offsetOf(word, axis_2)), edge_2);
  return known && knowsPoint(word) ? across : DISTANCE_FARTHEST;
}

// The nearer of `best` and a word's surface point. `offset`: of the point from the word's voxel; `shift`: of that voxel
// from this one. Both are along the axis, in steps.
PALPATE_TEXT Nearest nearerPoint(Nearest best, uint word, float offset, float across, int shift, int axis,
                                 float edge_square) {
  precise float square = squareAlong(offset + float(shift), edge_square) + across;
  const uint bits = (word & DISTANCE_POINT) + uint(shift * (1 << (axis * DISTANCE_POINT_BITS)));
  const bool nearer = square < best.square;
  Nearest nearest;
  nearest.square = nearer ? square : best.square;
  nearest.bits = nearer ? bits : best.bits;
  return nearest;
}

// Squared length of the way from a voxel on the line to its voxel across, along the axes of earlier passes [unit^2].
PALPATE_TEXT float acrossBefore(uint word, int axis, float edge_0, float edge_1) {
  const float first = axis > 0 ? squareAlong(float(acrossOf(word, 0)), edge_0) : 0.0f;
  precise float both = first + (axis > 1 ? squareAlong(float(acrossOf(word, 1)), edge_1) : 0.0f);
  return knowsAcross(word) ? both : DISTANCE_NOWHERE;
}

// The nearer of `best` and the voxel across that a word knows or is. `before`: acrossBefore() of the word; `known`:
// there is such a word; `shift`: of the word's voxel from this one [voxel]; `along`: the square of that [unit^2].
PALPATE_TEXT Nearest nearerAcross(Nearest best, uint word, bool known, bool inside, float before, float along,
                                  int shift, int axis) {
  const bool same_side = isInside(word) == inside;
  precise float square = along + (same_side ? before : 0.0f);
  const uint before_bits = same_side ? word & DISTANCE_ACROSS : 0u;
  const bool nearer = known && square < best.square;
  Nearest nearest;
  nearest.square = nearer ? square : best.square;
  nearest.bits = nearer ? before_bits | acrossBits(shift, axis) : best.bits;
  return nearest;
}

// ---- Finish: the distance from the trilinear surface near a point. In vectors of three the last element is unused.

// The cell that holds a place, along one axis, and where the place lies in the cell. A place on the domain's last voxel
// belongs to the cell before it. A domain of one voxel counts as a cell whose second corner repeats that voxel.
struct CellPlace {
  int cell;
  float share;  // 0 ... 1
};

PALPATE_TEXT CellPlace cellAt(int voxel, float shift, int size) {
  const float whole = floor(shift);
  precise float rest = shift - whole;
  const int c = voxel + int(whole);
  const bool at_end = c >= size - 1;
  CellPlace place;
  place.cell = at_end ? max(size - 2, 0) : c;
  place.share = at_end ? 1.0f : rest;
  return place;
}

// A quarter of the gradient (per voxel) and of the value of the trilinear field in a cell. whole_low, whole_high: the
// corners of the cell at k = 0 and 1, i fastest.
PALPATE_TEXT vec4 fieldIn(vec4 whole_low, vec4 whole_high, float x, float y, float z) {
  precise vec4 low = 0.25f * whole_low;
  precise vec4 high = 0.25f * whole_high;
  precise float dx00 = low[1] - low[0];
  precise float dx01 = low[3] - low[2];
  precise float dx10 = high[1] - high[0];
  precise float dx11 = high[3] - high[2];
  const float gx = lerped(lerped(dx00, dx01, y), lerped(dx10, dx11, y), z);
  const float f00 = lerped(low[0], low[1], x), f01 = lerped(low[2], low[3], x);
  const float f10 = lerped(high[0], high[1], x), f11 = lerped(high[2], high[3], x);
  precise float dy0 = f01 - f00;
  precise float dy1 = f11 - f10;
  const float gy = lerped(dy0, dy1, z);
  const float f0 = lerped(f00, f01, y), f1 = lerped(f10, f11, y);
  precise float gz = f1 - f0;
  return vec4(gx, gy, gz, lerped(f0, f1, z));
}

// A place near the surface, its tangent plane, and the position of a voxel relative to that plane.
struct Tangent {
  vec4 normal;        // unit, into the object
  float left;         // from the place to the surface, along the normal [unit]
  float rise;         // from the plane to the voxel, along the normal [unit]
  float height;       // the same, positive away from the surface on the voxel's own side
  float side;         // from the normal line to the voxel [unit]
  float away_square;  // from the place to the voxel [unit^2]
};

PALPATE_TEXT float dotOfThree(vec4 a, vec4 b) {
  precise float sum = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
  return sum;
}

// `field`: from fieldIn(). `away`: from the place to the voxel [unit]. `believed`: the place is known to lie next to
// the surface, so Tangent::left is clamped to DISTANCE_LEFT. The gradient is divided by its largest component before it
// is squared, so that no square overflows and at least one does not vanish. Without a gradient the result is NaN.
PALPATE_TEXT Tangent tangentOf(vec4 field, vec4 edge, float isovalue, vec4 away, bool inside, bool believed) {
  precise vec4 gradient = field / edge;
  const float either = abs(gradient[0]) > abs(gradient[1]) ? abs(gradient[0]) : abs(gradient[1]);
  const float largest = abs(gradient[2]) > either ? abs(gradient[2]) : either;
  precise vec4 direction = gradient / largest;
  precise float length = sqrt(dotOfThree(direction, direction));
  precise vec4 normal = direction / length;
  precise float steepness = length * largest;
  precise float left = (field[3] - 0.25f * isovalue) / steepness;
  const float low_left = believed && left > DISTANCE_LEFT ? DISTANCE_LEFT : left;
  Tangent tangent;
  tangent.left = believed && low_left < -DISTANCE_LEFT ? -DISTANCE_LEFT : low_left;
  const float along = dotOfThree(normal, away);
  precise float rise = along + tangent.left;
  tangent.normal = normal;
  tangent.rise = rise;
  tangent.height = inside ? rise : -rise;
  tangent.away_square = dotOfThree(away, away);
  precise float side_square = tangent.away_square - along * along;
  tangent.side = sqrt(side_square > 0.0f ? side_square : 0.0f);
  return tangent;
}

// The offset of a word's surface point from its voxel [voxel].
PALPATE_TEXT vec4 pointShift(uint word) {
  return vec4(float(offsetOf(word, 0)), float(offsetOf(word, 1)), float(offsetOf(word, 2)), 0.0f) *
         (1.0f / float(DISTANCE_PARTS));
}

// The vector to a voxel [unit] from a place; `shift` is the vector from the voxel to the place [voxel].
PALPATE_TEXT vec4 awayFrom(vec4 shift, vec4 edge) {
  precise vec4 away = -shift * edge;
  return away;
}

// risenBy(): the vector from the tangent plane to the voxel [unit], along the normal. landingShift(): the way back,
// from the voxel to its projection on the plane [voxel].
PALPATE_TEXT vec4 risenBy(Tangent tangent) {
  precise vec4 away = tangent.rise * tangent.normal;
  return away;
}
PALPATE_TEXT vec4 landingShift(vec4 away, vec4 edge) {
  precise vec4 shift = -away / edge;
  return shift;
}

PALPATE_TEXT bool isWithin(float shift, int voxel, int size) {
  return shift >= -float(voxel) && shift <= float(size - 1) - float(voxel);
}

// Whether the voxel may be projected onto this plane: it lies above the plane, and not too far.
PALPATE_TEXT bool isOver(Tangent tangent, float band) { return tangent.height >= 0.0f && tangent.height < band + 1.0f; }

// Whether the tangent plane at the place where the voxel landed is better than the plane before.
PALPATE_TEXT bool isBetter(Tangent landed, Tangent before, float slack) {
  return abs(landed.left) <= DISTANCE_LEFT && landed.height >= 0.0f &&
         (landed.side < before.side || landed.side <= slack);
}

// Distance from the surface of a voxel above a tangent plane. Up to `slack` beside the surface point the plane stands
// for the surface. Beyond twice `slack` it is the distance from the point itself. In between it goes from one to the
// other. It is also the distance from the point if there is no gradient, or if the plane has the voxel on the other
// side.
PALPATE_TEXT float distanceOver(Tangent tangent, float slack) {
  precise float partly = 2.0f * (tangent.side - slack);
  const float beside = partly < tangent.side ? partly : tangent.side;
  precise float slanted = sqrt(tangent.height * tangent.height + beside * beside);
  const float over = tangent.side > slack ? slanted : tangent.height;
  return tangent.height >= 0.0f ? over : sqrt(tangent.away_square);
}

// Squared length of the way to the voxel across [unit^2], added up in the order of the spread. Edges are passed
// squared.
PALPATE_TEXT float acrossSquare(uint word, float edge_x, float edge_y, float edge_z) {
  precise float square = squareAlong(float(acrossOf(word, 2)), edge_z) +
                         (squareAlong(float(acrossOf(word, 0)), edge_x) + squareAlong(float(acrossOf(word, 1)), edge_y));
  return square;
}

// Clamps a distance to the bounds that the nearest voxel across sets. The surface crosses the way to that voxel, so it
// is no farther than the voxel. A surface point has a voxel across within one diagonal (two slacks), so the surface is
// no nearer than that voxel minus a diagonal. A tangent plane that yields less is not that of the surface. Then `point`
// is taken instead, the distance of the known surface point. Without a voxel across within reach the surface is beyond
// the band.
PALPATE_TEXT float heldDistance(float distance, float point, uint word, float across_square, float slack, float band) {
  const float farthest = sqrt(across_square);
  precise float nearest = farthest - 2.0f * slack;
  const float believed = distance >= nearest ? distance : point;
  const float raised = believed >= nearest ? believed : nearest;
  const float held = raised <= farthest ? raised : farthest;
  return knowsAcross(word) && held < band ? held : band;
}

// Inside, the distance is positive, however close the surface. (0 - x does not replace -x: compilers turn one into the
// other, and so 0 into -0.)
PALPATE_TEXT float signedDistance(float distance, float unit, bool inside) {
  const float least = 1e-6f;
  precise float positive = (distance > least ? distance : least) * unit;
  precise float away = distance * unit;
  const float negative = away > 0.0f ? -away : 0.0f;
  return inside ? positive : negative;
}
