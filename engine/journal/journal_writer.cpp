// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/durable_io.hpp"
#include "base/error.hpp"
#include "base/file_lock.hpp"
#include "base/part_file.hpp"
#include "base/thread_names.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuseFile(const fs::path& file, int error) {
  throw Error(Error::Code::kIo, file.string(), fmt::format("no journal can be kept there ({})", std::strerror(error)),
              "make room or choose another folder with --journal");
}

constexpr std::chrono::seconds kLookAtFile{1};
constexpr const char* kGone = "it is not where it was";

constexpr const char* kBehind = "an undo or redo is of edits that it began with, and it cannot begin anew";

// How many records the bricks fill that a journal begins with.
std::uint64_t recordsFor(std::size_t bricks) {
  constexpr std::size_t kBricksInARecord = std::size_t{1} << 14U;  // 32 MiB
  return std::max<std::uint64_t>(1, (bricks + kBricksInARecord - 1) / kBricksInARecord);
}

// Others on this disk need some room, too.
bool hasRoom(int descriptor, std::size_t bytes) {
  constexpr std::uint64_t kLeft_bytes = 16'384;
  struct statvfs room {};
  return fstatvfs(descriptor, &room) != 0 || room.f_bavail * room.f_frsize >= bytes + kLeft_bytes;
}

// Writes them as so many records, the last of which has the number `last`, and counts their bytes. A failure: as an
// errno value.
int writeBeginning(int descriptor, const JournalBeginning& beginning, std::uint64_t records, std::uint64_t last,
                   std::uint64_t& bytes) {
  std::span<const std::uint32_t> rest = beginning.bricks;
  const std::size_t piece = (rest.size() + records - 1) / records;
  for (std::uint64_t number = last - records + 1; number <= last; ++number) {
    const auto bricks = rest.first(std::min(rest.size(), piece));
    rest = rest.subspan(bricks.size());
    const std::string content = bricksContent(beginning.mark, number == last, *beginning.volume, bricks);
    if (content.size() > kLongestRecord) return EFBIG;
    const std::string record = recordBytes(RecordKind::kBricks, number, content);
    bytes += record.size();
    if (!hasRoom(descriptor, record.size())) return ENOSPC;
    if (const int failed = writeAll(descriptor, record); failed != 0) return failed;
  }
  return 0;
}

}  // namespace

JournalWriter::JournalWriter(const fs::path& folder, const JournalHeader& header, JournalOptions options,
                             const std::optional<JournalBeginning>& beginning)
    : file_(journalFile(folder)), header_bytes_(headerBytes(header)), options_(std::move(options)) {
  if (beginning) sequence_ = recordsFor(beginning->bricks.size());
  Made made = makeFile(beginning ? &*beginning : nullptr, sequence_);
  if (made.unflushed != 0) {
    unlink(file_.c_str());
    refuseFile(folder, made.unflushed);
  }
  descriptor_ = std::move(made.descriptor);
  leftover_ = std::move(made.leftover);
  bytes_ = made.bytes;
  if (beginning) leftover_.release();  // it is worth keeping without a record
  acknowledged_ = sequence_;
  queued_ = on_disk_ = {sequence_, beginning ? beginning->mark.edits : 0};
  thread_ = std::thread([this] { work(); });
}

// The file is written under a temporary name first, so that a journal without a header never exists.
JournalWriter::Made JournalWriter::makeFile(const JournalBeginning* beginning, std::uint64_t last) const {
  const fs::path folder = file_.parent_path();
  if (const int unmade = makeFolder(folder, Rights::kPrivate); unmade != 0) refuseFile(folder, unmade);
  PartFile draft = openPartFile(file_, Rights::kPrivate);
  if (draft.descriptor < 0) refuseFile(file_, draft.error);
  Made made{.descriptor = Descriptor(draft.descriptor), .bytes = header_bytes_.size()};
  int failed = writeAll(made.descriptor.get(), header_bytes_);
  if (failed == 0 && last > 0) {
    const std::uint64_t records = std::min(recordsFor(beginning->bricks.size()), last);
    failed = writeBeginning(made.descriptor.get(), *beginning, records, last, made.bytes);
  }
  if (failed == 0 && fsync(made.descriptor.get()) != 0) failed = errno;
  if (failed == 0 && isNameOf(file_, descriptor_.get())) {  // asked this late: writing may have taken minutes
    if (rename(draft.name.c_str(), file_.c_str()) != 0) failed = errno;
  } else if (failed == 0) {
    made.leftover = Leftover::file([&] {
      // link() never replaces an existing journal.
      if (link(draft.name.c_str(), file_.c_str()) != 0) failed = errno;
      return failed == 0 ? file_ : fs::path();
    });
  }
  unlink(draft.name.c_str());
  draft.leftover.release();
  if (failed == EEXIST)
    throw Error(Error::Code::kBadInput, folder.string(), "it holds the journal of another session",
                "recover that with 'palpate recover', or choose another folder with --journal");
  if (failed != 0) refuseFile(file_, failed);
  made.unflushed = flushFolder(folder);
  return made;
}

JournalWriter::~JournalWriter() {
  close();
}

template <typename Work>
std::uint64_t JournalWriter::appendOrEnd(const Work& work) noexcept {
  if (!gathers_ && failed()) return ++sequence_;  // never acknowledged
  try {
    work();
  } catch (...) {
    ++sequence_;  // of the record that is missing: the last that was appended may be a stamp's, which gets to the disk
    flush();
    stopTaking("there was no memory for a record", ENOMEM);
  }
  return sequence_;
}

std::uint64_t JournalWriter::edit(std::span<const EditCommand> commands, RecordKind kind) noexcept {
  // What it would go on with may be something that the journal began with.
  const RecordKind known = order_.done() == 0 ? RecordKind::kEdit : kind;
  return appendOrEnd([&] { append(known, editContent(commands, stampNumbers(commands))); });
}
std::uint64_t JournalWriter::undo() noexcept {
  return appendOrEnd([&] { append(RecordKind::kUndo, {}); });
}
std::uint64_t JournalWriter::redo() noexcept {
  return appendOrEnd([&] { append(RecordKind::kRedo, {}); });
}

std::vector<std::uint32_t> JournalWriter::stampNumbers(std::span<const EditCommand> commands) {
  std::vector<std::uint32_t> numbers;
  for (const EditCommand& command : commands) {
    std::uint32_t number = 0;
    if (isStamp(command.kind) && command.stamp) {
      const std::string content = stampContent(*command.stamp);
      const auto [known, is_new] = stamp_numbers_.try_emplace({content.size(), bytesHash(content)},
                                                              static_cast<std::uint32_t>(stamp_numbers_.size() + 1));
      if (is_new) append(RecordKind::kStamp, content);
      number = known->second;
    }
    numbers.push_back(number);
  }
  return numbers;
}

void JournalWriter::append(RecordKind kind, std::string_view content) {
  if (kind != RecordKind::kStamp && !order_.follow(kind)) {
    flush();
    ++sequence_;
    return stopTaking(nullptr, 0);
  }
  const std::string bytes = recordBytes(kind, sequence_ + 1, content);
  std::unique_lock lock(mutex_);
  const bool has_room = makeRoom(lock, bytes.size());
  if (has_room) queue_ += bytes;
  ++sequence_;
  if (!has_room) return;
  queued_ = {sequence_, queued_.edit + (kind == RecordKind::kStamp ? 0 : 1)};
  wake_.notify_one();
}

// False: the journal has ended.
bool JournalWriter::makeRoom(std::unique_lock<std::mutex>& lock, std::size_t bytes) {
  const auto room = [&] { return queue_.empty() || queue_.size() + bytes <= options_.queue_bytes; };
  if (gathers_ && !room()) {  // nobody takes anything out of it yet, and an edit does not wait for that
    gathers_ = false;
    queue_.clear();
    noteFailure("its queue was full before it had begun anew", ENOMEM);
  } else if (!room() && !ended_) {
    hurry_ = true;
    wake_.notify_one();
    progress_.wait(lock, [&] { return room() || ended_; });
  }
  return gathers_ || !ended_;
}

void JournalWriter::work() {
  nameThisThread("journal");
  std::unique_lock lock(mutex_);
  for (;;) {
    // Now and then it looks whether its file is there, also when nothing comes.
    if (!wake_.wait_for(lock, kLookAtFile, [&] { return !queue_.empty() || closing_ || ended_; })) {
      if (isNameOf(file_, descriptor_.get())) continue;
      lock.unlock();
      fail(kGone, ENOENT);
      lock.lock();
      ended_ = true;
      progress_.notify_all();
      return;
    }
    if (ended_ || queue_.empty()) return;
    wake_.wait_for(lock, options_.gather, [&] { return closing_ || hurry_ || queue_.size() >= options_.queue_bytes; });
    hurry_ = false;
    const std::string group = std::exchange(queue_, {});
    const Newest newest = queued_;
    progress_.notify_all();
    lock.unlock();
    const bool saved = writeGroup(group);
    if (saved) {
      leftover_.release();  // from now on it has records and must be kept
      bytes_ += group.size();
      acknowledged_.store(newest.record, std::memory_order_release);
      if (options_.on_acknowledged) options_.on_acknowledged(newest.record);
    }
    lock.lock();
    if (saved) on_disk_ = newest;
    ended_ = !saved;
    progress_.notify_all();
    if (!saved) {
      if (!gathers_) queue_.clear();
      return;
    }
  }
}

bool JournalWriter::writeGroup(const std::string& group) {
  int error = writeAll(descriptor_.get(), group);
  if (error == 0 && fdatasync(descriptor_.get()) != 0) error = errno;
  if (error == 0 && isNameOf(file_, descriptor_.get())) return true;
  if (error == 0) {  // written, but nobody will find it
    fail(kGone, ENOENT);
    return false;
  }
  // If even this fails, the reader finds a record that is cut short. It then recovers the same and reports the loss.
  if (ftruncate(descriptor_.get(), static_cast<off_t>(bytes_.load())) == 0)
    static_cast<void>(fdatasync(descriptor_.get()));
  fail("it cannot be written", error);
  return false;
}

// Flushes first, so that it is known up to which edit all is saved.
void JournalWriter::end(const char* what, int error) noexcept {
  ended_for_good_ = true;
  flush();
  stopTaking(what, error);
}

// With a failure, or, without one, as it is behind. All at once: beginAnew() may come to its end beside this.
void JournalWriter::stopTaking(const char* what, int error) noexcept {
  const std::lock_guard lock(mutex_);
  gathers_ = false;
  queue_.clear();
  if (what != nullptr) noteFailure(what, error);
  is_behind_ = failure_ == nullptr;
  ended_ = true;
  wake_.notify_one();
  progress_.notify_all();
}

void JournalWriter::failIfBehind() noexcept {
  if (is_behind_ || gathers_) stopTaking(kBehind, 0);
}

void JournalWriter::gatherAnew(std::uint64_t edits) noexcept {
  const std::lock_guard lock(mutex_);
  queue_.clear();
  stamp_numbers_.clear();
  order_ = {};
  queued_ = anew_ = {sequence_, edits};
  gathers_ = true;
  is_behind_ = false;
}

void JournalWriter::beginAnew(const JournalBeginning& beginning) {
  stopThread();
  try {
    Made made = makeFile(&beginning, anew_.record);
    descriptor_ = std::move(made.descriptor);
    leftover_ = std::move(made.leftover);
    if (anew_.record > 0) leftover_.release();
    bytes_ = made.bytes;
    // After a power cut there may be the old file or the new one. Either has what is acknowledged until now.
    if (made.unflushed != 0) refuseFile(file_.parent_path(), made.unflushed);
  } catch (...) {
    stopTaking(kBehind, 0);  // if it had not failed before
    throw;
  }
  acknowledged_.store(anew_.record, std::memory_order_release);
  // Before the thread tells of newer ones.
  if (options_.on_acknowledged) options_.on_acknowledged(anew_.record);
  const std::lock_guard lock(mutex_);
  on_disk_ = anew_;
  if (!gathers_) return;  // records that followed are lost again
  try {
    thread_ = std::thread([this] { work(); });  // which waits for the lock
  } catch (const std::system_error& error) {
    noteFailure("no thread can be started for it", error.code().value());
    gathers_ = false;
    queue_.clear();
    throw;
  }
  if (std::exchange(failure_, nullptr) != nullptr) ++times_mended_;
  ended_ = false;
  failed_.store(false, std::memory_order_release);  // before the next line: appendOrEnd()
  gathers_ = false;
}

void JournalWriter::stopThread() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    wake_.notify_one();
  }
  thread_.join();
  closing_ = false;
}

void JournalWriter::fail(const char* what, int error) noexcept {
  const std::lock_guard lock(mutex_);
  noteFailure(what, error);
}

// Under the lock. The first one counts.
void JournalWriter::noteFailure(const char* what, int error) noexcept {
  if (failure_ != nullptr) return;
  failure_ = what;
  failure_error_ = error;
  failed_.store(true, std::memory_order_release);
}

std::string JournalWriter::failure() const {
  const std::lock_guard lock(mutex_);
  if (failure_ == nullptr) return {};
  if (failure_ == kGone)
    return fmt::format(
        "{}: it is not where it was: somebody has removed or moved it, and its edits with it; save the "
        "volume itself",
        file_.string());
  const std::string record = on_disk_.edit == 0 ? "" : fmt::format(" (record {} of the journal)", on_disk_.record);
  if (failure_ == kBehind)
    return fmt::format("{}: {}; edits after number {}{} are not saved: save the volume itself", file_.string(),
                       failure_, on_disk_.edit, record);
  return fmt::format("{}: {} ({}); edits after number {}{} are not saved: {}save the volume itself", file_.string(),
                     failure_, std::strerror(failure_error_), on_disk_.edit, record,
                     failure_error_ == ENOMEM ? "" : "make room and ");
}

bool JournalWriter::flush() {
  {
    std::unique_lock lock(mutex_);
    hurry_ = !queue_.empty();
    wake_.notify_one();
    progress_.wait(lock, [&] { return on_disk_.record >= queued_.record || ended_; });
    if (ended_ || failed()) return false;
  }
  if (!isNameOf(file_, descriptor_.get())) stopTaking(kGone, ENOENT);
  return !failed() && acknowledged() == sequence_;
}

void JournalWriter::close() {
  stopThread();
  leftover_.release();
  failIfBehind();
  if (failed()) dropEmpty();
}

void JournalWriter::closeAndDropEmpty() {
  close();
  dropEmpty();
}

void JournalWriter::dropEmpty() noexcept {
  if (acknowledged() > 0 || anew_.record > 0 || !isNameOf(file_, descriptor_.get())) return;
  unlink(file_.c_str());
  bytes_ = 0;
}

}  // namespace palpate
