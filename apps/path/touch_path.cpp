// SPDX-License-Identifier: Apache-2.0
#include "apps/path/touch_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "apps/path/object_pieces.hpp"
#include "apps/path/path_fit.hpp"
#include "apps/path/pressed_curve.hpp"
#include "apps/path/start_search.hpp"
#include "apps/path/surface_march.hpp"
#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr std::array<const char*, 4> kPhaseNames = {"approach", "press", "slide", "retreat"};
constexpr std::array<double, 5> kPhaseShares = {0, 0.15, 0.30, 0.85, 1};  // of the duration
constexpr int kSlideDirections = 8;                                       // tried when no direction is wished
constexpr double kMostPoints = 1e6;
constexpr double kMostVoxels = 16000;                            // that a path goes along or away from the surface
constexpr double kFreeShare = 0.8;                               // of the room in front of an obstacle that is used
constexpr std::array<double, 4> kTilts = {0.35, 0.7, 1.0, 1.2};  // from the normal, where that is not free [rad]
constexpr int kTurns = 12;                                       // around it
constexpr double kClearlyFreer = 1.2;
constexpr std::size_t kMostPieces = 16;  // that are tried, the largest first
constexpr double kGrazing = 1e-3;        // sine below which a direction counts as along the normal

void checkLength(const char* name, const std::optional<double>& value, const char* unit, bool may_be_zero) {
  if (!value || (std::isfinite(*value) && (may_be_zero ? *value >= 0 : *value > 0))) return;
  refuse(name, fmt::format("{:g} {} is not possible", *value, unit),
         may_be_zero ? "give 0 or more" : "give more than 0");
}

void checkDirection(const char* name, const std::optional<Vec3>& direction_W) {
  if (!direction_W || (direction_W->allFinite() && direction_W->norm() > 0)) return;
  refuse(name, "it is not a direction", "give three finite numbers that are not all zero");
}

void checkRequest(const PathRequest& request) {
  checkLength("path duration", request.duration_s, "s", false);
  checkLength("path approach", request.approach_m, "m", false);
  checkLength("path press depth", request.press_depth_m, "m", true);
  checkLength("path slide length", request.slide_length_m, "m", true);
  checkDirection("path toward", request.toward_W);
  checkDirection("path slide", request.slide_W);
  if (request.start_W && !request.start_W->allFinite())
    refuse("path start", "it is not a point", "give three finite numbers");
}

// A path is followed in steps of a voxel or less, so one of very many voxels would take minutes. So small voxels are
// most often a mistake of the unit.
void checkAgainstVoxels(const SurfaceField& field, const PathRequest& request) {
  const double spacing_m = field.lattice().smallestSpacing();
  const double longest_m = field.size().cast<double>().cwiseProduct(field.lattice().spacing_m).maxCoeff();
  struct Length {
    const char* name;
    const char* flag;
    std::optional<double> wish_m;
    double most_m;
  };
  const double most_m = kMostVoxels * spacing_m;
  for (const auto& [name, flag, wish_m, limit_m] :
       {Length{"path slide length", "--slide", request.slide_length_m, most_m},
        Length{"path approach", "--approach", request.approach_m, most_m},
        Length{"path press depth", "--depth", request.press_depth_m, std::min(most_m, longest_m)}}) {
    const double length_m = wish_m.value_or(0);
    if (length_m <= limit_m) continue;
    refuse(name,
           fmt::format("{:g} mm are {:.3g} voxels of {:g} mm, and the whole volume is {:.3g} mm long",
                       length_m * kMillimetresPerMetre, length_m / spacing_m, spacing_m * kMillimetresPerMetre,
                       longest_m * kMillimetresPerMetre),
           fmt::format("make it shorter ({}); "
                       "or, if metres were taken for millimetres, write the true voxel size into the file",
                       flag));
  }
}

// Sum of the angles between neighbouring normals: how much a curve bends [rad].
double turning(const SurfaceCurve& curve) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    sum += std::acos(std::clamp(curve.points[i].normal_W.dot(curve.points[i - 1].normal_W), -1.0, 1.0));
  }
  return sum;
}

// Tries evenly spread directions. Takes the longest curve, and among equally long ones that which bends least.
SurfaceCurve chooseSlide(const SurfaceField& field, const SurfaceHit& start, double length_m, OverEdges over_edges) {
  const Vec3 u_W = start.normal_W.unitOrthogonal(), v_W = start.normal_W.cross(u_W);
  SurfaceCurve best;
  for (int i = 0; i < kSlideDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSlideDirections;
    SurfaceCurve curve =
        marchSurface(field, start, std::cos(angle) * u_W + std::sin(angle) * v_W, length_m, over_edges);
    const bool same_length = !best.points.empty() && curve.points.size() == best.points.size();
    if (best.points.empty() || curve.points.size() > best.points.size() ||
        (same_length && turning(curve) < turning(best) - 0.01)) {
      best = std::move(curve);
    }
  }
  return best;
}

SurfaceCurve slideCurve(const SurfaceField& field, const SurfaceHit& start, const PathRequest& request,
                        double length_m) {
  if (!request.slide_W) return chooseSlide(field, start, length_m, request.over_edges);
  if (request.slide_W->normalized().cross(start.normal_W).norm() < kGrazing) {
    refuse("path slide", "its direction is along the surface normal, where no slide is possible",
           "give another direction");
  }
  return marchSurface(field, start, *request.slide_W, length_m, request.over_edges);
}

// A way through free space to or from a surface point.
struct OpenWay {
  Vec3 direction_W = Vec3::Zero();  // unit, away from the surface
  double length_m = 0;
};

// The free length of a line that begins in the object: from where it leaves the object to where it enters again or ends
// [m]. 0 if it never leaves.
double freeEnd(const SurfaceField& field, const Vec3& from_W, const Vec3& to_W) {
  const double length_m = (to_W - from_W).norm();
  const double step_m = 0.25 * field.lattice().smallestSpacing();
  double out_m = -1;
  for (double s = 0; s < length_m; s += step_m) {
    // Beyond the volume is free space, and a straight line does not come back from there.
    const auto height = heightAt(field, from_W + s / length_m * (to_W - from_W));
    if (!height) return out_m < 0 ? length_m - s : length_m - out_m;
    if (*height <= 0 && out_m < 0) out_m = s;
    if (*height > 0 && out_m >= 0) return s - step_m - out_m;
  }
  return out_m < 0 ? 0 : length_m - out_m;
}

// The way out of the object from `depth_m` under a surface point: along the normal if that is free over `wish_m`, else
// in the direction with the most room, up to `wish_m`.
OpenWay openWay(const SurfaceField& field, const SurfaceHit& at, double depth_m, double wish_m) {
  OpenWay best = {at.normal_W, freeDistance(field, at, at.normal_W, wish_m)};
  if (best.length_m >= wish_m) return best;
  best.length_m *= kFreeShare;
  const Vec3 u_W = at.normal_W.unitOrthogonal(), v_W = at.normal_W.cross(u_W);
  const Vec3 low_W = at.p_W - depth_m * at.normal_W;
  for (const double tilt : kTilts) {
    for (int i = 0; i < kTurns; ++i) {
      const double turn = 2 * std::numbers::pi * i / kTurns;
      const Vec3 direction_W =
          std::cos(tilt) * at.normal_W + std::sin(tilt) * (std::cos(turn) * u_W + std::sin(turn) * v_W);
      const double free_m = freeEnd(field, low_W, at.p_W + wish_m * direction_W);
      const double length_m = free_m >= 0.95 * wish_m ? wish_m : kFreeShare * std::min(free_m, wish_m);
      if (length_m > kClearlyFreer * best.length_m) best = {direction_W, length_m};
    }
  }
  return best;
}

// The requested direction, or the freest. Unit, from the surface towards the tool's first position.
OpenWay approachWay(const SurfaceField& field, const SurfaceHit& start, const PathRequest& request, double wish_m) {
  if (!request.toward_W) return openWay(field, start, 0, wish_m);
  const Vec3 from_W = -request.toward_W->normalized();
  if (from_W.dot(start.normal_W) < kGrazing) {
    refuse("path toward", "in this direction the tool would reach the start from inside the object",
           "give the opposite direction or another start");
  }
  const double free_m = freeDistance(field, start, from_W, wish_m);
  return {from_W, free_m >= wish_m ? wish_m : kFreeShare * free_m};
}

void noteShort(const OpenWay& way, double wish_m, const char* phase, std::vector<std::string>& notes) {
  if (way.length_m >= wish_m) return;
  notes.push_back(fmt::format("the {} is {:.3g} mm instead of {:.3g} mm: the object is in the way", phase,
                              way.length_m * kMillimetresPerMetre, wish_m * kMillimetresPerMetre));
}

double minimumJerk(double t) {
  return t * t * t * (10 + t * (6 * t - 15));
}

std::vector<PathPhase> phasesOf(double duration_s) {
  std::vector<PathPhase> phases;
  for (std::size_t i = 0; i < kPhaseNames.size(); ++i) {
    phases.push_back({kPhaseNames[i], kPhaseShares[i] * duration_s, kPhaseShares[i + 1] * duration_s});
  }
  return phases;
}

// Position within each phase for a share 0..1 of its way.
using Way = std::function<Vec3(double)>;

std::vector<TimedPoint> samplePhases(const std::vector<PathPhase>& phases, const std::array<Way, 4>& ways) {
  const double duration_s = phases.back().end_s;
  const double count = std::min(std::max(std::ceil(duration_s / kPathInterval_s), 8.0), kMostPoints);
  std::vector<TimedPoint> points;
  for (double i = 0; i <= count; ++i) {
    const double time_s = duration_s * (i / count);
    std::size_t now = 0;
    while (now + 1 < phases.size() && time_s >= phases[now].end_s) ++now;
    const double share = (time_s - phases[now].begin_s) / (phases[now].end_s - phases[now].begin_s);
    points.push_back({time_s, ways[now](minimumJerk(std::clamp(share, 0.0, 1.0)))});
  }
  return points;
}

// The largest piece that the tool can reach.
std::pair<SurfaceHit, PathFit> startAndFit(const SurfaceField& field, const PathRequest& request) {
  const ObjectPieces pieces(field);
  const double voxel_m = field.lattice().smallestSpacing();
  const auto fitOf = [&](std::size_t piece) { return fitTo(sizeOf(pieces.all()[piece], field.lattice()), voxel_m); };
  if (request.start_W) {
    const SurfaceHit start = startNear(field, *request.start_W);
    return {start, fitOf(pieces.pieceAt(start.p_W).value_or(0))};
  }
  for (std::size_t piece = 0; piece < std::min(pieces.all().size(), kMostPieces); ++piece) {
    const PathFit fit = fitOf(piece);
    const double approach_m = request.approach_m.value_or(fit.approach_m);
    if (const auto start = startOn(field, pieces, piece, request.toward_W, approach_m)) return {*start, fit};
  }
  refuse("path", fmt::format("no ray into the volume meets a surface at isovalue {:g}", field.isovalue()),
         "the isovalue may be wrong: choose another, or give a path start near the surface");
}

void noteSlide(const SurfaceCurve& surface, const PathRequest& request, std::vector<std::string>& notes) {
  if (request.slide_length_m && surface.length() < *request.slide_length_m * (1 - 1e-9)) {
    notes.push_back(
        fmt::format("the slide is {:.3g} mm instead of {:.3g} mm: the surface ends at the border of the volume",
                    surface.length() * kMillimetresPerMetre, *request.slide_length_m * kMillimetresPerMetre));
  }
  if (surface.free_m > 0) {
    notes.push_back(fmt::format("{:.3g} mm of the slide go straight on where the surface falls away",
                                surface.free_m * kMillimetresPerMetre));
  }
}

}  // namespace

TouchPath buildTouchPath(const SurfaceField& field, const PathRequest& request) {
  checkRequest(request);
  checkAgainstVoxels(field, request);
  TouchPath path;
  const auto [start, fit] = startAndFit(field, request);
  path.start = start;
  const double approach_wish_m = request.approach_m.value_or(fit.approach_m);
  const OpenWay approach = approachWay(field, start, request, approach_wish_m);
  const SurfaceCurve surface = slideCurve(field, start, request, request.slide_length_m.value_or(fit.slide_m));
  const SurfaceHit& end = surface.points.back();
  path.slid_m = surface.length();
  if (surface.points.size() > 1) path.slide_W = (surface.points[1].p_W - start.p_W).normalized();
  noteSlide(surface, request, path.notes);
  path.depth_m = request.press_depth_m ? *request.press_depth_m : depthFor(field, surface, fit);
  const PressedCurve pressed(surface, path.depth_m, field.lattice().smallestSpacing());
  if (request.over_edges == OverEdges::kFollow && path.depth_m > 0) {
    if (const double share = pressed.shareOutside(field); share > 0) {
      path.notes.push_back(
          fmt::format("over {:.3g} mm of the slide the path is not in the object: "
                      "at a depth of {:.3g} mm it comes out on another side; press less deep, or slide elsewhere",
                      share * path.slid_m * kMillimetresPerMetre, path.depth_m * kMillimetresPerMetre));
    }
  }
  const OpenWay retreat = openWay(field, end, path.depth_m, approach_wish_m);
  noteShort(approach, approach_wish_m, "approach", path.notes);
  noteShort(retreat, approach_wish_m, "retreat", path.notes);
  path.approach_m = approach.length_m;

  const Vec3 begin_W = start.p_W, low_W = pressed.at(0), last_W = pressed.at(1);
  const Vec3 free_W = end.p_W + retreat.length_m * retreat.direction_W;
  path.phases = phasesOf(request.duration_s);
  path.points = samplePhases(
      path.phases, {[&](double s) -> Vec3 { return begin_W + (1 - s) * approach.length_m * approach.direction_W; },
                    [&](double s) -> Vec3 { return begin_W + s * (low_W - begin_W); },
                    [&](double s) -> Vec3 { return pressed.at(s); },
                    [&](double s) -> Vec3 { return last_W + s * (free_W - last_W); }});
  return path;
}

}  // namespace palpate
