// SPDX-License-Identifier: Apache-2.0
// apps/edit/edit_job.hpp: `palpate edit`: applies edits given as text to a volume, in an editing session, and saves the
// volume.
//
// A second thread reads the commands and passes them through a bounded queue, so a script may be an endless pipe. The
// output file is there whole or not at all. Without keep_going the first refused command ends the job. Thread: the
// caller's thread is the engine's and calls `tell`. Cost: loading, the edits (docs/edits.md), one pass over what
// changed, saving.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/convert/convert_job.hpp"
#include "base/quantile.hpp"

namespace palpate {

struct EditRequest {
  std::string in, out;                // as loadVolume and `palpate convert` take them
  std::vector<std::string> commands;  // applied first
  std::string script;                 // file of the commands that follow; "-": standard input; empty: none
  std::optional<double> isovalue;     // empty: as `palpate touch` chooses it [density]
  std::string gpu;                    // part of the device's name; empty: the best one
  std::string json;                   // file that the caller writes the result to; empty: none
  std::string journal;                // folder; empty: none
  std::uint64_t history_bytes = std::uint64_t{256} << 20U;  // memory for undo; 0: no undo
  std::uint64_t gpu_memory_bytes = 0;                       // limit for densities and samples; 0: the device's memory
  bool keep_going = false;
};

struct EditResult {
  std::string gpu;
  double isovalue = 0;
  std::uint64_t edits = 0, undone = 0, redone = 0, refused = 0;  // commands
  std::uint64_t idle = 0;                                        // edits that reached no voxel
  Percentiles edit_ms;                                           // time of an applied command [ms]
  std::size_t changed_bricks = 0;                                // bricks whose densities differ from the start
  std::uint64_t gpu_bytes = 0;                                   // GPU memory in use at the end
  std::uint64_t gpu_budgeted_bytes = 0;                          // the part of it that counts against gpu_memory_bytes
  std::size_t history_steps = 0, history_forgotten = 0;
  std::uint64_t history_bytes = 0;
  std::uint64_t journal_records = 0, journal_saved = 0, journal_bytes = 0;
  std::uint64_t content = 0;  // contentHash() of the volume that was written
  ConvertResult file;
  double seconds = 0;  // the whole job, loading included

  [[nodiscard]] std::uint64_t applied() const noexcept { return edits + undone + redone; }
};

// `tell` gets messages for the user during the job: a refused command that is skipped, a journal that failed. Throws
// Error: kBadInput for an empty list of commands, an output that is an input (the volume, the script, a stamp's mesh)
// or has an unknown suffix, an isovalue outside the volume's densities, and a refused command (the message says what
// becomes of the commands before it); kNotFound and kIo for files; kOutOfMemory; kCancelled. Then only the journal is
// written.
[[nodiscard]] EditResult editVolume(const EditRequest& request, Progress& progress,
                                    const std::function<void(const std::string&)>& tell);

}  // namespace palpate
