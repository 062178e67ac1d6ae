// SPDX-License-Identifier: Apache-2.0
// apps/rivals/rivals.hpp: filters, gradients and pictures of other libraries, ready to be timed on the same volume as
// Palpate's.
//
// A job is named as for Palpate: "gaussian:1.5", "gradient central". A library that has a similar function offers one
// or more rivals for the job; `way` says what each runs and how that differs. Other libraries offer none. One thread
// calls the rivals. Each uses as many threads as it was made for, or `way` says that it uses one. The code that uses
// ITK and OpenVDB is in the module "rivals" (base/module.hpp).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/camera.hpp"
#include "base/vec.hpp"

namespace palpate {

// The volume. The caller must keep the densities while rivals use them.
struct RivalField {
  Vec3i size = Vec3i::Zero();        // [voxel]
  Vec3 spacing_m = Vec3::Zero();     // [m]; libraries are given millimetres
  std::span<const float> densities;  // i fastest
};

// What pictures show: the job "picture". A result holds a number a pixel, rows from the top: 1 where the object is
// seen, 0 beside it.
struct RivalView {
  Camera camera = {};   // in the field's own frame: axes along those of the voxels, the first voxel's centre at 0 [m]
  double isovalue = 0;  // density
};

// The time of a run.
struct RunCost {
  double wall_ms = 0;
  double cpu_ms = 0;  // of all threads of the process that ran it
};
[[nodiscard]] RunCost costOf(const std::function<void()>& work);

struct Rival {
  std::string library;  // "ITK"
  std::string way;      // "GradientImageFilter"
  // Runs once, from the volume in memory to a new result in memory, as the library's users do. `result`: if not null,
  // receives the result, unmeasured; i fastest, the components of a gradient side by side. Throws Error.
  std::function<RunCost(std::vector<float>* result)> run;
};

// ITK reads the volume where it lies.
[[nodiscard]] std::vector<Rival> itkRivals(const std::string& job, const RivalField& field, unsigned threads);

// OpenVDB works on a copy of the field, a grid whose voxels are all active. The first job makes it; rivals keep it
// alive. Memory: the grid, and a second one while a filter that works in place runs.
class OpenVdbRivals {
 public:
  OpenVdbRivals(const RivalField& field, unsigned threads);
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& job) const;
  // A picture of a level set of the isosurface, of which the cells are cubes with the field's shortest edge. It is made
  // once for each isovalue, unmeasured.
  [[nodiscard]] std::vector<Rival> picturesOf(const RivalView& view) const;
  // How far along the ray through each pixel its ray tracer finds that level set [m]; infinity where it does not. Rows
  // from the top. Unmeasured.
  [[nodiscard]] std::vector<float> distancesOf(const RivalView& view) const;

  class Library;  // rivals_module.hpp

 private:
  std::shared_ptr<const Library> library_;
};

// A library that is not installed, with what to do; or one that cannot do one job alone.
struct MissingRival {
  std::string library, why;
  std::string job = {};  // empty: all
};

// VTK and SciPy. A Python child (rivals.py) runs their filters on request, so they can take turns with the others. It
// gets the volume through a temporary file.
class PythonRivals {
 public:
  // `python`: the interpreter that has these modules (Debian's), with its options.
  explicit PythonRivals(unsigned threads, const std::vector<std::string>& python = {"/usr/bin/python3"});
  ~PythonRivals();

  [[nodiscard]] const std::vector<MissingRival>& missing() const noexcept { return missing_; }

  // Gives the child the volume on which the following jobs run. If this fails, returns the reason, and there are no
  // rivals any more: TMPDIR has no room for the volume, or the child had no memory for it and ended. Throws
  // Error(kCancelled) on Ctrl-C.
  [[nodiscard]] std::optional<std::string> load(const RivalField& field);
  // What pictures show from now on. Throws Error.
  void see(const RivalView& view);
  // The rivals may be run while this object lives, on the volume loaded last.
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& job);

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::vector<MissingRival> missing_;
};

}  // namespace palpate
