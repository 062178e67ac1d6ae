// SPDX-License-Identifier: Apache-2.0
// apps/rivals/python_rivals.hpp: VTK and SciPy, whose filters a Python child runs on request (rivals.py), so that they
// take turns with the others. The volume goes through a temporary file. One thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/rivals/rival.hpp"

namespace palpate {

// A library that is not here, and what to do.
struct MissingRival {
  std::string library, why;
};

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
