// SPDX-License-Identifier: Apache-2.0
// The study of the servo: algorithm x n x hand speed x noise x depth x curvature, against the cost of a tick.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

#include <fmt/format.h>

#include "apps/bench/tick_cost.hpp"
#include "apps/scene/scene.hpp"
#include "apps/study/shared.hpp"
#include "apps/study/studies.hpp"

namespace palpate {
namespace {

constexpr double kServoVoxel_m = 0.5e-3;
// Balls of this many voxels along an edge, whose radius is 0.35 (size - 1) voxels: 5.1 and 20 mm.
constexpr int kSmallBall = 30, kLargeBall = 115;
constexpr double kServoSpeed_m_per_s = 0.1, kServoFast_m_per_s = 0.5, kServoNoise_voxel = 0.25;

double ballRadius_m(int size) {
  return 0.35 * (size - 1) * kServoVoxel_m;
}

std::string ballInWords(int size) {
  return fmt::format("{:.2g} mm", 1e3 * ballRadius_m(size));
}

// Where the tool goes, and over what.
struct ServoPlace {
  int size = kLargeBall;
  double speed_m_per_s = kServoSpeed_m_per_s, noise_voxel = 0, depth_voxel = 1;
  [[nodiscard]] auto key() const { return std::tuple(size, speed_m_per_s, noise_voxel, depth_voxel); }
  bool operator<(const ServoPlace& other) const { return key() < other.key(); }
};

// What the cells of this study share.
class ServoStage {
 public:
  explicit ServoStage(const StudySettings& settings) : seed_(settings.seed), ticks_(settings.quick ? 600 : 2000) {}

  CellFigures run(const ServoPlace& place, const std::string& algorithm, int n) {
    Entrant& entrant = entrants_.of({place.size, place.noise_voxel, algorithm, n}, [&] {
      return std::make_unique<Entrant>(makeEntrant(volumeOf(place), algorithm, n));
    });
    return {errors(place, entrant), {{"cost_ns", cost_ns(place, entrant)}}};
  }

 private:
  const BenchVolume& volumeOf(const ServoPlace& place) {
    return volumes_.of({place.size, place.noise_voxel}, [&] {
      const std::string name = fmt::format("phantom:sphere?size={}&spacing={}mm", place.size, 1e3 * kServoVoxel_m);
      return std::make_unique<BenchVolume>(withNoise(name, place.noise_voxel, seed_));
    });
  }

  [[nodiscard]] ContactPath makePath(const ServoPlace& place, std::size_t ticks) {
    return contactPath(volumeOf(place), {.speed_m_per_s = place.speed_m_per_s,
                                         .rate_hz = kBenchRate_hz,
                                         .depth_voxel = place.depth_voxel,
                                         .ticks = ticks,
                                         .seed = seed_});
  }

  BenchRow errors(const ServoPlace& place, Entrant& entrant) {
    const ContactPath& path = paths_.of(place, [&] { return std::make_unique<ContactPath>(makePath(place, ticks_)); });
    const TouchErrors found =
        touchErrors(
            volumeOf(place), path, std::span(&entrant, 1), [](double) {}, missDepth_voxel(place.noise_voxel))
            .front();
    BenchRow row;
    addFigures(row, errorColumns(), found);
    const bool shows = entrant.traits.shows_surface && found.vhip_voxel.count > 0;
    row.emplace_back("vhip_error_max_um",
                     shows ? 1e6 * kServoVoxel_m * found.vhip_voxel.max : std::numeric_limits<double>::quiet_NaN());
    return row;
  }

  // The slide that is timed: long enough for four planes, and short enough that its windows need little memory. It is
  // repeated until there are some thousand ticks.
  double cost_ns(const ServoPlace& place, Entrant& entrant) {
    constexpr double kWay_voxel = 60, kLeastTicks = 200, kTicks = 3000;
    const ReplayPath& path = replays_.of(place, [&] {
      const double step_voxel = place.speed_m_per_s / kBenchRate_hz / kServoVoxel_m;
      const double slide = std::max(kLeastTicks, kWay_voxel / step_voxel);
      const double approach = std::ceil((place.depth_voxel + 2) / step_voxel);
      return std::make_unique<ReplayPath>(volumeOf(place), makePath(place, static_cast<std::size_t>(slide + approach)));
    });
    const int replays = std::max(1, static_cast<int>(kTicks / static_cast<double>(path.slideTicks())));
    double sum_ns = 0;
    for (int i = 0; i < replays; ++i) sum_ns += path.replay_ns(*entrant.haptic);
    return sum_ns / replays;
  }

  std::uint64_t seed_;
  std::size_t ticks_;  // of the paths along which errors are measured
  Shared<std::pair<int, double>, BenchVolume> volumes_;
  Shared<ServoPlace, ContactPath> paths_;
  Shared<ServoPlace, ReplayPath> replays_;
  Shared<std::tuple<int, double, std::string, int>, Entrant> entrants_;
};

// How far the tool has gone along the surface when its plane is renewed. The paper's counter goes through n + 1 ticks.
double wayBetweenPlanes_m(const ServoPlace& place, const AlgorithmEntry& algorithm, int n) {
  const int ticks = algorithm.name.starts_with("hri-paper") ? n + 1 : n;
  return place.speed_m_per_s * ticks / kBenchRate_hz;
}

BenchRow servoParameters(const ServoPlace& place, const AlgorithmEntry& algorithm, int n) {
  const double way_m = wayBetweenPlanes_m(place, algorithm, n);
  return {{"algorithm", std::string(algorithm.name)},
          {"n_ticks", std::int64_t{n}},
          {"n", algorithm.traits.renews_planes ? fmt::format("n={}", n) : ""},
          {"renews_planes", algorithm.traits.renews_planes ? "yes" : "no"},
          {"speed_m_per_s", place.speed_m_per_s},
          {"noise_voxel", place.noise_voxel},
          {"depth_voxel", place.depth_voxel},
          {"radius", ballInWords(place.size)},
          {"age_way_mm", 1e3 * way_m},
          {"age_bound_um", 1e6 * algorithm.plane_age_error({.speed_m_per_s = place.speed_m_per_s,
                                                            .rate_hz = kBenchRate_hz,
                                                            .n = n,
                                                            .curvature_per_m = 1 / ballRadius_m(place.size),
                                                            .depth_m = place.depth_voxel * kServoVoxel_m,
                                                            .voxel_m = kServoVoxel_m})}};
}

std::vector<StudyCell> servoCells(const StudySettings& settings) {
  const bool quick = settings.quick;
  const auto stage = std::make_shared<ServoStage>(settings);
  const std::vector<int> sizes = quick ? std::vector{kLargeBall} : std::vector{kSmallBall, kLargeBall};
  const std::vector<double> depths = quick ? std::vector{1.0} : std::vector{1.0, 4.0};
  const std::vector<double> speeds = quick ? std::vector{0.1, 0.5} : std::vector{0.02, 0.1, 0.2, 0.5};
  const std::vector<int> renewals = quick ? std::vector{1, 5, 10, 20, 50} : std::vector{1, 2, 5, 10, 20, 50, 100};
  std::vector<StudyCell> cells;
  for (const int size : sizes) {
    for (const double noise : {0.0, kServoNoise_voxel}) {
      for (const double depth : depths) {
        for (const double speed : speeds) {
          const ServoPlace place = {size, speed, noise, depth};
          for (const AlgorithmEntry& entry : algorithms()) {
            for (const int n : entry.traits.renews_planes ? renewals : std::vector{1}) {
              cells.push_back({servoParameters(place, entry, n), [stage, place, name = std::string(entry.name), n] {
                                 return stage->run(place, name, n);
                               }});
            }
          }
        }
      }
    }
  }
  return cells;
}

std::vector<StudyPlot> servoPlots(bool /*quick*/) {
  const auto at = [](double speed, double noise) {
    return BenchRow{{"radius", ballInWords(kLargeBall)},
                    {"speed_m_per_s", speed},
                    {"noise_voxel", noise},
                    {"depth_voxel", 1.0},
                    {"fall_throughs", std::int64_t{0}}};
  };
  const BenchRow usual = at(kServoSpeed_m_per_s, 0), noisy = at(kServoSpeed_m_per_s, kServoNoise_voxel),
                 fast = at(kServoFast_m_per_s, 0);
  const BenchRow standard = {{"algorithm", Scene{}.algorithm}, {"n_ticks", std::int64_t{Scene{}.plane_renewal_ticks}}};
  const auto plot = [&](const std::string& title, const BenchRow& like, const char* y, const char* y_label) {
    return StudyPlot{.title = title,
                     .like = like,
                     .x = "cost_ns",
                     .x_label = "cost of a tick [ns]",
                     .y = y,
                     .y_label = y_label,
                     .series = {"algorithm"},
                     .labels = {"n"},
                     .standard = standard,
                     .own = "algorithm"};
  };
  std::vector<StudyPlot> plots = {
      plot("position", usual, "vhip_error_p99_voxel", "error of the position, p99 [voxel]"),
      plot("position, noise", noisy, "vhip_error_p99_voxel", "error of the position, p99 [voxel]"),
      plot("position, 0.5 m/s", fast, "vhip_error_p99_voxel", "error of the position, p99 [voxel]"),
      plot("force", usual, "force_error_p99_percent", "error of the force, p99 [%]"),
      plot("angle", usual, "force_angle_p99_deg", "angle of the force off the normal, p99 [degree]"),
      plot("angle, noise", noisy, "force_angle_p99_deg", "angle of the force off the normal, p99 [degree]"),
      plot("jump", usual, "force_jump_max_N", "largest change of the force in a tick [N]")};
  BenchRow planes = {{"radius", ballInWords(kLargeBall)},
                     {"noise_voxel", 0.0},
                     {"depth_voxel", 1.0},
                     {"renews_planes", "yes"},
                     {"fall_throughs", std::int64_t{0}}};
  plots.push_back({.title = "age of the plane",
                   .like = std::move(planes),
                   .x = "age_way_mm",
                   .x_label = "way of the hand between planes, v n T [mm]",
                   .y = "vhip_error_max_um",
                   .y_label = "largest error of the position [um]",
                   .series = {"algorithm"},
                   .labels = {},
                   .front = false,
                   .lines = {{"(v n T)^2 / (2 R)", [](double way_mm) {
                                return 1e6 *
                                       PlaneAge{.curvature_per_m = 1 / ballRadius_m(kLargeBall)}.sag(1e-3 * way_mm);
                              }}}});
  return plots;
}

// A plane that is kept for n ticks of T is off by its sag (v n T)^2 / (2 R); the paper's modes keep theirs for n + 1.
// hri renews a plane earlier where it would be that wrong, and puts it ahead of the tool; so the formula is a bound for
// it, not its error.
double orderOfAge(const BenchRow& row) {
  const bool ages = textOf(row, "algorithm") != "hri";
  return ages ? 2 : std::numeric_limits<double>::quiet_NaN();
}

// From three voxels on: there the sag of the plane is 18 times that of trilinear interpolation, h^2 / (4 R). Up to 0.3
// of the radius: there the sag's next term is 2 % of the first.
std::vector<StudyOrder> servoOrders(bool /*quick*/) {
  return {{.what = "largest error of the position against v n T",
           .like = {{"radius", ballInWords(kLargeBall)},
                    {"noise_voxel", 0.0},
                    {"depth_voxel", 1.0},
                    {"renews_planes", "yes"},
                    {"fall_throughs", std::int64_t{0}}},
           .family = {"algorithm"},
           .x = "age_way_mm",
           .y = "vhip_error_max_um",
           .least = 3e3 * kServoVoxel_m,
           .most = 0.3e3 * ballRadius_m(kLargeBall),
           .theory = orderOfAge}};
}

void servoPromises(BenchResult& result) {
  // Trilinear interpolation is off by h^2 / (4 R) at most, to the first order; the next one is (h / R)^2 of it, a
  // percent for the smaller ball.
  constexpr double kMostOfBound = 1.01;
  double worst = 0;
  const BenchRows rows = rowsOf(result, "servo", {{"algorithm", "hri"}, {"noise_voxel", 0.0}});
  for (const BenchRow* row : rows) {
    const auto error_um = numberIn(*row, "vhip_error_max_um");
    const double radius =
        textOf(*row, "radius") == ballInWords(kLargeBall) ? ballRadius_m(kLargeBall) : ballRadius_m(kSmallBall);
    const double sampled_um = 1e6 * kServoVoxel_m * kServoVoxel_m / (4 * radius);
    const auto bound_um = numberIn(*row, "age_bound_um");
    if (error_um && bound_um) worst = std::max(worst, *error_um / (*bound_um + sampled_um));
  }
  if (!rows.empty()) {
    result.targets.push_back(
        {"hri, no noise, any n and speed: largest error of the position / (what its planes' age allows + h^2 / 4R) [-]",
         worst, kMostOfBound});
  }
  promise(result, {.name = "hri, up to 0.5 m/s, any n, noise up to 0.25 voxel: contacts lost [-]",
                   .bound = 0,
                   .part = "servo",
                   .like = {{"algorithm", "hri"}},
                   .keys = {"fall_throughs"},
                   .of = sumOf});
  promise(result, {.name = fmt::format("{} at n={}: rivals that cost less and err less in position [-]",
                                       Scene{}.algorithm, Scene{}.plane_renewal_ticks),
                   .bound = 0,
                   .part = "default",
                   .like = {{"study", "servo"}, {"plot", "position"}},
                   .keys = {"beaten_by_rivals"},
                   .of = sumOf});
}

constexpr const char* kServoWords = R"(
A tool wanders over a ball with voxels of 0.5 mm, pressed in by 1 or 4 voxels, 1000 ticks a second, K = 500 N/m, B = 0; windows
follow as in the program.
Errors are against the ball itself: the VHIP's distance from its surface, the force against K times the depth, the force's
angle against the normal, the largest change of the force from one tick to the next.
Cost: the mean of a tick over a slide without reading the clock in between.
Algorithms that renew no planes look at the volume in every tick; a cell that lost contact is not in the plots.
Plots: a ball of 20 mm, 1 voxel deep, 0.1 m/s and no noise, where the title says nothing else; noise moves the surface by a
quarter of a voxel.)";

}  // namespace

Study servoStudy() {
  return {.name = "servo",
          .title = "Servo: error against the cost of a tick",
          .words = asParagraph(kServoWords),
          .seconds = 150,
          .quick_seconds = 10,
          .cells = servoCells,
          .plots = servoPlots,
          .orders = servoOrders,
          .promise = servoPromises,
          .counts = {"fall_throughs", "missed_ticks"},
          .counts_by = {"algorithm"}};
}

}  // namespace palpate
