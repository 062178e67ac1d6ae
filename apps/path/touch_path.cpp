// SPDX-License-Identifier: Apache-2.0
#include "apps/path/touch_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <fmt/format.h>

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
constexpr double kFreeShare = 0.8;     // of the room in front of an obstacle that is used
constexpr double kMostVoxels = 16000;  // that a path goes along or away from the surface
constexpr double kGrazing = 1e-3;      // sine below which a direction counts as along the normal

[[noreturn]] void refuse(const std::string& input, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, input, reason, remedy);
}

void checkLength(const char* name, double value, const char* unit, bool may_be_zero) {
  if (std::isfinite(value) && (may_be_zero ? value >= 0 : value > 0)) return;
  refuse(name, fmt::format("{:g} {} is not possible", value, unit),
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
  const std::array<std::pair<const char*, double>, 3> lengths = {std::pair("path slide length", request.slide_length_m),
                                                                 std::pair("path approach", request.approach_m),
                                                                 std::pair("path press depth", request.press_depth_m)};
  for (const auto& [name, length_m] : lengths) {
    if (length_m <= kMostVoxels * spacing_m) continue;
    const double longest_m = field.size().cast<double>().cwiseProduct(field.lattice().spacing_m).maxCoeff();
    refuse(name,
           fmt::format("{:g} mm are {:.3g} voxels of {:g} mm, and the whole volume is {:.3g} mm long",
                       length_m * kMillimetresPerMetre, length_m / spacing_m, spacing_m * kMillimetresPerMetre,
                       longest_m * kMillimetresPerMetre),
           "make it shorter; or, if metres were taken for millimetres, write the true voxel size into the file");
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

// Of evenly spread directions the one that goes farthest, and of those the one that bends least.
SurfaceCurve chooseSlide(const SurfaceField& field, const SurfaceHit& start, const PathRequest& request) {
  const Vec3 u_W = start.normal_W.unitOrthogonal(), v_W = start.normal_W.cross(u_W);
  SurfaceCurve best;
  for (int i = 0; i < kSlideDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSlideDirections;
    SurfaceCurve curve = marchSurface(field, start, std::cos(angle) * u_W + std::sin(angle) * v_W,
                                      request.slide_length_m, request.over_edges);
    const bool same_length = !best.points.empty() && curve.points.size() == best.points.size();
    if (best.points.empty() || curve.points.size() > best.points.size() ||
        (same_length && turning(curve) < turning(best) - 0.01)) {
      best = std::move(curve);
    }
  }
  return best;
}

SurfaceCurve slideCurve(const SurfaceField& field, const SurfaceHit& start, const PathRequest& request) {
  if (!request.slide_W) return chooseSlide(field, start, request);
  if (request.slide_W->normalized().cross(start.normal_W).norm() < kGrazing) {
    refuse("path slide", "its direction is along the surface normal, where no slide is possible",
           "give another direction");
  }
  return marchSurface(field, start, *request.slide_W, request.slide_length_m, request.over_edges);
}

// Unit direction from the surface to where the tool comes from.
Vec3 comesFrom(const SurfaceHit& start, const PathRequest& request) {
  if (!request.toward_W) return start.normal_W;
  const Vec3 from_W = -request.toward_W->normalized();
  if (from_W.dot(start.normal_W) < kGrazing) {
    refuse("path toward", "in this direction the tool would reach the start from inside the object",
           "give the opposite direction or another start");
  }
  return from_W;
}

// Room for approach or retreat: as asked for, or what the object leaves; said in a note.
double roomAlong(const SurfaceField& field, const SurfaceHit& at, const Vec3& direction_W, double wish_m,
                 const char* phase, std::vector<std::string>& notes) {
  const double free_m = freeDistance(field, at, direction_W, wish_m);
  if (free_m >= wish_m) return wish_m;
  notes.push_back(fmt::format("the {} is {:.3g} mm instead of {:.3g} mm: the object is in the way", phase,
                              kFreeShare * free_m * kMillimetresPerMetre, wish_m * kMillimetresPerMetre));
  return kFreeShare * free_m;
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

}  // namespace

TouchPath buildTouchPath(const SurfaceField& field, const PathRequest& request) {
  checkRequest(request);
  checkAgainstVoxels(field, request);
  TouchPath path;
  path.start = chooseStart(field, request);
  const Vec3 from_W = comesFrom(path.start, request);
  const SurfaceCurve surface = slideCurve(field, path.start, request);
  const SurfaceHit& end = surface.points.back();
  path.slid_m = surface.length();
  if (surface.points.size() > 1) path.slide_W = (surface.points[1].p_W - path.start.p_W).normalized();
  if (path.slid_m < request.slide_length_m * (1 - 1e-9)) {
    path.notes.push_back(
        fmt::format("the slide is {:.3g} mm instead of {:.3g} mm: the surface ends at the border of the volume",
                    path.slid_m * kMillimetresPerMetre, request.slide_length_m * kMillimetresPerMetre));
  }
  if (surface.free_m > 0) {
    path.notes.push_back(fmt::format("{:.3g} mm of the slide go straight on where the surface falls away",
                                     surface.free_m * kMillimetresPerMetre));
  }

  const PressedCurve pressed(surface, request.press_depth_m, field.lattice().smallestSpacing());
  const double approach_m = roomAlong(field, path.start, from_W, request.approach_m, "approach", path.notes);
  const double retreat_m = roomAlong(field, end, end.normal_W, request.approach_m, "retreat", path.notes);
  const Vec3 begin_W = path.start.p_W, low_W = pressed.at(0), last_W = pressed.at(1);
  path.phases = phasesOf(request.duration_s);
  path.points = samplePhases(
      path.phases, {[&](double s) -> Vec3 { return begin_W + (1 - s) * approach_m * from_W; },
                    [&](double s) -> Vec3 { return begin_W + s * (low_W - begin_W); },
                    [&](double s) -> Vec3 { return pressed.at(s); },
                    [&](double s) -> Vec3 { return last_W + s * (request.press_depth_m + retreat_m) * end.normal_W; }});
  return path;
}

}  // namespace palpate
