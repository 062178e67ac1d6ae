// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/vhip_algorithm.hpp: what all algorithms with a VHIP share: plane -> VHIP -> effects -> force.
//
// Such an algorithm is made from a Surface, which finds the virtual plane under the tool by its own rule. A Surface has
//   explicit Surface(const AlgorithmParameters&);
//   static constexpr bool kMayPull;     // K d - B v_d may pull the device in, as the paper prints it
//   static constexpr bool kEasesEdits;  // optional, default true; false: edits are felt whole at once
//   void reset(const Vec3& hip_W) noexcept;
//   // Optional: as Algorithm::resume(); comes after a reset().
//   void resume(const Vec3& free_W) noexcept;
//   // True in contact: then plane() is valid, with `tool_W` behind it. `tool_W` is the HIP, or with objects the place
//   // where they let the tool be (servo/objects/object_contacts.hpp).
//   bool find(const SampleWindow& window, const Vec3& tool_W, std::uint32_t& faults) noexcept;
//   // Optional: the surface point of a contact that is remembered while the window does not hold it.
//   std::optional<Vec3> remembered(const Vec3& hip_W) const noexcept;
//   ContactPlane plane() const noexcept;  // without contact only its age is used: 0 without a plane
//
// Edits. An edit may add depth, compared with the depth shown before at the same HIP. The added depth is taken in over
// time (edit_ease.hpp), unless the Surface has kEasesEdits = false. Until then the plane is shown moved inwards. If an
// edit turned the plane, only the part of the old displacement along the new normal is felt at once. Depth that an edit
// takes away is gone at once. Objects beside the volume are not eased.
// Frames, force convention and thread: algorithm.hpp. Source: the paper, equations 2 and 3. Effects move the VHIP only
// (section 3.1, last paragraph), within their account of energy (energy_account.hpp). Cost: some 5 ns, plus the
// Surface, the effects and the objects; with effects 5 ns for the account.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "servo/algorithms/algorithm.hpp"
#include "servo/contact/contact_effect.hpp"
#include "servo/contact/edit_ease.hpp"
#include "servo/contact/energy_account.hpp"
#include "servo/objects/object_contacts.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

template <class Surface>
class VhipAlgorithm final : public Algorithm {
 public:
  // Differences of depth that are not taken for an edit's [voxel]. Two planes of one surface, found for one HIP, may
  // differ by kSamePlane. A plane that was found at a lateral distance w lies w^2 / (2 R) off the sheet. kTightest is
  // the smallest R that a sheet is assumed to have.
  static constexpr double kSamePlane = 0.02;
  static constexpr double kTightest = 4;
  static constexpr double kLongestAside = 1;  // largest w that is assumed, however old the plane [voxel]
  static constexpr double kSharpest = 0.1;    // sine of the sharpest groove that is reckoned with
  static constexpr double kCatchUp = 100;     // of a VHIP whose groove has moved [voxel/s]

  explicit VhipAlgorithm(const AlgorithmParameters& parameters, ContactEffects effects = {},
                         ContactObjects objects = {}, const ContactObject* isosurface = nullptr)
      : surface_(parameters),
        stiffness_N_per_m_(parameters.stiffness_N_per_m),
        damping_Ns_per_m_(parameters.damping_Ns_per_m),
        effects_(std::move(effects)),
        feels_surface_(std::ranges::any_of(effects_, [](const auto& effect) { return effect->feelsSurface(); })),
        felt_(parameters.isovalue, parameters.rate_hz),
        met_(parameters.isovalue, parameters.rate_hz),
        slack_voxels_(kCatchUp / parameters.rate_hz),
        met_normal_lead_W_(parameters.rate_hz),
        met_depth_lead_m_(parameters.rate_hz),
        objects_(std::move(objects), isosurface),
        ease_(parameters.rate_hz) {}

  void reset(const Vec3& hip_W) noexcept override {
    surface_.reset(hip_W);
    objects_.reset(hip_W);
    volume_plane_.reset();
    ease_.end();
    on_surface_ = false;
    edit_ = Edit::kSettled;
    release();
  }

  void resume(const Vec3& free_W, const Vec3& hip_W) noexcept override {
    reset(hip_W);
    if constexpr (requires { surface_.resume(free_W); }) surface_.resume(free_W);
    objects_.reset(free_W);
    resumed_ = true;
  }

  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    if (resumed_ && in.window->usable()) {  // edits before the take-over were felt already
      edit_version_ = in.window->edit_version;
      resumed_ = false;
    }
    if (objects_.empty()) {
      if (find(*in.window, in.hip_W, out.faults)) {
        giveForce(in, shown(), out);
      } else {
        giveNoForce(in, out);
      }
    } else if (const auto plane = findWithObjects(in, out.faults)) {
      giveForce(in, *plane, out);
    } else {
      giveNoForce(in, out);
    }
  }

 private:
  // Every edit leads to kAwaited. The first plane that is found after it leads to kEasing, the end of the contact to
  // kSettled. In kAwaited there may still be depth of earlier edits to ease.
  enum class Edit : std::uint8_t { kSettled, kAwaited, kEasing };

  // Surface::find(), with the easing of edits.
  [[nodiscard]] bool find(const SampleWindow& window, const Vec3& tool_W, std::uint32_t& faults) noexcept {
    if constexpr (easesEdits()) {
      if (window.edit_version != edit_version_ || edit_ != Edit::kSettled) return findEased(window, tool_W, faults);
    }
    return on_surface_ = surface_.find(window, tool_W, faults);
  }

  [[nodiscard]] bool findEased(const SampleWindow& window, const Vec3& tool_W, std::uint32_t& faults) noexcept {
    const ContactPlane before = shown();
    const bool was_on_surface = on_surface_;
    if (window.usable() && window.edit_version != edit_version_) {
      edit_version_ = window.edit_version;
      edit_ = Edit::kAwaited;
    }
    on_surface_ = surface_.find(window, tool_W, faults);
    const ContactPlane plane = surface_.plane();
    const double depth_m = plane.depth(tool_W);
    if (on_surface_) {
      if (edit_ == Edit::kAwaited && plane.age_ticks == 0) {
        takeEdit(was_on_surface ? &before : nullptr, window, tool_W);
        edit_ = Edit::kEasing;
      }
      ease_.elapse(depth_m);
    } else if ((faults & (bit(ServoFault::kNoWindow) | bit(ServoFault::kBeyondWindow))) == 0) {
      edit_ = Edit::kSettled;
      ease_.end();
    }
    if (edit_ == Edit::kEasing && !ease_.active()) edit_ = Edit::kSettled;
    return on_surface_;
  }

  // The plane has been found anew since the edit. `before`: the plane shown in the last tick, null without contact.
  void takeEdit(const ContactPlane* before, const SampleWindow& window, const Vec3& tool_W) noexcept {
    const ContactPlane plane = surface_.plane();
    if (before == nullptr) {
      ease_.end();
      ease_.take(0, plane.depth(tool_W));
      return;
    }
    const double voxel_m = window.lattice.smallestSpacing();
    const double shown_m = std::max(0.0, before->depth(tool_W)) * std::max(0.0, before->normal_W.dot(plane.normal_W));
    const double aside_m = std::min(kLongestAside * voxel_m, (before->nearest(tool_W) - before->p_W).norm());
    ease_.take(shown_m, plane.depth(tool_W), kSamePlane * voxel_m + aside_m * aside_m / (2 * kTightest * voxel_m));
  }

  // The volume's plane, moved inwards by the depth that is not taken in yet.
  [[nodiscard]] ContactPlane shown() const noexcept {
    ContactPlane plane = surface_.plane();
    if (edit_ != Edit::kSettled) plane.p_W -= ease_.amount() * plane.normal_W;
    return plane;
  }

  // The plane of volume and objects together.
  [[nodiscard]] std::optional<ContactPlane> findWithObjects(const TickInput& in, std::uint32_t& faults) noexcept {
    const auto held = [this] { return volume_plane_ ? &*volume_plane_ : nullptr; };
    const ContactPlane found = shown();
    const Vec3 tool_W = objects_.volumeTool(in.hip_W, held(), &found);
    volume_plane_.reset();
    if (find(*in.window, tool_W, faults)) {
      volume_plane_ = met(*in.window, tool_W);
    } else {
      releaseMet();
    }
    return objects_.settle(in.hip_W, held(), slack_voxels_ * in.window->lattice.smallestSpacing());
  }

  // The volume's plane where it meets objects. In a groove an error of the plane moves the VHIP by one over the sine of
  // the groove's angle as much. So the plane is that of the felt surface there. When the object is gone, the felt plane
  // goes over to the plane itself.
  [[nodiscard]] ContactPlane met(const SampleWindow& window, const Vec3& tool_W) noexcept {
    const ContactPlane found = shown();
    ContactPlane plane = found;
    if (met_normal_lead_W_.active() || met_depth_lead_m_.active()) {
      plane.normal_W = (found.normal_W - met_normal_lead_W_.elapse()).normalized();
      // What is shown is never above the surface, nor twice as deep as it: so it ends with the contact.
      const double depth_m = found.depth(tool_W);
      met_depth_lead_m_.bound(depth_m);
      plane.p_W = tool_W + (depth_m - met_depth_lead_m_.elapse()) * plane.normal_W;
    }
    const double sine = objects_.sharpest(found.normal_W);
    if (!(sine < 1)) {
      if (meets_) {
        releaseMet();  // what is left of an earlier object is part of the plane that was shown
        met_normal_lead_W_.take(found.normal_W - met_plane_.normal_W);
        met_depth_lead_m_.take(found.depth(tool_W) - met_plane_.depth(tool_W));
        plane = met_plane_;
      }
      return plane;
    }
    const FeltPoint& felt = met_.feel({.hip_W = tool_W,
                                       .plane = plane,
                                       .eased_m = edit_ != Edit::kSettled ? ease_.amount() : 0,
                                       .begins = !meets_,
                                       .sharpness = 1 / std::max(sine, kSharpest),
                                       .window = &window});
    meets_ = true;
    return met_plane_ = {felt.p_W, felt.normal_W, plane.age_ticks};
  }

  void releaseMet() noexcept {
    met_.release();
    meets_ = false;
    met_normal_lead_W_.end();
    met_depth_lead_m_.end();
  }

  void giveNoForce(const TickInput& in, TickOutput& out) noexcept {
    if (touching_) release();
    out.vhip_W = in.hip_W;
    if constexpr (requires { surface_.remembered(in.hip_W); }) {
      const std::optional<Vec3> surface_W = surface_.remembered(in.hip_W);
      out.at_surface = surface_W.has_value();
      out.surface_W = surface_W.value_or(in.hip_W);
    }
    out.plane_age_ticks = surface_.plane().age_ticks;
  }

  void release() noexcept {
    touching_ = false;
    releaseMet();
    felt_.release();
    for (auto& effect : effects_) effect->release();
  }

  // Without effects d lies along N. The part of d along the surface, which effects add, gives the spring force alone,
  // without damping.
  void giveForce(const TickInput& in, const ContactPlane& plane, TickOutput& out) noexcept {
    const double depth_m = plane.depth(in.hip_W);
    const double damping_N = damping_Ns_per_m_ * plane.normal_W.dot(in.hip_velocity_W);
    out.vhip_W = in.hip_W + depth_m * plane.normal_W;
    out.at_surface = true;
    out.surface_W = out.vhip_W;
    if (edit_ != Edit::kSettled) out.surface_W += ease_.amount() * surface_.plane().normal_W;
    if (effects_.empty()) {
      out.force_W = withoutPull(stiffness_N_per_m_ * depth_m - damping_N) * plane.normal_W;
      out.stored_J = 0.5 * stiffness_N_per_m_ * depth_m * depth_m;
    } else {
      const bool on_volume = objects_.empty() || objects_.onVolume();
      ContactState contact{.hip_W = in.hip_W,
                           .hip_velocity_W = in.hip_velocity_W,
                           .plane = plane,
                           .new_contact = !touching_,
                           .single_plane = objects_.empty() || objects_.singlePlane(),
                           .on_volume = on_volume,
                           .felt = {}};
      if (feels_surface_)
        contact.felt = felt_.feel({.hip_W = in.hip_W,
                                   .plane = plane,
                                   .eased_m = edit_ != Edit::kSettled ? ease_.amount() : 0,
                                   .begins = !touching_,
                                   .on_volume = on_volume,
                                   .window = in.window});
      ContactPush moved{
          .vhip_W = out.vhip_W, .surface_d_W = out.vhip_W - in.hip_W, .energy_m2 = 0.5 * depth_m * depth_m};
      for (auto& effect : effects_) {
        effect->move(contact, moved);
        ++out.effects;
      }
      out.vhip_W = account_.settle(contact, moved);
      out.stored_J = stiffness_N_per_m_ * moved.energy_m2;
      const Vec3 spring_W = stiffness_N_per_m_ * (out.vhip_W - in.hip_W);
      const double along_N = plane.normal_W.dot(spring_W);
      out.force_W = spring_W + plane.normal_W * (withoutPull(along_N - damping_N) - along_N);
    }
    touching_ = true;
    out.normal_W = plane.normal_W;
    out.depth_m = depth_m;
    out.in_contact = true;
    out.plane_age_ticks = plane.age_ticks;
  }

  static constexpr bool easesEdits() noexcept {
    if constexpr (requires { Surface::kEasesEdits; }) return Surface::kEasesEdits;
    return true;
  }
  static double withoutPull(double force_N) noexcept { return Surface::kMayPull ? force_N : std::max(0.0, force_N); }

  Surface surface_;
  double stiffness_N_per_m_;
  double damping_Ns_per_m_;
  ContactEffects effects_;
  bool feels_surface_;      // one of them does
  FeltSurface felt_;        // that they see, used only then
  FeltSurface met_;         // that objects meet
  bool meets_ = false;      // one did in the last tick
  ContactPlane met_plane_;  // of the last tick in which one did
  double slack_voxels_;     // of the VHIP in a groove, a tick
  // How far the volume's plane is ahead of the one that is shown, after an object was met.
  EditLead<Vec3> met_normal_lead_W_;
  EditLead<double> met_depth_lead_m_;
  EnergyAccount account_;  // bounds the energy that the effects give
  ObjectContacts objects_;
  std::optional<ContactPlane> volume_plane_;  // with objects: the plane of the last tick, in contact
  bool touching_ = false;                     // there was contact in the last tick
  bool on_surface_ = false;                   // with the volume
  Edit edit_ = Edit::kSettled;
  bool resumed_ = false;            // another algorithm handed over, and no usable window has come since
  std::uint64_t edit_version_ = 0;  // of the last usable window
  EditEase ease_;                   // of the depth behind the volume's plane [m]
};

}  // namespace palpate
