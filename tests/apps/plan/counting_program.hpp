// SPDX-License-Identifier: Apache-2.0
// A program that leaves the summary of a touch as counted runs read it. What is in it follows from the scene alone, but
// for the time to the first tick, which is one millisecond more in each call.
//   bare: 2 pipelines with 3 and 4 dispatches, 1000 bytes at most on the device, 2 threads, 2 libraries
//   filter: one pipeline with 5 dispatches, 500 bytes and 20 ms more; static friction: 7 effect runs, 1 us a tick
//   picture (by default): a library more; journal: a thread more; texture: it fails
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "apps/rivals/scratch_folder.hpp"

namespace palpate {

class CountingProgram {
 public:
  CountingProgram() {
    std::ofstream file(path());
    file << "#!/bin/sh\nall=$(cat \"$2\")\necho \"$1\" $all >> '" << calls() << "'\n"
         << R"(
calls=$(wc -l < ')"
         << calls() << R"(')
bytes=1000; start=$calls; tick=2; effects=0; more_kernel=; more_thread=; more_library=', "libcairo.so.2"'
case "$all" in *"filter = "*) bytes=1500; start=$((start + 20))
  more_kernel=', {"name": "filter_convolve", "constants": ["kAxis=1"], "made_ms": 9, "dispatches": 5}';; esac
case "$all" in *"friction_static = "*) effects=7; tick=3;; esac
case "$all" in *"journal = "*) more_thread=', "journal"';; esac
case "$all" in *'picture = "off"'*) more_library=;; esac
case "$all" in *"texture = "*) echo "palpate: loading ..." >&2; echo "palpate: texture: too rough; sand it" >&2; exit 2;; esac
out=$(sed -n 's/^folder = //p' "$2" | tr -d '"')
mkdir -p "$out"
cat > "$out/summary.json" <<END
{"work": {"kernels": [{"name": "brick_bounds", "constants": [], "made_ms": 2.5, "dispatches": 3},
                      {"name": "gradient", "constants": ["kHalf=0", "kRun=8"], "made_ms": 0, "dispatches": 4}$more_kernel],
          "buffers": [{"name": "window slot", "count": 3, "bytes": 900}], "submissions": 6, "peak_bytes": $bytes,
          "threads": ["palpate", "engine"$more_thread], "effect_runs": $effects},
 "libraries": ["openvdb.so", "libc.so.6"$more_library], "plan": ["done: this"], "vulkan": {"device": "a device"},
 "servo": {"start_to_first_tick_ms": $start, "tick_cost_us": {"p50": $tick}},
 "stages": [{"name": "gradient", "seconds": 0.25}],
 "memory": [{"name": "gpu total", "bytes": 5}, {"name": "process peak", "bytes": 3145728}]}
END
)";
    file.close();
    std::filesystem::permissions(path(), std::filesystem::perms::owner_all);
    std::filesystem::create_directory(folder());
  }

  [[nodiscard]] std::string path() const { return (folder_.path() / "program").string(); }
  [[nodiscard]] std::filesystem::path folder() const { return folder_.path() / "runs"; }
  [[nodiscard]] std::vector<std::string> called() const {  // the word and the scene of each call, in a line
    std::vector<std::string> lines;
    std::ifstream file(calls());
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }

 private:
  [[nodiscard]] std::string calls() const { return (folder_.path() / "calls").string(); }
  ScratchFolder folder_;
};

}  // namespace palpate
