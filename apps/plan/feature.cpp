// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/feature.hpp"

#include <algorithm>
#include <fstream>

#include "apps/scene/object_table.hpp"
#include "base/error.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

using Folder = std::filesystem::path;

constexpr const char* kNamesNone = "the scene names none";
constexpr const char* kAsAsked = "as the scene says";
constexpr const char* kFilter = "gaussian:1";
constexpr const char* kSmoothing = "gaussian:1";
constexpr const char* kBrush = "remove:radius=2mm";
constexpr const char* kTouchesMesh = "god-object";

bool isMesh(const ObjectSpec& object) {
  return object.kind == ObjectKind::kMesh;
}
bool isNoMesh(const ObjectSpec& object) {
  return !isMesh(object);
}

// Far away from every volume, so that it changes nothing that is felt, but costs what an object costs.
ObjectSpec farBall() {
  return parseObject("sphere:centre=0,0,100000:radius=5");
}

// A tetrahedron of 1 mm in a file of its own.
ObjectSpec farMesh(const Folder& folder) {
  const Folder file = folder / "tetrahedron.stl";
  std::ofstream out(file);
  constexpr const char* kCorners[] = {"vertex 0 0 0", "vertex 1 0 0", "vertex 0 1 0", "vertex 0 0 1"};
  constexpr int kSides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  out << "solid tetrahedron\n";
  for (const auto& side : kSides) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : side) out << kCorners[corner] << '\n';
    out << "endloop\nendfacet\n";
  }
  out << "endsolid\n";
  out.close();
  if (!out) throw Error(Error::Code::kIo, file.string(), "it cannot be written", "make room, or set TMPDIR");
  return parseObject("mesh:position=0,0,100000:file=" + file.string());
}

// clang-format off
const Feature kFeatures[] = {
    {"trace.csv", "every tick", "not asked for (--trace off)", "every tick, for plots and programs",
     [](const Scene& s) { return s.trace; },
     [](Scene& s, const Folder&) { s.trace = true; },
     [](Scene& s) { s.trace = false; }},
    {"every gradient", "--gradient all", "only the bricks that the isosurface needs have gradients",
     "--gradient all",
     [](const Scene& s) { return s.gradient_all; },
     [](Scene& s, const Folder&) { s.gradient_all = true; },
     [](Scene& s) { s.gradient_all = false; }},
    {"filters", kFilter, "the scene names none: the volume itself is felt", kAsAsked,
     [](const Scene& s) { return !s.filter.empty(); },
     [](Scene& s, const Folder&) { s.filter = kFilter; },
     [](Scene& s) { s.filter.clear(); }},
    {"smoothed gradients", kSmoothing, "the gradient operator takes the field as it is", "the gradient operator smooths first",
     [](const Scene& s) { return gradientOperator(s.gradient_operator).smooths(); },
     [](Scene& s, const Folder&) { s.gradient_operator = kSmoothing; },
     [](Scene& s) { s.gradient_operator = Scene{}.gradient_operator; }},
    {"objects", "a ball", kNamesNone, kAsAsked,
     [](const Scene& s) { return std::ranges::any_of(s.objects, isNoMesh); },
     [](Scene& s, const Folder&) { s.objects.push_back(farBall()); },
     [](Scene& s) { std::erase_if(s.objects, isNoMesh); }},
    {"mesh objects", "a tetrahedron", kNamesNone, kAsAsked,
     [](const Scene& s) { return std::ranges::any_of(s.objects, isMesh); },
     [](Scene& s, const Folder& folder) { s.objects.push_back(farMesh(folder)); },
     [](Scene& s) { std::erase_if(s.objects, isMesh); }},
    {"friction", "0.4 static, 0.3 dynamic", kNamesNone, kAsAsked,
     [](const Scene& s) { return s.friction_static > 0 || s.friction_viscous_Ns_per_m > 0; },
     [](Scene& s, const Folder&) { s.friction_static = 0.4; s.friction_dynamic = 0.3; },
     [](Scene& s) { s.friction_static = s.friction_dynamic = s.friction_viscous_Ns_per_m = 0; }},
    {"texture", "procedural", kNamesNone, kAsAsked,
     [](const Scene& s) { return s.texture != Scene{}.texture; },
     [](Scene& s, const Folder&) { s.texture = "procedural"; },
     [](Scene& s) { s.texture = Scene{}.texture; }},
    {"recovery time", "20 ms", kNamesNone, kAsAsked,
     [](const Scene& s) { return s.recovery_s > 0; },
     [](Scene& s, const Folder&) { s.recovery_s = 0.02; },
     [](Scene& s) { s.recovery_s = 0; }},
    {"force shading", "on", "not asked for", kAsAsked,
     [](const Scene& s) { return s.force_shading; },
     [](Scene& s, const Folder&) { s.force_shading = true; },
     [](Scene& s) { s.force_shading = false; }},
    {"stiffness by density", "a factor of 1 everywhere", "K is the same everywhere", kAsAsked,
     [](const Scene& s) { return !s.stiffness_density.empty(); },
     [](Scene& s, const Folder&) { s.stiffness_density = {{0, 1}, {1, 1}}; },
     [](Scene& s) { s.stiffness_density.clear(); }},
    {"passivity controller", "on", "energy is only observed", "--passivity control",
     [](const Scene& s) { return s.passivity_control; },
     [](Scene& s, const Folder&) { s.passivity_control = true; },
     [](Scene& s) { s.passivity_control = false; }},
    {"edits", kBrush, "the tool has no brush", "the tool edits what it touches",
     [](const Scene& s) { return !s.edit.empty(); },
     [](Scene& s, const Folder&) { s.edit = kBrush; },
     [](Scene& s) { s.edit.clear(); s.journal.clear(); s.save.clear(); s.save_every_s = 0; }},
    {"a journal", "of those edits", "no --journal: edits are lost in a crash", "edits are kept on disk as they are made",
     [](const Scene& s) { return !s.journal.empty(); },
     [](Scene& s, const Folder& folder) {
       if (s.edit.empty()) s.edit = kBrush;
       s.journal = (folder / "journal").string();
     },
     [](Scene& s) { s.journal.clear(); }},
    {"saves", "beside the run", "no --save", "the edited volume is saved beside the run",
     [](const Scene& s) { return !s.save.empty(); },
     [](Scene& s, const Folder& folder) {
       if (s.edit.empty()) s.edit = kBrush;
       s.save = (folder / "saved.vdb").string();
     },
     [](Scene& s) { s.save.clear(); s.save_every_s = 0; }},
    {"a process for the servo", "--service", "engine and servo are one process", "the servo outlives a fault of the engine's",
     [](const Scene& s) { return s.service; },
     [](Scene& s, const Folder&) { s.service = true; },
     [](Scene& s) { s.service = false; }},
    {"a picture", "view.png", "not asked for (--picture off)", "view.png and report.html show it",
     [](const Scene& s) { return s.picture; },
     [](Scene& s, const Folder&) { s.picture = true; },
     [](Scene& s) { s.picture = false; }},
    {"a distance field", "--field distance", "the density itself is felt", "--field distance",
     [](const Scene& s) { return s.field == "distance"; },
     [](Scene& s, const Folder&) { s.field = "distance"; },
     [](Scene& s) { s.field = Scene{}.field; },
     false},
    {"a mesh of the isosurface", kTouchesMesh, "the algorithm touches the volume itself", "the algorithm touches a mesh",
     [](const Scene& s) { return algorithmEntry(s.algorithm).needs.isosurface_mesh; },
     [](Scene& s, const Folder&) { s.algorithm = kTouchesMesh; },
     [](Scene& s) { s.algorithm = Scene{}.algorithm; },
     false},
};
// clang-format on

}  // namespace

std::span<const Feature> features() {
  return kFeatures;
}

Scene bareScene(const Scene& scene) {
  Scene bare = scene;
  for (const Feature& feature : kFeatures) feature.remove(bare);
  return bare;
}

}  // namespace palpate
