// SPDX-License-Identifier: Apache-2.0
// apps/serve/disk_answers.hpp: answers to edits that are made, held back until the edits are on the disk, in the
// journal. By the thread that edits; waiting() by any.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "base/error.hpp"
#include "engine/journal/journal_writer.hpp"

namespace palpate {

class DiskAnswers {
 public:
  using Done = std::function<void(const std::optional<Error>& refusal)>;

  // Of an edit whose record is the last that this journal was given.
  void add(const JournalWriter& journal, Done done);
  // Gives those whose edits are there by now. Has the journal failed, the others are told so.
  void settle(const JournalWriter& journal);
  [[nodiscard]] std::size_t waiting() const noexcept { return count_.load(std::memory_order_relaxed); }

 private:
  struct Made {
    std::uint64_t record = 0;  // its number in the journal
    Done done;
  };
  std::deque<Made> made_;
  std::atomic<std::size_t> count_{0};  // of them
};

}  // namespace palpate
