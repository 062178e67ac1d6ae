// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/vhip_algorithm.hpp: what all algorithms with a VHIP share: plane -> VHIP -> effects -> force.
//
// An algorithm of this kind is a Surface, which finds the virtual plane under the tool by its own rule; the rest is the
// same for all and stands here once. A Surface has
//   explicit Surface(const AlgorithmParameters&);
//   static constexpr bool kMayPull;    // K d - B v_d may pull the device in, as the paper prints it
//   void reset(const Vec3& hip_W) noexcept;
//   // True in contact: then plane() holds, with `tool_W` behind it. `tool_W`: the HIP, or, where there are objects,
//   // where they let the tool be (servo/objects/object_contacts.hpp).
//   bool find(const SampleWindow& window, const Vec3& tool_W, std::uint32_t& faults) noexcept;
//   ContactPlane plane() const noexcept;  // out of contact only its age says something: 0 without a plane
// Frames, force convention and thread: algorithm.hpp. Source: the paper, equations 2 and 3; effects move the VHIP only
// (section 3.1, last paragraph). Cost: some 5 ns and what Surface, effects and objects cost.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "servo/algorithms/algorithm.hpp"
#include "servo/contact/contact_effect.hpp"
#include "servo/objects/object_contacts.hpp"

namespace palpate {

template <class Surface>
class VhipAlgorithm final : public Algorithm {
 public:
  explicit VhipAlgorithm(const AlgorithmParameters& parameters, ContactEffects effects = {},
                         ContactObjects objects = {})
      : surface_(parameters),
        stiffness_N_per_m_(parameters.stiffness_N_per_m),
        damping_Ns_per_m_(parameters.damping_Ns_per_m),
        effects_(std::move(effects)),
        objects_(std::move(objects)) {}

  void reset(const Vec3& hip_W) noexcept override {
    surface_.reset(hip_W);
    objects_.reset(hip_W);
    volume_plane_.reset();
    release();
  }

  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    if (objects_.empty()) {
      if (surface_.find(*in.window, in.hip_W, out.faults)) {
        push(in, surface_.plane(), out);
      } else {
        leave(in, out);
      }
    } else if (const auto plane = findWithObjects(in, out.faults)) {
      push(in, *plane, out);
    } else {
      leave(in, out);
    }
  }

 private:
  // The plane of volume and objects together.
  [[nodiscard]] std::optional<ContactPlane> findWithObjects(const TickInput& in, std::uint32_t& faults) noexcept {
    const auto held = [this] { return volume_plane_ ? &*volume_plane_ : nullptr; };
    const Vec3 tool_W = objects_.volumeTool(in.hip_W, held());
    volume_plane_.reset();
    if (surface_.find(*in.window, tool_W, faults)) volume_plane_ = surface_.plane();
    return objects_.settle(in.hip_W, held());
  }

  void leave(const TickInput& in, TickOutput& out) noexcept {
    if (touching_) release();
    out.vhip_W = in.hip_W;
    out.plane_age_ticks = surface_.plane().age_ticks;
  }

  void release() noexcept {
    touching_ = false;
    for (auto& effect : effects_) effect->release();
  }

  // Without effects d lies along N; what effects add to it aside is a force of K alone.
  void push(const TickInput& in, const ContactPlane& plane, TickOutput& out) noexcept {
    const double depth_m = plane.depth(in.hip_W);
    const double damping_N = damping_Ns_per_m_ * plane.normal_W.dot(in.hip_velocity_W);
    out.vhip_W = in.hip_W + depth_m * plane.normal_W;
    if (effects_.empty()) {
      out.force_W = pushing(stiffness_N_per_m_ * depth_m - damping_N) * plane.normal_W;
    } else {
      const ContactState contact{in.hip_W, in.hip_velocity_W, plane, !touching_, in.window};
      for (auto& effect : effects_) out.vhip_W = effect->move(contact, out.vhip_W);
      const Vec3 spring_W = stiffness_N_per_m_ * (out.vhip_W - in.hip_W);
      const double along_N = plane.normal_W.dot(spring_W);
      out.force_W = spring_W + plane.normal_W * (pushing(along_N - damping_N) - along_N);
    }
    touching_ = true;
    out.normal_W = plane.normal_W;
    out.in_contact = true;
    out.plane_age_ticks = plane.age_ticks;
  }

  static double pushing(double force_N) noexcept { return Surface::kMayPull ? force_N : std::max(0.0, force_N); }

  Surface surface_;
  double stiffness_N_per_m_;
  double damping_Ns_per_m_;
  ContactEffects effects_;
  ObjectContacts objects_;
  std::optional<ContactPlane> volume_plane_;  // with objects: of the last tick, in contact
  bool touching_ = false;                     // in the last tick
};

}  // namespace palpate
