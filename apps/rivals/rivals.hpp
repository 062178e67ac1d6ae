// SPDX-License-Identifier: Apache-2.0
// apps/rivals/rivals.hpp: filters and gradients of other libraries on the volume that Palpate has too, ready to be
// timed.
//
// A job is what Palpate is asked for, as text: "gaussian:1.5", "gradient central". A library that has something alike
// offers one or more rivals for it and says in `way` what it runs and how that differs; one that has nothing alike
// offers none. One thread calls them; each takes as many threads as it was made for, or says that it takes one.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

// The volume, which the caller keeps while rivals live.
struct RivalField {
  Vec3i size = Vec3i::Zero();        // [voxel]
  Vec3 spacing_m = Vec3::Zero();     // [m]; libraries are given millimetres
  std::span<const float> densities;  // i fastest
};

// What a run took.
struct RunCost {
  double wall_ms = 0;
  double cpu_ms = 0;  // of all threads of the process that ran it
};
[[nodiscard]] RunCost costOf(const std::function<void()>& work);

struct Rival {
  std::string library;  // "ITK"
  std::string way;      // "GradientImageFilter"
  // Runs once: from the volume in memory to a result in memory that is made anew, as the library's users have it.
  // `result`: gets it, unmeasured, i fastest, a gradient's components together; null: it is thrown away. Throws Error.
  std::function<RunCost(std::vector<float>* result)> run;
};

// ITK reads the volume where it lies.
[[nodiscard]] std::vector<Rival> itkRivals(const std::string& job, const RivalField& field, unsigned threads);

// OpenVDB, on a grid whose every voxel is active: a copy of the field, made when a job first needs it. Memory: the
// grid, and another while a filter that works in place runs. Rivals keep the grid alive.
class OpenVdbRivals {
 public:
  OpenVdbRivals(const RivalField& field, unsigned threads);
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& job) const;

  struct State;

 private:
  std::shared_ptr<State> state_;
};

// A library that is not here, and what to do.
struct MissingRival {
  std::string library, why;
};

// VTK and SciPy, whose filters a Python child runs on request (rivals.py), so that they take turns with the others. The
// volume goes through a temporary file.
class PythonRivals {
 public:
  // `python`: the interpreter with its options, which Debian's modules belong to.
  explicit PythonRivals(unsigned threads, const std::vector<std::string>& python = {"/usr/bin/python3"});
  ~PythonRivals();

  [[nodiscard]] const std::vector<MissingRival>& missing() const noexcept { return missing_; }

  // From here on rivals work on this volume. Returns why there are none any more, where it could not be handed to them:
  // TMPDIR has no room for it, or the child had no memory for it and ended. Throws Error(kCancelled) on Ctrl-C.
  [[nodiscard]] std::optional<std::string> load(const RivalField& field);
  // They may be run while this lives, on the volume loaded last.
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& job);

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::vector<MissingRival> missing_;
};

}  // namespace palpate
