// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/registry.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "servo/algorithms/avila.hpp"
#include "servo/algorithms/blezek.hpp"
#include "servo/algorithms/god_object.hpp"
#include "servo/algorithms/haptization.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/algorithms/hri_paper.hpp"
#include "servo/algorithms/implicit.hpp"

namespace palpate {
namespace {

template <class VhipKind>
std::unique_ptr<Algorithm> makeVhip(AlgorithmSetup&& setup) {
  return std::make_unique<VhipKind>(setup.parameters, std::move(setup.effects), std::move(setup.objects));
}

// The isosurface is one more object, the first.
std::unique_ptr<Algorithm> makeGodObject(AlgorithmSetup&& setup) {
  if (setup.isosurface == nullptr) {
    throw Error(Error::Code::kBadInput, "algorithm god-object", "the isosurface's mesh is missing",
                "extract it from the volume first");
  }
  setup.objects.insert(setup.objects.begin(), setup.isosurface);
  return std::make_unique<GodObject>(setup.parameters, std::move(setup.effects), std::move(setup.objects),
                                     setup.isosurface.get());
}

// For an algorithm without a VHIP that they could move.
void refuseEffectsAndObjects(const AlgorithmSetup& setup, const char* algorithm) {
  if (setup.effects.empty() && setup.objects.empty()) return;
  throw Error(Error::Code::kBadInput, algorithm, "contact effects and objects move a VHIP, and it has none",
              "leave them out, or take an algorithm with a VHIP, such as hri");
}

std::unique_ptr<Algorithm> makeAvila(AlgorithmSetup&& setup) {
  refuseEffectsAndObjects(setup, "avila");
  return std::make_unique<Avila>(setup.parameters);
}

std::unique_ptr<Algorithm> makeHaptization(AlgorithmSetup&& setup) {
  refuseEffectsAndObjects(setup, "haptization");
  TransferTables tables = std::move(setup.haptization);
  TransferTables standard = TransferFunction::standard(setup.parameters.isovalue, setup.scale);
  if (tables.density.empty()) tables.density = std::move(standard.density);
  if (tables.gradient.empty()) tables.gradient = std::move(standard.gradient);
  return std::make_unique<Haptization>(setup.parameters, std::move(tables));
}

constexpr AlgorithmEntry kEntries[] = {
    {"hri",
     "virtual plane at the surface point nearest to the tool, renewed every n ticks (the paper, mended)",
     makeVhip<Hri>,
     {},
     {.renews_planes = true},
     HriSurface::planeAgeError},
    {"hri-paper",
     "the paper's Figure 2 to the letter, plane on the ray from VHIP to HIP, renewed every n + 1 ticks",
     makeVhip<HriPaper>,
     {},
     {.renews_planes = true},
     HriPaperSurface::planeAgeError},
    {"hri-paper-line",
     "hri-paper with the other reading of its text: the plane where the density equals the isovalue on that ray",
     makeVhip<HriPaperLine>,
     {},
     {.renews_planes = true},
     HriPaperSurface::planeAgeError},
    {"avila",
     "depth and force from the density at the tool alone (Avila and Sobierajski 1996); penetrable",
     makeAvila,
     {.gradient_everywhere = true}},
    {"blezek", "VHIP inched along the isosurface until normal and VHIP-HIP line agree (Blezek and Robb)",
     makeVhip<Blezek>},
    {"god-object",
     "constraint-based contact with a triangle mesh of the isosurface (Zilles and Salisbury 1995)",
     makeGodObject,
     {.isosurface_mesh = true},
     {.stiffening = 1.3}},  // measured: where facets meet, it shakes from 0.8 of what a smooth surface bears on
    {"implicit", "contact point tracked by its tangent plane, every tick (Salisbury and Tarr 1997)",
     makeVhip<Implicit>},
    {"haptization",
     "force and viscosity from density and gradient by a transfer function (after Iwata and Noma 1993)",
     makeHaptization,
     {.gradient_everywhere = true},
     {.takes_tables = true, .shows_surface = false}},
};

void checkParameters(const AlgorithmParameters& p) {
  checkSetting(true, "isovalue", p.isovalue, "give a finite density");
  checkSetting(p.stiffness_N_per_m >= 0, "stiffness", p.stiffness_N_per_m, "give 0 N/m or more");
  checkSetting(p.damping_Ns_per_m >= 0, "damping", p.damping_Ns_per_m, "give 0 N s/m or more");
  checkSetting(p.plane_renewal_ticks >= 1, "plane renewal", p.plane_renewal_ticks, "give 1 tick or more");
  checkSetting(p.rate_hz > 0, "rate", p.rate_hz, "give more than 0 Hz");
}

}  // namespace

std::span<const AlgorithmEntry> algorithms() noexcept {
  return kEntries;
}

const AlgorithmEntry& algorithmEntry(std::string_view name) {
  std::string known;
  for (const AlgorithmEntry& entry : kEntries) {
    if (entry.name == name) return entry;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error(Error::Code::kBadInput, "algorithm", formatted("'{}' is not known", name), "use one of: " + known);
}

std::unique_ptr<Algorithm> makeAlgorithm(std::string_view name, AlgorithmSetup setup) {
  checkParameters(setup.parameters);
  return algorithmEntry(name).make(std::move(setup));
}

}  // namespace palpate
