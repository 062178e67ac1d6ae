// SPDX-License-Identifier: Apache-2.0
#include "apps/onlook/onlook_messages.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "apps/servo_side/wire_settings.hpp"
#include "base/error.hpp"
#include "base/other_version.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostPlanes = 16;  // of a kind; engine/draw says how many it draws

[[noreturn]] void refuseWire(const std::string& input, const std::string& reason) {
  refuseOtherVersion(input, reason);
}

void checkFinite(const std::string& input, std::initializer_list<double> values) {
  if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); }))
    refuseWire(input, "a number is not finite");
}

Vec3 finiteVector(const std::unique_ptr<wire::VectorT>& wire, const std::string& input) {
  Vec3 v = vectorOf(wire);
  checkFinite(input, {v.x(), v.y(), v.z()});
  return v;
}

std::vector<std::unique_ptr<wire::PlaneT>> wireOf(const std::vector<ViewPlane>& planes) {
  std::vector<std::unique_ptr<wire::PlaneT>> wire;
  for (const ViewPlane& plane : planes) {
    wire.push_back(std::make_unique<wire::PlaneT>());
    wire.back()->normal = palpate::wireOf(plane.normal_W);
    wire.back()->offset_m = plane.offset_m;
  }
  return wire;
}

std::vector<ViewPlane> planesOf(const std::vector<std::unique_ptr<wire::PlaneT>>& wire) {
  if (wire.size() > kMostPlanes) refuseWire("a view", fmt::format("it has {} planes", wire.size()));
  std::vector<ViewPlane> planes;
  for (const auto& plane : wire) {
    if (!plane) refuseWire("a view", "a plane is missing");
    checkFinite("a plane", {plane->offset_m});
    planes.push_back({.normal_W = finiteVector(plane->normal, "a plane"), .offset_m = plane->offset_m});
  }
  return planes;
}

bool isUnit(const Vec3& v) {
  return std::abs(v.norm() - 1) < 1e-6;  // what a camera's axes lose of it in double precision is far less
}

void checkCamera(const Camera& camera) {
  if (camera.width < 1 || camera.height < 1 || camera.width > PICTURE_MOST_SIDE || camera.height > PICTURE_MOST_SIDE ||
      static_cast<long long>(camera.width) * camera.height > PICTURE_MOST_PIXELS)
    refuse("a view", fmt::format("no picture has {} x {} pixels", camera.width, camera.height),
           fmt::format("ask for at most {} pixels", PICTURE_MOST_PIXELS));
  if (!isUnit(camera.forward_W) || !isUnit(camera.right_W) || !isUnit(camera.up_W))
    refuseWire("a view", "its axes are not of length 1");
  if (!(camera.vertical_fov_rad > 0) || camera.vertical_fov_rad >= std::numbers::pi)
    refuseWire("a view", fmt::format("no camera sees {:g} rad", camera.vertical_fov_rad));
}

void putStatistics(const VolumeStatistics& statistics, wire::FactsT& wire) {
  wire.minimum = statistics.minimum;
  wire.maximum = statistics.maximum;
  wire.mean = statistics.mean;
  wire.fill_share = statistics.fill_share;
  wire.histogram_low = statistics.histogram.low;
  wire.histogram_bin_width = statistics.histogram.bin_width;
  wire.histogram = statistics.histogram.counts;
  for (const IsovalueSuggestion& one : statistics.suggestions) {
    wire.suggestions.push_back(std::make_unique<wire::SuggestionT>());
    wire.suggestions.back()->isovalue = one.isovalue;
    wire.suggestions.back()->reason = one.reason;
  }
}

VolumeStatistics statisticsOf(const wire::FactsT& wire) {
  checkFinite("statistics",
              {wire.minimum, wire.maximum, wire.mean, wire.fill_share, wire.histogram_low, wire.histogram_bin_width});
  VolumeStatistics statistics{
      .minimum = wire.minimum,
      .maximum = wire.maximum,
      .mean = wire.mean,
      .histogram = {.low = wire.histogram_low, .bin_width = wire.histogram_bin_width, .counts = wire.histogram},
      .fill_share = wire.fill_share,
      .suggestions = {}};
  for (const auto& one : wire.suggestions)
    if (one) statistics.suggestions.push_back({one->isovalue, one->reason});
  return statistics;
}

SeenExtent extentOf(const wire::FactsT& wire) {
  if (wire.object_points.empty() || wire.object_points.size() % 3 != 0)
    refuseWire("an object's extent", fmt::format("{} numbers are no places", wire.object_points.size()));
  SeenExtent extent{.middle_W = finiteVector(wire.object_middle, "an object's middle"), .points_W = {}};
  for (std::size_t i = 0; i < wire.object_points.size(); i += 3) {
    const double* const p = &wire.object_points[i];
    checkFinite("an object's extent", {p[0], p[1], p[2]});
    extent.points_W.emplace_back(p[0], p[1], p[2]);
  }
  return extent;
}

}  // namespace

std::unique_ptr<wire::FactsT> wireOf(const ServedFacts& facts) {
  auto wire = std::make_unique<wire::FactsT>();
  const SeenVolume& volume = facts.volume;
  wire->name = volume.name;
  wire->columns = volume.size.x();
  wire->rows = volume.size.y();
  wire->slices = volume.size.z();
  wire->origin = wireOf(volume.lattice.origin_W);
  wire->axes.assign(volume.lattice.R_WL.data(), volume.lattice.R_WL.data() + 9);  // Eigen: column by column
  wire->spacing = wireOf(volume.lattice.spacing_m);
  putStatistics(volume.statistics, *wire);
  const SeenExtent object = withFewerPoints(volume.object, kMostObjectPoints);
  wire->object_middle = wireOf(object.middle_W);
  for (const Vec3& point_W : object.points_W)
    wire->object_points.insert(wire->object_points.end(), point_W.data(), point_W.data() + 3);
  wire->device = facts.device;
  wire->is_held = facts.device_is_held;
  wire->keeps_journal = facts.keeps_journal;
  for (const PlanLine& line : facts.plan) {
    wire->plan.push_back(std::make_unique<wire::PlanNoteT>());
    wire::PlanNoteT& note = *wire->plan.back();
    note.done = line.done;
    note.what = line.what;
    note.why = line.why;
    note.saved_bytes = line.saved_bytes;
  }
  wire->settings = wireOf(facts.settings);
  return wire;
}

ServedFacts factsOf(const std::unique_ptr<wire::FactsT>& wire) {
  if (!wire) refuseWire("a volume", "nothing is said of it");
  if (wire->axes.size() != 9) refuseWire("a lattice", fmt::format("it has {} numbers for its axes", wire->axes.size()));
  ServedFacts facts;
  SeenVolume& volume = facts.volume;
  volume.name = wire->name;
  volume.size = {wire->columns, wire->rows, wire->slices};
  if (volume.size.minCoeff() < 1) refuseWire(wire->name, "it has no voxels");
  volume.lattice.origin_W = vectorOf(wire->origin);
  std::ranges::copy(wire->axes, volume.lattice.R_WL.data());
  volume.lattice.spacing_m = vectorOf(wire->spacing);
  checkLattice(volume.lattice, wire->name);
  volume.statistics = statisticsOf(*wire);
  volume.object = extentOf(*wire);
  facts.device = wire->device;
  facts.device_is_held = wire->is_held;
  facts.keeps_journal = wire->keeps_journal;
  for (const auto& line : wire->plan)
    if (line) facts.plan.push_back({line->done, line->what, line->why, line->saved_bytes});
  facts.settings = settingsOf(wire->settings);
  return facts;
}

std::unique_ptr<wire::LookedT> wireOf(const Looked& looked) {
  auto wire = std::make_unique<wire::LookedT>();
  wire->has_servo = looked.has_servo;
  wire->can_edit = looked.can_edit;
  wire->force_off = static_cast<std::uint8_t>(looked.force_off);
  wire->edits = looked.edits.edits;
  wire->refused = looked.edits.refused;
  wire->content_version = looked.edits.content_version;
  wire->done = looked.edits.done;
  wire->undone = looked.edits.undone;
  wire->waiting = looked.edits.waiting;
  wire->has_steps = looked.has_steps;
  if (looked.has_steps) {
    const std::size_t skipped = looked.edits.steps.size() - std::min(looked.edits.steps.size(), kMostSteps);
    wire->older_steps = looked.older_steps + skipped;
    for (std::size_t i = skipped; i < looked.edits.steps.size(); ++i) {
      wire->step_kinds.push_back(static_cast<std::uint8_t>(looked.edits.steps[i].kind));
      wire->step_edits.push_back(looked.edits.steps[i].edits);
    }
  }
  wire->settings = wireOf(looked.settings);
  wire->drawing_failure = looked.drawing_failure;
  wire->journal_failure = looked.journal_failure;
  return wire;
}

Looked lookedOf(const std::unique_ptr<wire::LookedT>& wire) {
  if (!wire) refuseWire("a service", "it does not say how it goes");
  Looked looked;
  looked.has_servo = wire->has_servo;
  looked.can_edit = wire->can_edit;
  looked.force_off = forceOffOf(wire->force_off);
  looked.edits.edits = wire->edits;
  looked.edits.refused = wire->refused;
  looked.edits.content_version = wire->content_version;
  looked.edits.done = wire->done;
  looked.edits.undone = wire->undone;
  looked.edits.waiting = wire->waiting;
  looked.edits.editing = wire->can_edit;
  looked.has_steps = wire->has_steps;
  looked.older_steps = wire->older_steps;
  if (wire->step_kinds.size() != wire->step_edits.size()) refuseWire("a list of edits", "its parts differ in length");
  for (std::size_t i = 0; i < wire->step_kinds.size(); ++i) {
    if (wire->step_kinds[i] >= kEditKinds) refuseWire("a list of edits", "it has one of an unknown kind");
    looked.edits.steps.push_back({static_cast<EditKind>(wire->step_kinds[i]), wire->step_edits[i]});
  }
  looked.settings = settingsOf(wire->settings);
  looked.drawing_failure = wire->drawing_failure;
  looked.journal_failure = wire->journal_failure;
  return looked;
}

std::unique_ptr<wire::ViewT> wireOf(const ViewRequest& view) {
  auto wire = std::make_unique<wire::ViewT>();
  wire->position = wireOf(view.camera.position_W);
  wire->forward = wireOf(view.camera.forward_W);
  wire->right = wireOf(view.camera.right_W);
  wire->up = wireOf(view.camera.up_W);
  wire->vertical_fov_rad = view.camera.vertical_fov_rad;
  wire->width = view.camera.width;
  wire->height = view.camera.height;
  wire->occlusion = view.style.occlusion;
  wire->normals = view.style.normals;
  wire->clips = wireOf(view.style.clips);
  wire->slices = wireOf(view.style.slices);
  wire->slice_black = view.style.slice_black;
  wire->slice_white = view.style.slice_white;
  wire->has_other = view.style.other_isovalue.has_value();
  wire->other_isovalue = view.style.other_isovalue.value_or(0);
  wire->other_opacity = view.style.other_opacity;
  wire->order = static_cast<std::uint8_t>(view.order);
  return wire;
}

ViewRequest viewOf(const std::unique_ptr<wire::ViewT>& wire) {
  if (!wire) refuseWire("a view", "the question has none");
  if (wire->order > static_cast<std::uint8_t>(DrawOrder::kCoarseFirst))
    refuseWire("a view", fmt::format("no order of drawing has the number {}", wire->order));
  checkFinite("a view", {wire->vertical_fov_rad, wire->slice_black, wire->slice_white, wire->other_isovalue,
                         wire->other_opacity});
  ViewRequest view;
  view.camera.position_W = finiteVector(wire->position, "a view");
  view.camera.forward_W = finiteVector(wire->forward, "a view");
  view.camera.right_W = finiteVector(wire->right, "a view");
  view.camera.up_W = finiteVector(wire->up, "a view");
  view.camera.vertical_fov_rad = wire->vertical_fov_rad;
  view.camera.width = wire->width;
  view.camera.height = wire->height;
  checkCamera(view.camera);
  view.style = {.occlusion = wire->occlusion,
                .normals = wire->normals,
                .clips = planesOf(wire->clips),
                .slices = planesOf(wire->slices),
                .slice_black = wire->slice_black,
                .slice_white = wire->slice_white,
                .other_isovalue = wire->has_other ? std::optional(wire->other_isovalue) : std::nullopt,
                .other_opacity = wire->other_opacity};
  view.order = static_cast<DrawOrder>(wire->order);
  return view;
}

}  // namespace palpate
