// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_writer.hpp: keeps edits on disk while a session goes on.
//
// Records are queued; a thread of the journal's own gathers what comes within some milliseconds, writes it, waits for
// the disk (fdatasync), and only then counts it as acknowledged. The queue is bounded: who appends to a full one waits.
// Where the disk is full or fails the journal ends: what was half-written is cut off again, nothing after the
// last acknowledged record counts as saved, and the session goes on without (failure() says so). It ends too where
// there is no memory for a record, since those that follow would make another volume; what was queued before is still
// saved. Threads: append calls by one thread; acknowledged() and failure() by any. Cost of an append: encoding and a
// lock.
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

#include "base/leftover.hpp"
#include "engine/journal/journal_format.hpp"

namespace palpate {

struct JournalOptions {
  std::chrono::microseconds gather{3000};              // after the first record of a group
  std::size_t queue_bytes = std::size_t{4} << 20U;     // [byte]; a single larger record goes through alone
  std::function<void(std::uint64_t)> on_acknowledged;  // with the newest number, in the journal's thread
};

class JournalWriter {
 public:
  // Makes the folder if it is not there, and in it a journal whose header is on disk when this returns, with all that
  // leads to it. Throws
  // Error: kBadInput where the folder holds a journal already, kIo where it cannot be made.
  JournalWriter(const std::filesystem::path& folder, const JournalHeader& header, JournalOptions options = {});
  ~JournalWriter();  // as close()
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  // Each returns the record's sequence number, from 1, and throws nothing: an edit has been applied when it comes here,
  // so it is in the journal or the journal has ended. A stamp's first use is a record of its own before the edit's;
  // stamps of the same content are one. Cost of a stamp: encoding it, every time.
  std::uint64_t edit(std::span<const EditCommand> commands) noexcept;
  std::uint64_t undo() noexcept;
  std::uint64_t redo() noexcept;

  // What was queued is saved, and the journal ends there: for who cannot say whether an edit was applied.
  void end(const char* what, int error) noexcept;

  // Every record up to this number is on disk.
  [[nodiscard]] std::uint64_t acknowledged() const noexcept { return acknowledged_.load(std::memory_order_acquire); }
  // In words, why no more is saved, and up to which edit all is (a number as Engine::editVersion counts them: undo and
  // redo too) and which record (stamps too); empty: all is well.
  [[nodiscard]] std::string failure() const;
  // Whether there is such a reason, without a lock.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t appended() const noexcept { return sequence_; }   // the appending thread's
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_.load(); }  // on disk, header included

  void flush();  // waits until all that was appended is acknowledged, or the journal has failed
  // flush() and end; nothing may be appended afterwards. A journal that failed before anything was acknowledged is
  // gone.
  void close();
  // close(), and a journal in which nothing was acknowledged is gone, so that the same command can be given again.
  void closeAndDropEmpty();

 private:
  using StampKey = std::pair<std::uint64_t, std::uint64_t>;  // length [byte] and hash of its record's content
  struct Newest {
    std::uint64_t record = 0;
    std::uint64_t edit = 0;  // undo and redo counted, stamps not
  };
  template <typename Work>
  std::uint64_t appendOrEnd(const Work& work) noexcept;
  void append(RecordKind kind, std::string_view content);
  std::vector<std::uint32_t> stampNumbers(std::span<const EditCommand> commands);
  void work();
  bool writeGroup(const std::string& group);
  void fail(const char* what, int error) noexcept;
  void drop() noexcept;

  std::filesystem::path file_;
  JournalOptions options_;
  int descriptor_ = -1;
  Leftover leftover_;  // the journal, as long as it has no record
  bool dropped_ = false;
  std::uint64_t sequence_ = 0;
  std::map<StampKey, std::uint32_t> stamp_numbers_;  // the stamps themselves are not kept
  std::atomic<std::uint64_t> acknowledged_ = 0;
  std::atomic<std::uint64_t> bytes_ = 0;
  std::atomic<bool> failed_ = false;

  mutable std::mutex mutex_;
  std::condition_variable wake_;      // the writer: there is something, or the end
  std::condition_variable progress_;  // the others: there is room, or something was acknowledged
  std::string queue_;
  Newest queued_;   // in the queue or taken from it
  Newest on_disk_;  // acknowledged_ and its edit
  bool closing_ = false;
  bool hurry_ = false;  // somebody waits: gather no longer
  bool ended_ = false;  // the thread takes nothing more
  // Made into words when somebody asks: where memory is short there is none for them.
  const char* failure_ = nullptr;  // what failed
  int failure_error_ = 0;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace palpate
