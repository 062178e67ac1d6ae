// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance.math.glsl: arithmetic of the signed distance: where a line between two voxels meets the
// surface, the word that keeps such a point, which of two is nearer, and the distance from the surface near it. Lengths
// are in units of the smallest spacing. Densities are halved or quartered before they are subtracted, which loses nothing
// but of denormals, so that no difference overflows. Read by GLSL and by C++ (shaders/kernel_text.hpp).

// ---- Seed: of the lines to a voxel's 26 neighbours, the one that meets the surface nearest.

struct Crossing {
  float square;  // of the way to it [unit^2]; DISTANCE_NOWHERE: there is none
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

// Where on the way from a voxel to another, across the surface, it lies.
PALPATE_TEXT float crossingOf(float here, float there, float isovalue) {
  precise float to_surface = 0.5f * here - 0.5f * isovalue;
  precise float to_there = 0.5f * here - 0.5f * there;
  precise float share = to_surface / to_there;
  return share;
}

// Squares of the way to a neighbour: across i, then all of it. Edges: squared, along each axis.
PALPATE_TEXT float wayAcross(int dy, int dz, float edge_y, float edge_z) {
  precise float square = float(dy * dy) * edge_y + float(dz * dz) * edge_z;
  return square;
}
PALPATE_TEXT float waySquare(int dx, float edge_x, float across) {
  precise float square = float(dx * dx) * edge_x + across;
  return square;
}

// `there`: the neighbour's density, of no meaning if it is not in the domain.
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

// In steps of a word.
PALPATE_TEXT int steppedOffset(float voxels) {
  precise float steps = voxels * float(DISTANCE_PARTS);
  return int(floor(steps + 0.5f));
}

PALPATE_TEXT uint wordOf(int x, int y, int z) {
  return DISTANCE_KNOWN | uint(x + DISTANCE_MIDDLE) | (uint(y + DISTANCE_MIDDLE) << DISTANCE_FIELD) |
         (uint(z + DISTANCE_MIDDLE) << (2 * DISTANCE_FIELD));
}

// Offset along an axis, in steps.
PALPATE_TEXT int offsetOf(uint word, int axis) {
  return int((word >> uint(axis * DISTANCE_FIELD)) & DISTANCE_MASK) - DISTANCE_MIDDLE;
}

PALPATE_TEXT uint crossingWord(Crossing crossing) {
  precise float x = crossing.share * float(crossing.way % 3 - 1);
  precise float y = crossing.share * float(crossing.way / 3 % 3 - 1);
  precise float z = crossing.share * float(crossing.way / 9 - 1);
  const uint word = wordOf(steppedOffset(x), steppedOffset(y), steppedOffset(z));
  return crossing.square < DISTANCE_NOWHERE ? word : DISTANCE_NONE;
}

// ---- Spread: of the surface points that voxels on a line know, the nearest.

struct KnownPoint {
  float square;  // of the way to it [step^2]
  uint word;
};

PALPATE_TEXT KnownPoint nothingKnown() {
  KnownPoint none;
  none.square = DISTANCE_FARTHEST;
  none.word = DISTANCE_NONE;
  return none;
}

PALPATE_TEXT float squareAlong(float steps, float edge_square) {
  precise float square = (steps * steps) * edge_square;
  return square;
}

// Square of the way to a word's point across an axis, along the other two. `known`: there is such a point.
PALPATE_TEXT float pointAcross(uint word, bool known, int axis_1, int axis_2, float edge_1, float edge_2) {
  precise float across = squareAlong(float(offsetOf(word, axis_1)), edge_1) +
                         squareAlong(float(offsetOf(word, axis_2)), edge_2);
  return known ? across : DISTANCE_FARTHEST;
}

// `offset`: the word's along the axis, from its own voxel; `shift`: of that voxel from this one, both in steps.
PALPATE_TEXT KnownPoint nearerPoint(KnownPoint best, uint word, float offset, float across, int shift, int axis,
                                    float edge_square) {
  precise float square = squareAlong(offset + float(shift), edge_square) + across;
  const bool nearer = square < best.square;
  KnownPoint nearest;
  nearest.square = nearer ? square : best.square;
  nearest.word = nearer ? word + uint(shift * (1 << (axis * DISTANCE_FIELD))) : best.word;
  return nearest;
}

// ---- Finish: the distance from the trilinear surface beside a point. In vectors of three the last element is unused.

// The cell that holds a place, along one axis, and where in it. A place on the domain's last voxel belongs to the cell
// before it, and a domain of one voxel is half a cell: what lies behind it repeats it.
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

PALPATE_TEXT float lerped(float a, float b, float t) {
  precise float between = a + t * (b - a);
  return between;
}

// Gradient (by voxel) and value of the trilinear field in a cell, a quarter of both. low, high: its corners at k = 0 and
// 1, i fastest.
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

// A place near the surface, and how the voxel lies to the tangent plane there.
struct Tangent {
  vec4 normal;        // unit, into the object
  float left;         // from the place to the surface, along the normal [unit]
  float rise;         // from the plane to the voxel, along the normal [unit]
  float height;       // the same, away from the surface on the voxel's own side
  float side;         // from the normal to the voxel [unit]
  float away_square;  // from the place to the voxel [unit^2]
};

PALPATE_TEXT float dotOfThree(vec4 a, vec4 b) {
  precise float sum = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
  return sum;
}

// `field`: as fieldIn gives it; `away`: from the place to the voxel [unit]; `believed`: the place is known to lie next to
// the surface, so that what is left is cut off. Squares are of a gradient over its largest component, so that none
// overflows and they do not all vanish. No gradient: NaN.
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
  precise float rise = dotOfThree(normal, away) + tangent.left;
  tangent.normal = normal;
  tangent.rise = rise;
  tangent.height = inside ? rise : -rise;
  tangent.away_square = dotOfThree(away, away);
  precise float side_square = tangent.away_square - tangent.height * tangent.height;
  tangent.side = sqrt(side_square > 0.0f ? side_square : 0.0f);
  return tangent;
}

// Of a word's point from its voxel [voxel].
PALPATE_TEXT vec4 pointShift(uint word) {
  return vec4(float(offsetOf(word, 0)), float(offsetOf(word, 1)), float(offsetOf(word, 2)), 0.0f) *
         (1.0f / float(DISTANCE_PARTS));
}

// From the place `shift` [voxel] away from a voxel to the voxel [unit].
PALPATE_TEXT vec4 awayFrom(vec4 shift, vec4 edge) {
  precise vec4 away = -shift * edge;
  return away;
}

// From a tangent plane to the voxel [unit], and where the voxel comes to lie on the plane, from itself [voxel].
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

// Whether a voxel over this plane may be projected onto it: it is over it, and not too far.
PALPATE_TEXT bool isOver(Tangent tangent, float band) { return tangent.height >= 0.0f && tangent.height < band + 1.0f; }

// Whether the tangent at the place where a voxel landed tells more than the one before.
PALPATE_TEXT bool isBetter(Tangent landed, Tangent before, float slack) {
  return abs(landed.left) <= DISTANCE_LEFT && landed.height >= 0.0f &&
         (landed.side < before.side || landed.side <= slack);
}

// Distance from the surface, of a voxel over a tangent plane. The plane stands for the surface as far as `slack` beside
// the surface point; beyond twice that the distance is that of the point itself, in between it goes over from one to the
// other. Without a gradient, or where the plane has the voxel on the other side, it is the point's too. Cut off at the
// band.
PALPATE_TEXT float distanceOver(Tangent tangent, float slack, float band) {
  precise float partly = 2.0f * (tangent.side - slack);
  const float beside = partly < tangent.side ? partly : tangent.side;
  precise float slanted = sqrt(tangent.height * tangent.height + beside * beside);
  const float over = tangent.side > slack ? slanted : tangent.height;
  const float distance = tangent.height >= 0.0f ? over : sqrt(tangent.away_square);
  return distance < band ? distance : band;
}

// Inside it is positive, however close. (Not 0 - x for -x: compilers make one of the other, and -0 of 0.)
PALPATE_TEXT float signedDistance(float distance, float unit, bool inside) {
  const float least = 1e-6f;
  precise float positive = (distance > least ? distance : least) * unit;
  precise float away = distance * unit;
  const float negative = away > 0.0f ? -away : 0.0f;
  return inside ? positive : negative;
}
