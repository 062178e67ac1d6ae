// SPDX-License-Identifier: Apache-2.0
// apps/edit/edit_job.hpp: `palpate edit`: commands as text, applied to a volume through an editing session, and the
// volume saved.
//
// Commands come through a bounded queue from a thread that reads them, so a script may be a pipe without end. What is
// written is there whole or not at all. Without keep_going the first command that is refused ends the job. Thread: the
// caller's is the engine's; `tell` is called by it. Cost: loading, the edits (docs/edits.md), one pass over what
// changed, saving.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/convert/convert_job.hpp"
#include "servo/loop/quantile.hpp"

namespace palpate {

struct EditRequest {
  std::string in, out;                                      // as loadVolume and `palpate convert` take them
  std::vector<std::string> commands;                        // first these
  std::string script;                                       // then those of this file, "-": standard input; empty: none
  std::optional<double> isovalue;                           // empty: as `palpate touch` chooses it [density]
  std::string gpu;                                          // part of the device's name; empty: the best one
  std::string json;                                         // that the caller writes the result to; empty: none
  std::string journal;                                      // folder; empty: none
  std::uint64_t history_bytes = std::uint64_t{256} << 20U;  // for undo; 0: none
  std::uint64_t gpu_memory_bytes = 0;                       // for densities and samples; 0: what the device has
  bool keep_going = false;
};

struct EditResult {
  std::string gpu;
  double isovalue = 0;
  std::uint64_t edits = 0, undone = 0, redone = 0, refused = 0;  // commands
  std::uint64_t idle = 0;                                        // of the edits, those that reached no density
  Percentiles edit_ms;                                           // of a command that was applied
  std::size_t changed_bricks = 0;                                // that hold other densities than at the start
  std::uint64_t gpu_bytes = 0;                                   // in use at the end, all of it
  std::uint64_t gpu_budgeted_bytes = 0;                          // of that, what counts against gpu_memory_bytes
  std::size_t history_steps = 0, history_forgotten = 0;
  std::uint64_t history_bytes = 0;
  std::uint64_t journal_records = 0, journal_saved = 0, journal_bytes = 0;
  std::uint64_t content = 0;  // contentHash() of what was written
  ConvertResult file;
  double seconds = 0;  // loading and all

  [[nodiscard]] std::uint64_t applied() const noexcept { return edits + undone + redone; }
};

// `tell` gets what a user should know meanwhile: a refused command that is left out, a journal that failed. Throws
// Error: kBadInput for no command, an output that is an input (the volume, the script, a stamp's mesh) or has an
// unknown suffix, an isovalue outside the volume's densities, a command that is refused (with what becomes of those
// before it); kNotFound, kIo for files; kOutOfMemory; kCancelled. Then nothing is written but the journal.
[[nodiscard]] EditResult editVolume(const EditRequest& request, Progress& progress,
                                    const std::function<void(const std::string&)>& tell);

}  // namespace palpate
