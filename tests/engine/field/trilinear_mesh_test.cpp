// SPDX-License-Identifier: Apache-2.0
// The isosurface's mesh against the surface of the trilinear field: its vertices lie on it, and it encloses the same
// volume. The field is evaluated by the reference's own sampler, its volume by columns; neither knows the mesher.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/reference/isosurface.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/middle_of.hpp"
#include "tests/support/scans.hpp"

namespace palpate {
namespace trilinear_mesh_test {

constexpr double kMostUp = 2.2e-3;  // twice what a whole chest has (docs/convert.md): of any part, such as a middle
constexpr double kKept = 1.0 / 256;  // what vertices keep from the faces of their cells [voxel]

double meshVolume_m3(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += mesh.vertices_W[t[0]].dot(mesh.vertices_W[t[1]].cross(mesh.vertices_W[t[2]])) / 6;
  return sum;
}

// The part of a cell in which the trilinear field of its corners' excess is above zero. Along z the field is linear:
// the length inside is exact. Over x and y it is summed at the middles of kColumns^2 squares.
double insideOf(const std::array<double, 8>& excess) {
  constexpr int kColumns = 16;
  const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
  double sum = 0;
  for (int n = 0; n < kColumns * kColumns; ++n) {
    const double x = (n % kColumns + 0.5) / kColumns, y = (n / kColumns + 0.5) / kColumns;
    const double low = mix(mix(excess[0], excess[1], x), mix(excess[2], excess[3], x), y);
    const double high = mix(mix(excess[4], excess[5], x), mix(excess[6], excess[7], x), y);
    if (low > 0 && high > 0) sum += 1;
    if ((low > 0) != (high > 0)) sum += std::max(low, high) / std::abs(high - low);
  }
  return sum / (kColumns * kColumns);
}

double trilinearVolume_m3(const Volume& volume, double isovalue) {
  const reference::DenseField field = reference::denseField(volume);
  double sum = 0;
  for (int k = 0; k + 1 < field.size.z(); ++k) {
    for (int j = 0; j + 1 < field.size.y(); ++j) {
      for (int i = 0; i + 1 < field.size.x(); ++i) {
        std::array<double, 8> excess{};
        for (int c = 0; c < 8; ++c)
          excess[static_cast<std::size_t>(c)] = field.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) - isovalue;
        sum += insideOf(excess);
      }
    }
  }
  return sum * volume.lattice().spacing_m.prod();
}

Volume noise(const Vec3i& size, unsigned seed, const Vec3& spacing_m) {
  std::mt19937 random(seed);
  std::normal_distribution<float> value;
  std::vector<float> values(static_cast<std::size_t>(size.prod()));
  for (float& v : values) v = value(random);
  return Volume::fromDense(size, {{1e-3, 0, -2e-3}, Mat3::Identity(), spacing_m}, values, {});
}

// Noise as a scanner's, in which a voxel resembles its neighbours: smoothed twice along each axis by 1, 2, 1. It has
// the kinds of cells that a chest has.
Volume smoothedNoise(const Vec3i& size, unsigned seed, const Vec3& spacing_m) {
  const Volume rough = noise(size, seed, spacing_m);
  std::vector<float> values = rough.toDense();
  const auto at = [&](const std::vector<float>& of, Vec3i p, int axis, int step) {
    p[axis] = std::clamp(p[axis] + step, 0, size[axis] - 1);
    return of[static_cast<std::size_t>((p.z() * size.y() + p.y()) * size.x() + p.x())];
  };
  for (int pass = 0; pass < 6; ++pass) {
    const std::vector<float> before = values;
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i p(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      const int axis = pass % 3;
      values[static_cast<std::size_t>(n)] =
          (at(before, p, axis, -1) + 2 * at(before, p, axis, 0) + at(before, p, axis, 1)) / 4;
    }
  }
  return Volume::fromDense(size, rough.lattice(), values, {});
}

// Counts the vertices off the border that are not on the surface. A vertex that keeps kKept from a face of its cell may
// be off by as much along each axis, times the field's slope. Along an axis that is a difference of the cell's corners.
double slopesAt(const reference::DenseField& field, const Vec3& p_I) {
  // A place at a cell's face, to rounding, may be of the cell before.
  Vec3 steepest = Vec3::Zero();
  const Vec3i first = (p_I.array() - 1e-6).floor().cast<int>().matrix().cwiseMax(0);
  const Vec3i last = (p_I.array() + 1e-6).ceil().cast<int>().matrix().cwiseMin(field.size - Vec3i::Ones());
  for (int k = first.z(); k <= last.z(); ++k)
    for (int j = first.y(); j <= last.y(); ++j)
      for (int i = first.x(); i <= last.x(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const Vec3i from(i, j, k), to = from + Vec3i::Unit(axis);
          if (to[axis] > last[axis]) continue;
          steepest[axis] = std::max(steepest[axis], std::abs(static_cast<double>(field.at(to.x(), to.y(), to.z())) -
                                                             field.at(from.x(), from.y(), from.z())));
        }
  return steepest.sum();
}

struct Off {
  int on_border = 0, kept = 0, off = 0;
};
Off verticesOff(const Volume& volume, double isovalue, const TriangleMesh& mesh) {
  const reference::DenseField field = reference::denseField(volume);
  Off count;
  for (const Vec3& v : mesh.vertices_W) {
    const Vec3 p_I = volume.lattice().toIndex(v);
    const double excess = reference::trilinear(field, p_I) - static_cast<float>(isovalue);
    const Vec3 last_I = (volume.size().cast<double>().array() - 1).matrix();
    const double range = static_cast<double>(volume.maximum()) - volume.minimum();
    const double moved = kKept * slopesAt(field, p_I);
    const double rounding = 1e-9 * range;  // of a place in the world, some 1e-12 voxel, and of sums of densities
    bool kept = false, border = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double in_cell = p_I[axis] - std::floor(p_I[axis]);
      kept = kept || std::abs(in_cell - kKept) < 1e-9 || std::abs(in_cell - (1 - kKept)) < 1e-9;
      border = border || p_I[axis] < 1e-9 || p_I[axis] > last_I[axis] - 1e-9;
    }
    if (border) {
      ++count.on_border;
      // In the face or on its rim: never in the background by more than what a vertex may be moved by.
      count.off += excess < -rounding - moved ? 1 : 0;
    } else if (kept) {
      ++count.kept;
      count.off += std::abs(excess) > rounding + moved ? 1 : 0;
    } else {
      count.off += std::abs(excess) > rounding ? 1 : 0;
    }
  }
  return count;
}

// Noise has every kind of cell, tunnels among them; whatever the voxels' shape.
TEST(TrilinearMesh, EveryVertexIsOnTheSurface) {
  for (const auto& spacing_m : {Vec3(1e-3, 1e-3, 1e-3), Vec3(0.4e-3, 0.7e-3, 2.5e-3)}) {
    const Volume volume = noise({19, 17, 23}, 5, spacing_m);
    for (const double isovalue : {-1.0, 0.0, 0.5, 2.0}) {
      for (const double adaptivity : {0.0, 0.1}) {
        const TriangleMesh mesh = isosurfaceMesh(volume, isovalue, adaptivity);
        const Off count = verticesOff(volume, isovalue, mesh);
        EXPECT_GT(mesh.vertices_W.size(), 500U);
        EXPECT_EQ(count.off, 0) << isovalue << ", adaptivity " << adaptivity;
        // Of random places in a cell, 3 * 2/256 are as close to a face; some of noise's are no random ones.
        EXPECT_LT(count.kept, 2 * 6.0 / 256 * static_cast<double>(mesh.vertices_W.size())) << isovalue;
      }
    }
  }
  const Volume knot = loadVolume("phantom:knot?size=40");
  EXPECT_EQ(verticesOff(knot, 0, isosurfaceMesh(knot, 0)).off, 0);
}

// Integers, many at the isovalue: vertices are moved off the surface by what they keep, and no more.
TEST(TrilinearMesh, VerticesAreNearTheSurfaceWhereVoxelsAreAtTheIsovalue) {
  std::mt19937 random(9);
  std::uniform_int_distribution<int> value(0, 3);
  const Vec3i size(15, 16, 17);
  std::vector<float> values(static_cast<std::size_t>(size.prod()));
  for (float& v : values) v = static_cast<float>(value(random));
  const Volume volume = Volume::fromDense(size, {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(1e-3)}, values, {});
  for (const double isovalue : {0.0, 1.0, 2.0})
    EXPECT_EQ(verticesOff(volume, isovalue, isosurfaceMesh(volume, isovalue)).off, 0) << isovalue;
}

// A voxel of density d among others of density e < 0: in each of its eight cells the field is e + (d - e) (1 - x) (1 -
// y) (1 - z), and above 0 where that product is above c = -e / (d - e). The surface is at 1 - c on the axes, at 1 -
// sqrt(c) on the faces' diagonals, where it bends most, and at 1 - cbrt(c) on the cell's diagonal. The volume of
// product > c in a cell is 1 - c (1 + L + L^2 / 2), with L = ln(1 / c). The count by columns has the same; its
// midpoints err by 1/(24 n^2) of what the length inside bends, at most 1e-3 here. The part of a cell is convex, so more
// vertices on its surface enclose more of it: a tip on each axis (1 - c)^3 / 6, all seven (1 - c) (1 - sqrt(c)) (1 -
// cbrt(c)), as six tetrahedra.
TEST(TrilinearMesh, OfOneVoxelIsKnown) {
  for (const auto& [d, e, bends] : {std::tuple(3.0F, -1.0F, true), {1.0F, -3.0F, false}, {9.0F, -1.0F, true}}) {
    std::vector<float> values(27, e);
    values[13] = d;
    const Volume volume =
        Volume::fromDense({3, 3, 3}, {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(1e-3)}, values, {});
    const double c = -static_cast<double>(e) / (static_cast<double>(d) - e), l = std::log(1 / c);
    const double whole = 8 * (1 - c * (1 + l + l * l / 2)) * 1e-9;
    EXPECT_NEAR(trilinearVolume_m3(volume, 0), whole, 8e-3 * 1e-9) << d;
    const double octahedron = 8 * std::pow(1 - c, 3) / 6 * 1e-9;
    EXPECT_NEAR(meshVolume_m3(isosurfaceMesh(volume, 0, 1e-12)) / octahedron, 1, 1e-9) << d;
    const TriangleMesh mesh = isosurfaceMesh(volume, 0);
    int on_diagonals = 0, on_faces = 0;
    for (const Vec3& vertex_W : mesh.vertices_W) {
      Vec3 off_I = (volume.lattice().toIndex(vertex_W) - Vec3::Ones()).cwiseAbs();
      std::sort(off_I.begin(), off_I.end());
      on_diagonals += (off_I - Vec3::Constant(1 - std::cbrt(c))).norm() < 1e-9 ? 1 : 0;
      on_faces += (off_I - Vec3(0, 1 - std::sqrt(c), 1 - std::sqrt(c))).norm() < 1e-9 ? 1 : 0;
    }
    EXPECT_EQ(on_diagonals, bends ? 8 : 0) << d;
    EXPECT_EQ(on_faces, bends ? 12 : 0) << d;
    const double seven = 8 * (1 - c) * (1 - std::sqrt(c)) * (1 - std::cbrt(c)) * 1e-9;
    const double volume_m3 = meshVolume_m3(mesh);
    EXPECT_GT(volume_m3, (bends ? seven : octahedron) * (1 - 1e-9)) << d;
    EXPECT_LT(volume_m3, whole) << d;
  }
}

// The trilinear field of a ball's signed distance is above it, on average over a cell by h^2 / 12 times the Laplacian,
// 2 / R: its surface lies h^2 / 6R inside the ball. (The field's error is not the mean one on every part of the
// surface, so 5 % is left.) Facets lie inside it by the sum of their edges' squares / 24R on average. On a plane along
// two axes these are h, h and sqrt(2) h, which is h^2 / 6R; but there the field is as curved as the ball only along the
// diagonals, whose facets meet the surface at their ends alone. Measured is 0.14 h^2 / 6R, and 0.7 with one vertex
// within each cell.
TEST(TrilinearMesh, LiesInsideABallByInterpolationAndChordsAlone) {
  const char* name = "phantom:sphere?size=116&spacing=0.5mm";
  const std::unique_ptr<Phantom> ball = makePhantom(name);
  const Volume volume = loadVolume(name);
  const TriangleMesh mesh = isosurfaceMesh(volume, 0);
  double area = 0, sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_W[t[0]], b = mesh.vertices_W[t[1]], c = mesh.vertices_W[t[2]];
    const double twice = (b - a).cross(c - a).norm();
    // Exact for second order.
    const double mean = (ball->signedDistance_m((a + b) / 2) + ball->signedDistance_m((b + c) / 2) +
                         ball->signedDistance_m((c + a) / 2)) /
                        3;
    area += twice;
    sum += twice * mean;
  }
  const Vec3 centre_W = volume.lattice().toWorld((volume.size().cast<double>().array() - 1).matrix() / 2);
  const double radius_m = -ball->signedDistance_m(centre_W), h_m = 0.5e-3;
  const double unit_m = h_m * h_m / (6 * radius_m);
  EXPECT_LT(sum / area, -0.95 * unit_m);
  EXPECT_GT(sum / area, -1.25 * unit_m);
}

struct Named {
  std::string name;
  Volume volume;
  bool is_smooth = false;
};

// Smooth phantoms, noise, and the middles of the scans; whole scans in a long run, since they take the mesher seconds
// each and the count by columns minutes.
std::vector<Named> smoothAndNoisy() {
  std::vector<Named> volumes;
  for (const char* name : {"phantom:knot?size=64", "phantom:sphere?size=64", "phantom:gyroid?size=48"})
    volumes.push_back({name, loadVolume(name), true});
  volumes.push_back({"smoothed noise", smoothedNoise({48, 40, 44}, 7, {1e-3, 1e-3, 1e-3})});
  volumes.push_back({"smoothed noise of thick slices", smoothedNoise({48, 40, 44}, 8, {1e-3, 1e-3, 6e-3})});
  for (const auto& scan : realScans()) {
    Volume whole = loadVolume(scan.string());
    volumes.push_back({scan.filename().string(), isLongRun() ? std::move(whole) : middleOf(whole, 56)});
  }
  return volumes;
}

double isovalueOf(const Volume& volume) {
  return volume.facts().declared_isovalue.value_or(defaultIsovalue(volume));
}

// The count by columns with 16 and with 8 columns a side differs by 1e-4 on these volumes, and its error falls with the
// square.
TEST(TrilinearMesh, EnclosesTheTrilinearVolume) {
  for (const Named& of : smoothAndNoisy()) {
    const double isovalue = isovalueOf(of.volume);
    const double exact_m3 = trilinearVolume_m3(of.volume, static_cast<float>(isovalue));
    constexpr double kWithin = 2e-3;
    const double kept = meshVolume_m3(isosurfaceMesh(of.volume, isovalue)) / exact_m3;
    const double coarse = meshVolume_m3(isosurfaceMesh(of.volume, isovalue, 1e-12)) / exact_m3;
    EXPECT_NEAR(kept, 1, kWithin) << of.name << " at " << isovalue;
    // Vertices on edges alone leave out more of a chest.
    if (of.name.starts_with("ct_chest_totalseg")) {
      EXPECT_LT(coarse, 1 - 1.25 * kWithin) << of.name;
    }
    if (isLongRun()) std::cout << of.name << ": keeps " << kept << ", above adaptivity 0 " << coarse << "\n";
  }
}

// A facet should face down the field's slope at its middle, in the world. In noise a cell's surface may bend more than
// its facets follow (docs/convert.md counts such facets of whole scans: a long run prints them). Smooth objects have
// none.
TEST(TrilinearMesh, FacetsFaceDownTheSlope) {
  for (const Named& of : smoothAndNoisy()) {
    const TriangleMesh mesh = isosurfaceMesh(of.volume, isovalueOf(of.volume));
    const reference::DenseField field = reference::denseField(of.volume);
    const Lattice& lattice = of.volume.lattice();
    const Vec3 last_I = (of.volume.size().cast<double>().array() - 1).matrix();
    double all = 0, all_area = 0, up = 0, up_area = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices_W[t[0]], b = mesh.vertices_W[t[1]], c = mesh.vertices_W[t[2]];
      const Vec3 normal_W = (b - a).cross(c - a), middle = lattice.toIndex((a + b + c) / 3);
      if (((middle.array() < 1e-9) || (middle.array() > last_I.array() - 1e-9)).any()) continue;  // on the border
      // Along each axis the field is linear in the cell, so a difference within it is the slope.
      Vec3 slope;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 low = middle, high = middle;
        low[axis] = std::floor(middle[axis]);
        high[axis] = low[axis] + 1;
        slope[axis] = reference::trilinear(field, high) - reference::trilinear(field, low);
      }
      const bool faces_up = normal_W.dot(lattice.R_WL * slope.cwiseQuotient(lattice.spacing_m)) > 0;
      all += 1;
      all_area += normal_W.norm();
      up += faces_up ? 1 : 0;
      up_area += faces_up ? normal_W.norm() : 0;
    }
    EXPECT_LE(up / all, of.is_smooth ? 0 : kMostUp) << of.name;
    EXPECT_LE(up_area / all_area, of.is_smooth ? 0 : kMostUp / 2) << of.name;
    if (isLongRun()) std::cout << of.name << ": up " << up / all << ", of the area " << up_area / all_area << "\n";
  }
}

}  // namespace trilinear_mesh_test
}  // namespace palpate
