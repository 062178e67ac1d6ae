// SPDX-License-Identifier: Apache-2.0
#include "apps/study/merge_parts.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/study/shard.hpp"
#include "apps/study/study_analysis.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr const char* kRemedy = "give every shard of one run, each once: the files of --shard 1/N to --shard N/N";

[[noreturn]] void refusePart(const BenchPart& part, const std::string& reason) {
  refuse(part.file, reason, kRemedy);
}

// The whole number under `key`, within bounds.
std::int64_t wholeIn(const BenchPart& part, const BenchRow& row, const char* key, std::int64_t least,
                     std::int64_t most) {
  const BenchFigure* figure = findFigure(row, key);
  const auto* number = figure == nullptr ? nullptr : std::get_if<std::int64_t>(figure);
  if (number == nullptr || *number < least || *number > most) {
    refusePart(part, fmt::format("a row of part '{}' has no whole number '{}' from {} to {}", textOf(row, "part"), key,
                                 least, most));
  }
  return *number;
}

struct Part {
  const BenchPart* of = nullptr;
  Shard shard;
  std::size_t cells = 0;  // of all shards
  std::string command;    // without --shard
};

constexpr std::int64_t kMostCells = 10'000'000;

Part partOf(const BenchPart& part) {
  const BenchRows rows = rowsOf(part.result, "shard");
  if (rows.empty()) refusePart(part, "it is no shard of a bench");
  if (rows.size() > 1) refusePart(part, "it is joined already");
  const std::int64_t of = wholeIn(part, *rows[0], "shards", 1, kMostShards);
  const Shard shard{static_cast<int>(wholeIn(part, *rows[0], "shard", 1, of)), static_cast<int>(of)};
  std::string command = part.result.command;
  if (const std::size_t at = command.find(shardWords(shard)); at != std::string::npos) {
    command.erase(at, shardWords(shard).size());
  }
  return {&part, shard, static_cast<std::size_t>(wholeIn(part, *rows[0], "cells", 0, kMostCells)), std::move(command)};
}

void checkAgainst(const Part& first, const Part& part) {
  const auto differs = [&](const char* what, const std::string& own, const std::string& other) {
    if (own == other) return;
    refusePart(*part.of, fmt::format("its {} is '{}', and that of {} is '{}'", what, own, first.of->file, other));
  };
  differs("bench", part.of->result.bench, first.of->result.bench);
  differs("commit", part.of->result.commit, first.of->result.commit);
  differs("command without --shard", part.command, first.command);
  differs("number of shards", std::to_string(part.shard.of), std::to_string(first.shard.of));
  differs("number of cells", std::to_string(part.cells), std::to_string(first.cells));
}

// Every shard is there once.
void checkShards(const std::vector<Part>& parts) {
  std::map<int, const BenchPart*> found;
  for (const Part& part : parts) {
    const auto [at, is_new] = found.emplace(part.shard.number, part.of);
    if (!is_new) refusePart(*part.of, fmt::format("it is shard {}, as {} is", part.shard.number, at->second->file));
  }
  std::vector<int> missing;
  for (int number = 1; number <= parts.front().shard.of && missing.size() < 10; ++number) {
    if (!found.contains(number)) missing.push_back(number);
  }
  if (missing.empty()) return;
  refusePart(*parts.front().of, fmt::format("of its {} shards {} {} missing", parts.front().shard.of,
                                            fmt::join(missing, ", "), missing.size() == 1 ? "is" : "are"));
}

// The rows of the part's cells, by the number of each.
std::map<std::size_t, const BenchRow*> cellsIn(const Part& part) {
  std::map<std::size_t, const BenchRow*> cells;
  for (const Study& study : studies()) {
    for (const BenchRow* row : rowsOf(part.of->result, study.name)) {
      const auto last = static_cast<std::int64_t>(part.cells) - 1;
      const auto cell = static_cast<std::size_t>(wholeIn(*part.of, *row, "cell", 0, std::max<std::int64_t>(last, 0)));
      const bool own =
          cell % static_cast<std::size_t>(part.shard.of) == static_cast<std::size_t>(part.shard.number - 1);
      if (!own) refusePart(*part.of, fmt::format("cell {} is not of its shard", cell));
      if (!cells.emplace(cell, row).second) refusePart(*part.of, fmt::format("cell {} is there twice", cell));
    }
  }
  return cells;
}

// "A" if all parts have it, "1: A; 2: B" with the numbers of the shards otherwise.
std::string joinedWords(const std::vector<Part>& parts, std::string BenchResult::*words) {
  std::vector<std::string> each;
  std::set<std::string> different;
  for (const Part& part : parts) {
    each.push_back(fmt::format("shard {}: {}", part.shard.number, part.of->result.*words));
    different.insert(part.of->result.*words);
  }
  return different.size() == 1 ? *different.begin() : fmt::format("{}", fmt::join(each, "; "));
}

}  // namespace

BenchResult mergeParts(const std::vector<BenchPart>& files) {
  if (files.empty()) refuse("palpate bench merge", "there is nothing to join", kRemedy);
  std::vector<Part> parts;
  for (const BenchPart& file : files) {
    parts.push_back(partOf(file));
    checkAgainst(parts.front(), parts.back());
  }
  checkShards(parts);
  std::ranges::sort(parts, {}, [](const Part& part) { return part.shard.number; });
  BenchResult result;
  result.bench = files.front().result.bench;
  result.commit = files.front().result.commit;
  result.command = parts.front().command;
  result.machine = joinedWords(parts, &BenchResult::machine);
  result.vulkan_device = joinedWords(parts, &BenchResult::vulkan_device);
  std::map<std::size_t, const BenchRow*> cells;
  for (const Part& part : parts) {
    result.rows.push_back(*rowsOf(part.of->result, "shard").front());
    cells.merge(cellsIn(part));
  }
  for (const auto& [number, row] : cells) result.rows.push_back(*row);
  analyse(result);
  return result;
}

}  // namespace palpate
