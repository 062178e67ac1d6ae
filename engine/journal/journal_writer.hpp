// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_writer.hpp: keeps edits on disk while a session goes on.
//
// Records are queued; a thread of the journal's own gathers what comes within some milliseconds, writes it, waits for
// the disk (fdatasync), and only then counts it as acknowledged. The queue is bounded: who appends to a full one waits.
// Where the disk is full or fails the journal ends: what was half-written is cut off again, nothing after the
// last acknowledged record counts as saved, and the session goes on without (failure() says so).
// Threads: append calls by one thread; acknowledged() and failure() by any. Cost of an append: encoding and a lock.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/journal/journal_format.hpp"

namespace palpate {

struct JournalOptions {
  std::chrono::microseconds gather{3000};              // after the first record of a group
  std::size_t queue_bytes = std::size_t{4} << 20U;     // [byte]; a single larger record goes through alone
  std::size_t most_commands = kMostCommands;           // of one edit; more would make a record that no reader takes
  std::function<void(std::uint64_t)> on_acknowledged;  // with the newest number, in the journal's thread
};

class JournalWriter {
 public:
  // Makes the folder if it is not there, and in it a journal whose header is on disk when this returns. Throws
  // Error: kBadInput where the folder holds a journal already, kIo where it cannot be made.
  JournalWriter(const std::filesystem::path& folder, const JournalHeader& header, JournalOptions options = {});
  ~JournalWriter();  // as close()
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  // Throws Error(kBadInput) where the commands are more than one record holds: before they are applied, since an edit
  // that was applied and is not in the journal would make all that follow it another volume's.
  void checkEdit(std::span<const EditCommand> commands) const;

  // Each returns the record's sequence number, from 1. edit() throws as checkEdit(), and nothing is appended then. A
  // stamp's first use is a record of its own before the edit's; stamps of the same content are one. Cost of a stamp:
  // encoding it, every time.
  std::uint64_t edit(std::span<const EditCommand> commands);
  std::uint64_t undo() { return append(RecordKind::kUndo, {}); }
  std::uint64_t redo() { return append(RecordKind::kRedo, {}); }

  // Every record up to this number is on disk.
  [[nodiscard]] std::uint64_t acknowledged() const noexcept { return acknowledged_.load(std::memory_order_acquire); }
  // In words, why no more is saved; empty: all is well.
  [[nodiscard]] std::string failure() const;
  // Whether there is such a reason, without a lock.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t appended() const noexcept { return sequence_; }   // the appending thread's
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_.load(); }  // on disk, header included

  void flush();  // waits until all that was appended is acknowledged, or the journal has failed
  void close();  // flush() and end; nothing may be appended afterwards
  // close(), and a journal to which nothing was appended is gone, so that the same command can be given again, mended.
  void closeAndDropEmpty();

 private:
  using StampKey = std::pair<std::uint64_t, std::uint64_t>;  // length [byte] and hash of its record's content
  std::uint64_t append(RecordKind kind, std::string_view content);
  void work();
  bool writeGroup(const std::string& group);
  void fail(const std::string& what, int error);

  std::filesystem::path file_;
  JournalOptions options_;
  int descriptor_ = -1;
  std::uint64_t sequence_ = 0;
  std::map<StampKey, std::uint32_t> stamp_numbers_;  // the stamps themselves are not kept
  std::atomic<std::uint64_t> acknowledged_ = 0;
  std::atomic<std::uint64_t> bytes_ = 0;
  std::atomic<bool> failed_ = false;

  mutable std::mutex mutex_;
  std::condition_variable wake_;      // the writer: there is something, or the end
  std::condition_variable progress_;  // the others: there is room, or something was acknowledged
  std::string queue_;
  std::uint64_t queued_ = 0;  // newest sequence number in the queue or taken from it
  bool closing_ = false;
  bool hurry_ = false;  // somebody waits: gather no longer
  std::string failure_;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace palpate
