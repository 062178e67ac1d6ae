// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/live_bench.hpp"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <optional>
#include <thread>
#include <vector>

#include "apps/bench/columns.hpp"
#include "apps/bench/field_bench.hpp"
#include "apps/bench/head_volume.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/sculpt/brush_choice.hpp"
#include "apps/sculpt/orbit_view.hpp"
#include "apps/sculpt/pointer_tool.hpp"
#include "apps/sculpt/sculpt_session.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr const char* kNothing = "nothing";
constexpr const char* kStanding = "camera stands";
constexpr const char* kTurning = "camera turns";
constexpr double kStanding_ms = 1000.0 / 30, kTurning_ms = 1000.0 / 15;  // between pictures
constexpr double kMostToPixel_ms = 2 * kStanding_ms;
constexpr double kMostSettling_ms = 700, kMostReady_s = 2, kMostOfUndrawn = 1.2;

constexpr double kRound_s = 6;       // time in which the tool goes round the circle
constexpr double kTurn_rad_s = 0.6;  // of the camera
constexpr double kAsked_s = 1.0 / 60;
constexpr std::chrono::milliseconds kLook{1};
constexpr double kPatience_s = 60;  // for something that surely comes

struct LiveRow {
  std::string volume, drawn;
  double seconds;
  std::int64_t edits, pictures;
  double between_ms;  // mean time between pictures: fine ones while the camera stands, of a camera each while it turns
  Percentiles to_pixel_ms;  // from an edit to the first picture that shows it
  double settling_ms;       // from the camera's last movement to a whole picture
  double ready_s;           // from the request to the first whole picture
  Percentiles lateness_us, window_age_ms;
  std::int64_t stale_ticks;
  double resident_MiB;         // of this process, at the session's end
  double late_over, age_over;  // their p99.9 and p99 over those of the undrawn session of the same turn
};

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

const Columns<LiveRow>& liveColumns() {
  static const Columns<LiveRow> kColumns = {
      {"volume", &LiveRow::volume},
      {"drawn", &LiveRow::drawn, {"drawn", ""}},
      {"seconds", &LiveRow::seconds},
      {"edits", &LiveRow::edits, {"edits", ""}},
      {"pictures", &LiveRow::pictures, {"pictures", ""}},
      {"between_pictures_ms", &LiveRow::between_ms, {"between", "ms", 1}},
      {"edit_to_pixel_median_ms", [](const LiveRow& row) { return row.to_pixel_ms.p50; }, {"to pixel", "ms", 1}},
      {"edit_to_pixel_p99_ms", [](const LiveRow& row) { return row.to_pixel_ms.p99; }, {"p99", "ms", 1}},
      {"settling_ms", &LiveRow::settling_ms, {"settling", "ms", 0}},
      {"ready_s", &LiveRow::ready_s, {"ready", "s", 2}},
      {"lateness_median_us", [](const LiveRow& row) { return row.lateness_us.p50; }, {"late", "us", 1}},
      {"lateness_p999_us", [](const LiveRow& row) { return row.lateness_us.p999; }, {"p99.9", "us", 1}},
      {"lateness_over_undrawn", &LiveRow::late_over, {"ratio", "-", 2}},
      {"window_age_p99_ms", [](const LiveRow& row) { return row.window_age_ms.p99; }, {"age p99", "ms", 2}},
      {"window_age_max_ms", [](const LiveRow& row) { return row.window_age_ms.max; }, {"max", "ms", 1}},
      {"window_age_over_undrawn", &LiveRow::age_over, {"ratio", "-", 2}},
      {"stale_ticks", &LiveRow::stale_ticks, {"stale", "tick"}},
      {"resident_MiB", &LiveRow::resident_MiB, {"memory", "MiB", 0}}};
  return kColumns;
}

double residentMiB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
  }
  return kNone;
}

// Places on the surface along a circle around the middle of what the picture shows.
std::vector<Vec3> circleOf(const ViewFrame& frame) {
  double x = 0, y = 0, hits = 0;
  for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
    if (!std::isfinite(frame.pixels[i].distance_m)) continue;
    x += static_cast<double>(i % static_cast<std::size_t>(frame.camera.width));
    const std::size_t row = i / static_cast<std::size_t>(frame.camera.width);
    y += static_cast<double>(row);
    ++hits;
  }
  std::vector<Vec3> places_W;
  const double radius_px = 0.15 * frame.camera.height;
  constexpr int kPlaces = 400;
  for (int i = 0; i < kPlaces && hits > 0; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPlaces;
    const auto surface_W =
        PointerTool::surface_W(frame, x / hits + radius_px * std::cos(angle), y / hits + radius_px * std::sin(angle));
    if (surface_W) places_W.push_back(*surface_W);
  }
  return places_W;
}

// A session that is watched while its tool drills.
class Watched {
 public:
  Watched(const LiveBenchRequest& request, const std::string& volume, Progress& progress)
      : request_(request),
        session_(requestOf(volume, request.gpu), progress),
        view_(session_.volume().object, request.width, request.height) {
    session_.start();
  }

  [[nodiscard]] const std::string& device() const noexcept { return session_.gpu().name; }

  // Shows a picture and waits until it is whole.
  const ViewFrame& draw() {
    show();
    if (waitFor([&] { return session_.view().latest().number > 0 && session_.view().latest().whole; }))
      ready_s_ = since_start_.seconds();
    return session_.view().latest();
  }

  // Begins in front of the first place, along the view.
  void drill(const std::vector<Vec3>& places_W, double seconds, double turn_rad_s) {
    const Vec3 inward_W = view_.camera().forward_W;
    turns_ = turn_rad_s != 0;
    session_.aim(Vec3(places_W.front() - 5e-3 * inward_W));
    wait(1);
    session_.takeTicks(ticks_);
    ticks_.clear();
    session_.press(toolBrush({.radius_m = 2e-3, .strength = 1}, {}));
    const std::uint64_t first_edit = session_.look().edits.edits;
    const Stopwatch watch;
    double asked_s = 0;
    while (watch.seconds() < seconds) {
      const double now_s = watch.seconds();
      const double way = now_s / kRound_s * static_cast<double>(places_W.size());
      session_.aim(Vec3(places_W[static_cast<std::size_t>(way) % places_W.size()] + 1e-3 * inward_W));
      if (turn_rad_s != 0 && now_s - asked_s >= kAsked_s) {
        view_.orbit(turn_rad_s * (now_s - asked_s) / std::numbers::pi * request_.height, 0);
        show();
        asked_s = now_s;
      }
      look(now_s);
      pause();
    }
    seconds_ = watch.seconds();
    edits_ = session_.look().edits.edits - first_edit;
    const std::int64_t pictures = pictures_;
    if (session_.view().latest().number > 0) {  // the last edits come to the picture, too
      static_cast<void>(waitFor([&] {
        look(watch.seconds());
        return waiting_.empty();
      }));
    }
    pictures_ = pictures;
    session_.release();
    session_.aim(Vec3(places_W.front() - 5e-3 * inward_W));
    if (turn_rad_s != 0) {
      view_.orbit(1, 0);
      show();
      const Camera last = view_.camera();
      const Stopwatch settling;
      if (waitFor([&] { return session_.view().latest().whole && session_.view().latest().camera == last; }))
        settling_ms_ = 1e3 * settling.seconds();
    }
  }

  LiveRow row(const std::string& drawn) {
    std::vector<double> lateness_us, age_ms;
    std::int64_t stale = 0;
    for (const TickRecord& tick : ticks_) {
      lateness_us.push_back(static_cast<double>(tick.lateness_ns) * 1e-3);
      age_ms.push_back(static_cast<double>(tick.window_age_ns) * 1e-6);
      stale += has(tick.faults, ServoFault::kStaleWindow) || has(tick.faults, ServoFault::kNoWindow);
    }
    const bool draws = drawn != kNothing;
    LiveRow row{};
    row.volume = std::filesystem::path(session_.volume().name).filename().string();
    row.drawn = drawn;
    row.seconds = seconds_;
    row.edits = static_cast<std::int64_t>(edits_);
    row.pictures = pictures_;
    row.between_ms = draws ? 1e3 * seconds_ / static_cast<double>(pictures_) : kNone;
    row.to_pixel_ms = percentiles(to_pixel_ms_);
    row.settling_ms = settling_ms_;
    row.ready_s = ready_s_;
    row.lateness_us = percentiles(lateness_us);
    row.window_age_ms = percentiles(age_ms);
    row.stale_ticks = stale;
    row.resident_MiB = residentMiB();
    return row;
  }

 private:
  static SculptRequest requestOf(const std::string& volume, const std::string& gpu) {
    SculptRequest request;
    request.volume = volume;
    request.gpu = gpu;
    return request;
  }
  struct Edit {
    std::uint64_t version;
    double at_s;
  };

  static void pause() {
    throwIfInterrupted("palpate bench live");
    std::this_thread::sleep_for(kLook);
  }
  void wait(double seconds) {
    for (const Stopwatch watch; watch.seconds() < seconds;) pause();
  }
  template <typename Done>
  [[nodiscard]] bool waitFor(const Done& done) {
    for (const Stopwatch watch; watch.seconds() < kPatience_s; pause()) {
      if (done()) return true;
    }
    return false;
  }
  void show() {
    DrawStyle style;
    style.occlusion = true;  // the dearest look that a person may choose
    session_.view().show({view_.camera(), style, DrawOrder::kCoarseFirst});
  }

  // Counts new edits, and pictures that show them.
  void look(double now_s) {
    session_.takeTicks(ticks_);
    const std::uint64_t content = session_.look().edits.content_version;
    if (content > seen_edit_) waiting_.push_back({content, now_s});
    if (content > seen_edit_ && seen_edit_ == 0) ticks_.clear();  // a tool at rest needs no new window
    seen_edit_ = content;
    const ViewFrame& frame = session_.view().latest();
    if (frame.number == 0 || frame.number == seen_frame_) return;
    seen_frame_ = frame.number;
    const bool another_camera = !(frame.camera == seen_camera_);
    seen_camera_ = frame.camera;
    pictures_ += turns_ ? another_camera : frame.fine;
    std::erase_if(waiting_, [&](const Edit& edit) {
      if (frame.edit_version < edit.version) return false;
      to_pixel_ms_.push_back(1e3 * (now_s - edit.at_s));
      return true;
    });
  }

  const LiveBenchRequest& request_;
  const Stopwatch since_start_;
  SculptSession session_;
  OrbitView view_;
  std::vector<TickRecord> ticks_;
  std::vector<Edit> waiting_;  // for a picture
  std::vector<double> to_pixel_ms_;
  std::uint64_t seen_edit_ = 0, seen_frame_ = 0, edits_ = 0;
  Camera seen_camera_;
  std::int64_t pictures_ = 0;
  bool turns_ = false;  // the camera
  double seconds_ = 0, settling_ms_ = kNone, ready_s_ = kNone;
};

double over(double value, double of) {
  return of > 0 ? value / of : kNone;
}

void addTargets(BenchResult& result) {
  const auto like = [](const char* drawn) { return BenchRow{{"drawn", drawn}}; };
  const auto median_of = [&](const char* drawn, const char* key, double bound, const std::string& name) {
    promise(result, {.name = name, .bound = bound, .part = "live", .like = like(drawn), .keys = {key}, .of = medianOf});
  };
  median_of(kStanding, "between_pictures_ms", kStanding_ms, "between fine pictures while drilling, camera stands [ms]");
  median_of(kStanding, "edit_to_pixel_p99_ms", kMostToPixel_ms, "from an edit to the picture of it, p99 [ms]");
  median_of(kTurning, "between_pictures_ms", kTurning_ms, "between pictures of new cameras, camera turns [ms]");
  median_of(kTurning, "settling_ms", kMostSettling_ms, "whole after the camera stands [ms]");
  median_of(kStanding, "ready_s", kMostReady_s, "from the request to a whole picture [s]");
  for (const char* drawn : {kStanding, kTurning}) {
    const std::string words = std::string(", ") + drawn;
    median_of(drawn, "lateness_over_undrawn", kMostOfUndrawn, "lateness p99.9 / of nothing drawn" + words + " [-]");
    median_of(drawn, "window_age_over_undrawn", kMostOfUndrawn, "window age p99 / of nothing drawn" + words + " [-]");
    promise(result, {.name = "ticks with a stale window" + words + " [tick]",
                     .bound = 0,
                     .part = "live",
                     .like = like(drawn),
                     .keys = {"stale_ticks"},
                     .of = sumOf});
  }
}

}  // namespace

BenchResult runLiveBench(const LiveBenchRequest& request, Progress& progress) {
  const std::string volume = request.volume.empty() ? headVolume() : request.volume;
  std::vector<Vec3> places_W;
  BenchResult result = beginBench("live");
  {
    Progress silent(nullptr);
    Watched first(request, volume, silent);
    places_W = circleOf(first.draw());
    result.vulkan_device = first.device();
  }
  if (places_W.empty()) {
    result.note("the picture shows nothing in its middle: nothing was drilled");
    return result;
  }
  for (int turn = 0; turn < request.repetitions; ++turn) {
    progress.stage("drilling " + volume);
    std::vector<LiveRow> rows;
    for (const char* drawn : {kNothing, kStanding, kTurning}) {
      progress.fraction((turn + static_cast<double>(rows.size()) / 3) / request.repetitions);
      Progress silent(nullptr);
      Watched watched(request, volume, silent);
      if (drawn != kNothing) static_cast<void>(watched.draw());
      watched.drill(places_W, request.seconds, drawn == kTurning ? kTurn_rad_s : 0);
      LiveRow row = watched.row(drawn);
      const LiveRow& undrawn = rows.empty() ? row : rows.front();
      row.late_over = over(row.lateness_us.p999, undrawn.lateness_us.p999);
      row.age_over = over(row.window_age_ms.p99, undrawn.window_age_ms.p99);
      addFigures(result.rows.emplace_back(BenchRow{{"part", "live"}}), liveColumns(), row);
      rows.push_back(std::move(row));
    }
  }
  addTargets(result);
  return result;
}

std::string liveTable(const BenchResult& result) {
  return tableText(result, {{"live"}, shown(liveColumns())});
}

LogCharts liveCharts(const BenchResult& result) {
  ChartPanel panel{"the servo beside the picture", "between pictures [ms]", "lateness p99.9 [us]", {}};
  for (const char* drawn : {kStanding, kTurning}) {
    ChartSeries series{drawn, {}};
    for (const BenchRow* row : rowsOf(result, "live", {{"drawn", drawn}}))
      series.points.push_back({figureOf(*row, "between_pictures_ms"), figureOf(*row, "lateness_p999_us")});
    panel.series.push_back(std::move(series));
  }
  return {{"Drawing while the servo runs", {panel}, ChartMarks::kPoints}};
}

}  // namespace palpate
