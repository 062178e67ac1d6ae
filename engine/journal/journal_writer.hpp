// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_writer.hpp: keeps edits on disk while a session goes on.
//
// Records go into a queue. The journal's own thread gathers the records of a few milliseconds, writes them and waits
// for the disk (fdatasync). Only then are they acknowledged. The queue is bounded: an append to a full queue waits.
//
// If the disk is full or fails, or the file is not there any more, which is looked for with every group and each
// second, the journal ends. It cuts a half-written record off, saves nothing after the last acknowledged record, and
// reports that in failure(). The session goes on without a journal. The journal also ends if there is no memory for a
// record, since later edits without that one would lead to a different volume. Records that were queued before are
// still saved.
//
// A journal that has ended can begin anew, with the volume as the edits have made it until then: a new file replaces
// the old one, and what follows is kept again.
//
// Threads: one thread appends; any thread may call acknowledged(), failure(), failed() and timesMended(). Cost of an
// append: encoding and a lock; of an undo or redo that the file cannot have, a wait for what is queued.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/descriptor.hpp"
#include "base/leftover.hpp"
#include "engine/journal/journal_format.hpp"

namespace palpate {

struct JournalOptions {
  std::chrono::microseconds gather{3000};           // wait for more records after the first of a group
  std::size_t queue_bytes = std::size_t{4} << 20U;  // limit of the queue [byte]; a larger record is queued alone
  // Gets the newest record's number, in the journal's thread, or in that of beginAnew().
  std::function<void(std::uint64_t)> on_acknowledged;
};

// The volume with which a journal begins, if that is another one than its header's: as earlier edits have made it.
struct JournalBeginning {
  EditMark mark;                          // of these edits
  const Volume* volume = nullptr;         // read where it is given, and not later
  std::span<const std::uint32_t> bricks;  // that they may have changed, ascending
};

class JournalWriter {
 public:
  // Makes a journal in `folder`, and the folder if it does not exist. On return the header is on disk, with the folder
  // entries that lead to it, and with the records of the beginning, if there is one. Throws Error: kBadInput if the
  // folder holds a journal already, kIo if the journal cannot be made.
  JournalWriter(const std::filesystem::path& folder, const JournalHeader& header, JournalOptions options = {},
                const std::optional<JournalBeginning>& beginning = {});
  ~JournalWriter();  // as close()
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  // These append a record and return its sequence number, counted from 1. They throw nothing. The edit has been applied
  // already, so either its record is in the journal or the journal has ended. The first use of a stamp puts the stamp's
  // record before the edit's. Later commands with a stamp of the same content refer to that record. Cost of a stamp: it
  // is encoded at every use.
  std::uint64_t edit(std::span<const EditCommand> commands, RecordKind kind = RecordKind::kEdit) noexcept;
  std::uint64_t undo() noexcept;
  std::uint64_t redo() noexcept;

  // Saves what is queued, then ends the journal for good. For a caller that cannot tell whether an edit was applied.
  // `what` and `error` (an errno value) become part of failure().
  void end(const char* what, int error) noexcept;

  // Whether it has ended, and may begin anew. It has, and has not failed, where an undo or redo is of what it began
  // with: that it can only have in another beginning. Appending thread.
  [[nodiscard]] bool canBeginAnew() const noexcept { return (failed() || is_behind_) && !ended_for_good_ && !gathers_; }
  // From now on records queue again, and beginAnew() follows. `edits`: how many were made until now, undo and redo
  // included. Appending thread, if canBeginAnew(). Nothing is acknowledged before beginAnew() is done, and a record
  // that finds the queue full ends the journal as before.
  void gatherAnew(std::uint64_t edits) noexcept;
  // For a caller who cannot call beginAnew() now, or ever: then it has failed.
  void failIfBehind() noexcept;
  // Makes a new file, which begins with the volume as it was at gatherAnew(), in place of the old one, or where that
  // was removed. No other session's journal is replaced. Then the journal has not failed any more, and all that was
  // appended before is acknowledged. Until it returns nothing else is called but appends, acknowledged(), failure() and
  // failed(). Any one thread. Throws Error(kIo): then it has ended as before. Cost: writing the bricks, and waiting for
  // the disk.
  void beginAnew(const JournalBeginning& beginning);

  // Number of the newest record on disk. All records before it are on disk too.
  [[nodiscard]] std::uint64_t acknowledged() const noexcept { return acknowledged_.load(std::memory_order_acquire); }
  // Why nothing more is saved, as text; empty while all is well. The text names the last edit that is saved, by its
  // number and by the number of its record. The former counts edits, undos and redos (Engine::editVersion), the latter
  // stamps too.
  [[nodiscard]] std::string failure() const;
  // Whether the journal has failed, without a lock.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }
  // How often it has begun anew after it had failed.
  [[nodiscard]] std::uint64_t timesMended() const noexcept { return times_mended_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t appended() const noexcept { return sequence_; }   // appending thread only
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_.load(); }  // on disk, header included; 0: deleted

  // Waits until everything appended is acknowledged, or the journal has ended. Whether all is, in a file that is there.
  bool flush();
  // Flushes and ends; nothing may be appended afterwards. Deletes the journal if it failed before it acknowledged a
  // record.
  void close();
  // As close(). Also deletes a journal that acknowledged no record, so that the same command can be given again.
  void closeAndDropEmpty();

 private:
  using StampKey = std::pair<std::uint64_t, std::uint64_t>;  // length [byte] and hash of its record's content
  struct Newest {
    std::uint64_t record = 0;
    std::uint64_t edit = 0;  // counts undo and redo, not stamps
  };
  // A file with a header and a beginning that has the journal's name. Throws Error.
  struct Made {
    Descriptor descriptor{};
    std::uint64_t bytes = 0;
    Leftover leftover{};  // removes a journal without a record if the program dies
    int unflushed = 0;    // errno: why a power cut may take it away again
  };
  [[nodiscard]] Made makeFile(const JournalBeginning* beginning, std::uint64_t last) const;
  template <typename Work>
  std::uint64_t appendOrEnd(const Work& work) noexcept;
  void append(RecordKind kind, std::string_view content);
  [[nodiscard]] bool makeRoom(std::unique_lock<std::mutex>& lock, std::size_t bytes);
  std::vector<std::uint32_t> stampNumbers(std::span<const EditCommand> commands);
  void work();
  bool writeGroup(const std::string& group);
  void fail(const char* what, int error) noexcept;
  void noteFailure(const char* what, int error) noexcept;
  void stopTaking(const char* what, int error) noexcept;
  void stopThread();
  void dropEmpty() noexcept;

  std::filesystem::path file_;
  std::string header_bytes_;
  JournalOptions options_;
  Descriptor descriptor_;
  Leftover leftover_;
  std::uint64_t sequence_ = 0;
  RecordOrder order_;                                // of the records that the file has or will have
  std::map<StampKey, std::uint32_t> stamp_numbers_;  // numbers only: the stamps are not kept
  std::atomic<std::uint64_t> acknowledged_ = 0;
  std::atomic<std::uint64_t> bytes_ = 0;
  std::atomic<bool> failed_ = false;
  std::atomic<bool> is_behind_ = false;  // canBeginAnew(), and has not failed
  std::atomic<bool> ended_for_good_ = false;
  std::atomic<std::uint64_t> times_mended_ = 0;
  std::atomic<bool> gathers_ = false;  // for a file that is being made; set and reset under the lock

  mutable std::mutex mutex_;
  std::condition_variable wake_;      // wakes the writing thread: there is a record, or the end
  std::condition_variable progress_;  // wakes the others: there is room, or something was acknowledged
  std::string queue_;
  Newest queued_;   // the newest that entered the queue
  Newest on_disk_;  // the newest that is acknowledged
  Newest anew_;     // the newest that the file which is being made begins with
  bool closing_ = false;
  bool hurry_ = false;  // an append or a flush waits, so the thread stops gathering
  bool ended_ = false;  // the thread takes nothing more, and goes
  // failure() makes its text from these: when memory runs out there is none for a text.
  const char* failure_ = nullptr;  // what failed; null: nothing
  int failure_error_ = 0;
  std::thread thread_;  // last: it uses the rest
};

}  // namespace palpate
