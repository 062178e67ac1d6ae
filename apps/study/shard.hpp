// SPDX-License-Identifier: Apache-2.0
// apps/study/shard.hpp: a part of a list of cells, for one of several machines: "2/8" is the second of eight. Any
// thread; no cost.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

struct Shard {
  int number = 1, of = 1;  // number: from 1 to `of`
  bool operator==(const Shard&) const = default;
};

inline constexpr int kMostShards = 100'000;

// Throws Error(kBadInput) for a text that is not "I/N" with whole numbers, 1 <= I <= N <= kMostShards.
[[nodiscard]] Shard shardOf(const std::string& text);

// " --shard 2/8": as a command names it.
[[nodiscard]] std::string shardWords(const Shard& shard);

// Its cells, ascending: every N-th of the list. Neighbours in a list often share what is dear to make, but also cost
// alike; dealt out this way, all shards take about the same time. Each cell is in exactly one shard.
[[nodiscard]] std::vector<std::size_t> cellsOf(const Shard& shard, std::size_t cells);

}  // namespace palpate
