// SPDX-License-Identifier: Apache-2.0
// apps/study/merge_parts.hpp: joins the results of the shards of one `palpate bench error`. Any thread.
#pragma once

#include <vector>

#include "apps/bench/benches.hpp"

namespace palpate {

// The result that one run of all cells would have had, but for costs, of which each comes from one machine. Throws
// Error(kBadInput), which names the file, if a part is of another commit, of other settings (its command but for
// --shard) or of another number of shards than the first; if it is no shard, or is joined already; if a shard is there
// twice or missing; if a row is not of its shard, or there twice. A part that the user stopped is joined; the result
// says what is missing.
[[nodiscard]] BenchResult mergeParts(const std::vector<BenchPart>& parts);

}  // namespace palpate
