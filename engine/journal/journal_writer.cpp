// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_writer.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/flush_folder.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// 0, or the error's number.
int writeAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

[[noreturn]] void refuse(const fs::path& file, int error) {
  throw Error(Error::Code::kIo, file.string(), fmt::format("no journal can be kept there ({})", std::strerror(error)),
              "make room or choose another folder with --journal");
}

}  // namespace

JournalWriter::JournalWriter(const fs::path& folder, const JournalHeader& header, JournalOptions options)
    : file_(journalFile(folder)), options_(std::move(options)) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder, error.value());
  const std::string bytes = headerBytes(header);
  // The header goes to a name of its own first, so that a journal is never there without one.
  const fs::path draft = file_.string() + fmt::format(".{}.part", getpid());
  descriptor_ = open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) refuse(file_, errno);
  int failed = writeAll(descriptor_, bytes);
  if (failed == 0 && fsync(descriptor_) != 0) failed = errno;
  // link() never replaces a journal that is there.
  if (failed == 0 && link(draft.c_str(), file_.c_str()) != 0) failed = errno;
  unlink(draft.c_str());
  if (failed != 0) {
    ::close(descriptor_);
    if (failed != EEXIST) refuse(file_, failed);
    throw Error(Error::Code::kBadInput, folder.string(), "it holds the journal of another session",
                "recover that with 'palpate recover', or choose another folder with --journal");
  }
  if (const int unflushed = flushFolder(folder); unflushed != 0) {
    ::close(descriptor_);
    unlink(file_.c_str());
    refuse(folder, unflushed);
  }
  bytes_ = bytes.size();
  thread_ = std::thread([this] { work(); });
}

JournalWriter::~JournalWriter() {
  close();
}

void JournalWriter::checkEdit(std::span<const EditCommand> commands) const {
  if (commands.size() <= options_.most_commands) return;
  throw Error(Error::Code::kBadInput, file_.string(),
              fmt::format("{} commands in one edit, and its record holds {}", commands.size(), options_.most_commands),
              "give them in several edits");
}

std::uint64_t JournalWriter::edit(std::span<const EditCommand> commands) {
  checkEdit(commands);
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
  return append(RecordKind::kEdit, editContent(commands, numbers));
}

std::uint64_t JournalWriter::append(RecordKind kind, std::string_view content) {
  const std::string bytes = recordBytes(kind, ++sequence_, content);
  std::unique_lock lock(mutex_);
  const auto room = [&] { return queue_.empty() || queue_.size() + bytes.size() <= options_.queue_bytes; };
  if (!room() && failure_.empty()) {
    hurry_ = true;
    wake_.notify_one();
    progress_.wait(lock, [&] { return room() || !failure_.empty(); });
  }
  if (!failure_.empty()) return sequence_;  // never acknowledged
  queue_ += bytes;
  queued_ = sequence_;
  wake_.notify_one();
  return sequence_;
}

void JournalWriter::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return !queue_.empty() || closing_; });
    if (queue_.empty()) return;
    wake_.wait_for(lock, options_.gather, [&] { return closing_ || hurry_ || queue_.size() >= options_.queue_bytes; });
    hurry_ = false;
    const std::string group = std::exchange(queue_, {});
    const std::uint64_t newest = queued_;
    progress_.notify_all();
    lock.unlock();
    const bool saved = writeGroup(group);
    if (saved) {
      bytes_ += group.size();
      acknowledged_.store(newest, std::memory_order_release);
      if (options_.on_acknowledged) options_.on_acknowledged(newest);
    }
    lock.lock();
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
  if (error == 0) return true;
  // Where even this fails, the reader finds a record that is cut short: the same, with a word about it.
  if (ftruncate(descriptor_, static_cast<off_t>(bytes_.load())) == 0) static_cast<void>(fdatasync(descriptor_));
  fail("it cannot be written", error);
  return false;
}

void JournalWriter::fail(const std::string& what, int error) {
  const std::lock_guard lock(mutex_);
  failure_ = fmt::format("{}: {} ({}); edits after number {} are not saved: make room and save the volume itself",
                         file_.string(), what, std::strerror(error), acknowledged_.load());
  failed_.store(true, std::memory_order_release);
}

std::string JournalWriter::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void JournalWriter::flush() {
  std::unique_lock lock(mutex_);
  hurry_ = !queue_.empty();
  wake_.notify_one();
  progress_.wait(lock, [&] { return acknowledged() >= queued_ || !failure_.empty(); });
}

void JournalWriter::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    wake_.notify_one();
  }
  thread_.join();
  ::close(std::exchange(descriptor_, -1));
}

void JournalWriter::closeAndDropEmpty() {
  close();
  if (sequence_ == 0) unlink(file_.c_str());
}

}  // namespace palpate
