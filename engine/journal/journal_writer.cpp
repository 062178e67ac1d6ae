// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
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

// Writes the records and counts them and their bytes. A failure: as an errno value.
int writeBeginning(int descriptor, const JournalBeginning& beginning, std::uint64_t& sequence, std::uint64_t& bytes) {
  constexpr std::size_t kBricksInARecord = std::size_t{1} << 14U;  // 32 MiB
  std::span<const std::uint32_t> rest = beginning.bricks;
  do {
    const auto piece = rest.first(std::min(rest.size(), kBricksInARecord));
    rest = rest.subspan(piece.size());
    const std::string record = recordBytes(RecordKind::kBricks, ++sequence,
                                           bricksContent(beginning.mark, rest.empty(), *beginning.volume, piece));
    bytes += record.size();
    if (const int failed = writeAll(descriptor, record); failed != 0) return failed;
  } while (!rest.empty());
  return 0;
}

}  // namespace

JournalWriter::JournalWriter(const fs::path& folder, const JournalHeader& header, JournalOptions options,
                             const std::optional<JournalBeginning>& beginning)
    : file_(journalFile(folder)), options_(std::move(options)) {
  if (const int unmade = makeFolder(folder, Rights::kPrivate); unmade != 0) refuseFile(folder, unmade);
  const std::string bytes = headerBytes(header);
  // The header is written to a temporary name first, so that a journal without a header never exists.
  PartFile draft = openPartFile(file_, Rights::kPrivate);
  if (draft.descriptor < 0) refuseFile(file_, draft.error);
  descriptor_ = draft.descriptor;
  int failed = writeAll(descriptor_, bytes);
  std::uint64_t length = bytes.size();
  if (failed == 0 && beginning) failed = writeBeginning(descriptor_, *beginning, sequence_, length);
  if (failed == 0 && fsync(descriptor_) != 0) failed = errno;
  if (failed == 0) {
    leftover_ = Leftover::file([&] {
      // link() never replaces an existing journal.
      if (link(draft.name.c_str(), file_.c_str()) != 0) failed = errno;
      return failed == 0 ? file_ : fs::path();
    });
  }
  unlink(draft.name.c_str());
  draft.leftover.release();
  if (failed != 0) {
    ::close(descriptor_);
    if (failed != EEXIST) refuseFile(file_, failed);
    throw Error(Error::Code::kBadInput, folder.string(), "it holds the journal of another session",
                "recover that with 'palpate recover', or choose another folder with --journal");
  }
  if (const int unflushed = flushFolder(folder); unflushed != 0) {
    ::close(descriptor_);
    unlink(file_.c_str());
    refuseFile(folder, unflushed);
  }
  bytes_ = length;
  if (beginning) leftover_.release();  // it is worth keeping without a record
  acknowledged_ = sequence_;
  queued_ = on_disk_ = {sequence_, beginning ? beginning->mark.edits : 0};
  thread_ = std::thread([this] { work(); });
}

JournalWriter::~JournalWriter() {
  close();
}

template <typename Work>
std::uint64_t JournalWriter::appendOrEnd(const Work& work) noexcept {
  if (failed()) return ++sequence_;  // never acknowledged
  try {
    work();
  } catch (...) {
    ++sequence_;
    end("there was no memory for a record", ENOMEM);
  }
  return sequence_;
}

std::uint64_t JournalWriter::edit(std::span<const EditCommand> commands, RecordKind kind) noexcept {
  return appendOrEnd([&] { append(kind, editContent(commands, stampNumbers(commands))); });
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
  const std::string bytes = recordBytes(kind, sequence_ + 1, content);
  std::unique_lock lock(mutex_);
  const auto room = [&] { return queue_.empty() || queue_.size() + bytes.size() <= options_.queue_bytes; };
  if (!room() && !ended_) {
    hurry_ = true;
    wake_.notify_one();
    progress_.wait(lock, [&] { return room() || ended_; });
  }
  if (!ended_) queue_ += bytes;
  ++sequence_;
  if (ended_) return;
  queued_ = {sequence_, queued_.edit + (kind == RecordKind::kStamp ? 0 : 1)};
  wake_.notify_one();
}

void JournalWriter::work() {
  nameThisThread("journal");
  std::unique_lock lock(mutex_);
  for (;;) {
    // Now and then it looks whether its file is there, also when nothing comes.
    if (!wake_.wait_for(lock, kLookAtFile, [&] { return !queue_.empty() || closing_; })) {
      if (isNameOf(file_, descriptor_)) continue;
      lock.unlock();
      fail(kGone, ENOENT);
      lock.lock();
      ended_ = true;
      progress_.notify_all();
      return;
    }
    if (queue_.empty()) return;
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
      queue_.clear();
      return;
    }
  }
}

bool JournalWriter::writeGroup(const std::string& group) {
  int error = writeAll(descriptor_, group);
  if (error == 0 && fdatasync(descriptor_) != 0) error = errno;
  if (error == 0 && isNameOf(file_, descriptor_)) return true;
  if (error == 0) {  // written, but nobody will find it
    fail(kGone, ENOENT);
    return false;
  }
  // If even this fails, the reader finds a record that is cut short. It then recovers the same and reports the loss.
  if (ftruncate(descriptor_, static_cast<off_t>(bytes_.load())) == 0) static_cast<void>(fdatasync(descriptor_));
  fail("it cannot be written", error);
  return false;
}

// Flushes first, so that it is known up to which edit all is saved.
void JournalWriter::end(const char* what, int error) noexcept {
  flush();
  fail(what, error);
}

void JournalWriter::fail(const char* what, int error) noexcept {
  const std::lock_guard lock(mutex_);
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
  return fmt::format("{}: {} ({}); edits after number {}{} are not saved: {}save the volume itself", file_.string(),
                     failure_, std::strerror(failure_error_), on_disk_.edit, record,
                     failure_error_ == ENOMEM ? "" : "make room and ");
}

void JournalWriter::flush() {
  std::unique_lock lock(mutex_);
  hurry_ = !queue_.empty();
  wake_.notify_one();
  progress_.wait(lock, [&] { return on_disk_.record >= queued_.record || ended_; });
}

void JournalWriter::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    wake_.notify_one();
  }
  thread_.join();
  if (failed() && acknowledged() == 0) drop();
  leftover_.release();
  ::close(std::exchange(descriptor_, -1));
}

void JournalWriter::drop() noexcept {
  if (!std::exchange(dropped_, true)) unlink(file_.c_str());
  bytes_ = 0;
}

void JournalWriter::closeAndDropEmpty() {
  close();
  if (acknowledged() == 0) drop();
}

}  // namespace palpate
