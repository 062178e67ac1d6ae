// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_reader.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "engine/journal/byte_stream.hpp"

namespace palpate {
namespace {

struct Frame {
  std::uint32_t length = 0;
  std::uint32_t kind = 0;
  std::uint64_t sequence = 0;
  std::string_view content;
  std::size_t bytes = 0;  // of the whole record; 0: it is cut short
  bool sound = false;
};

Frame frameAt(std::string_view bytes) {
  Frame frame;
  ByteReader in(bytes);
  in.get(frame.length);
  in.get(frame.kind);
  in.get(frame.sequence);
  frame.content = in.getRaw(frame.length);
  std::uint32_t checksum = 0;
  in.get(checksum);
  if (!in.good() || frame.length > kLongestRecord) return frame;
  frame.bytes = kRecordFrame + frame.length;
  frame.sound = crc32c(bytes.substr(0, frame.bytes - sizeof checksum)) == checksum;
  return frame;
}

class Reading {
 public:
  explicit Reading(std::string_view bytes) : bytes_(bytes) {}

  void readRecords(std::size_t at, Journal& journal) {
    while (at < bytes_.size()) {
      const Frame frame = frameAt(bytes_.substr(at));
      const std::string fault = take(frame, journal);
      if (!fault.empty()) {
        journal.damage = damageAt(at, fmt::format("record {} {}", journal.last_sequence + 1, fault));
        return;
      }
      journal.last_sequence = frame.sequence;
      at += frame.bytes;
    }
  }

 private:
  // Returns what is wrong with the record, or nothing.
  std::string take(const Frame& frame, Journal& journal) {
    if (frame.bytes == 0) return "is cut short";
    if (!frame.sound) return "has a wrong checksum";
    if (frame.sequence != journal.last_sequence + 1) return fmt::format("is missing: {} follows", frame.sequence);
    JournalRecord record{static_cast<RecordKind>(frame.kind), frame.sequence, {}};
    switch (record.kind) {
      case RecordKind::kStamp: {
        auto stamp = stampOf(frame.content);
        if (!stamp) return "holds no stamp";
        stamps_.push_back(std::move(stamp));
        return "";
      }
      case RecordKind::kEditOn:
        if (done_ == 0) return "goes on with what was not done";
        [[fallthrough]];
      case RecordKind::kEdit: {
        auto commands = editOf(frame.content, stamps_);
        if (!commands) return "holds no commands";
        record.commands = std::move(*commands);
        ++done_;
        undone_ = 0;
        break;
      }
      case RecordKind::kUndo:
        if (!frame.content.empty()) return "holds more than an undo has";
        if (done_ == 0) return "undoes what was not done";
        --done_;
        ++undone_;
        break;
      case RecordKind::kRedo:
        if (!frame.content.empty()) return "holds more than a redo has";
        if (undone_ == 0) return "does again what was not undone";
        ++done_;
        --undone_;
        break;
      default:
        return fmt::format("is of a kind {} that is not known", frame.kind);
    }
    journal.records.push_back(std::move(record));
    return "";
  }

  [[nodiscard]] JournalDamage damageAt(std::size_t at, std::string reason) const {
    JournalDamage damage{at, bytes_.size() - at, 0, std::move(reason)};
    while (at < bytes_.size()) {
      ++damage.records;
      const Frame frame = frameAt(bytes_.substr(at));
      if (frame.bytes == 0) break;
      at += frame.bytes;
    }
    return damage;
  }

  std::string_view bytes_;
  std::vector<std::shared_ptr<const Stamp>> stamps_;
  std::size_t done_ = 0;
  std::size_t undone_ = 0;
};

// Uses system calls: a C++ stream just ends when reading fails, or throws an exception that says nothing of the file.
// Nobody is waited for, as the reader of a pipe would wait.
std::string contentsOf(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) {
    throw Error(Error::Code::kIo, file.string(), fmt::format("it cannot be opened ({})", std::strerror(errno)),
                "check its permissions");
  }
  struct stat facts {};
  if (fstat(descriptor, &facts) != 0 || (!S_ISREG(facts.st_mode) && !S_ISDIR(facts.st_mode))) {
    close(descriptor);
    throw Error(Error::Code::kBadInput, file.string(), "it is no plain file, so it is no journal",
                "move it away, and name the folder that --journal was given");
  }
  std::string bytes;
  std::vector<char> piece(std::size_t{1} << 20U);
  ssize_t count = 0;
  do {
    count = read(descriptor, piece.data(), piece.size());
    if (count > 0) bytes.append(piece.data(), static_cast<std::size_t>(count));
  } while (count > 0 || (count < 0 && errno == EINTR));
  const int error = count < 0 ? errno : 0;
  close(descriptor);
  if (error == 0) return bytes;
  throw Error(Error::Code::kIo, file.string(), fmt::format("it cannot be read ({})", std::strerror(error)),
              error == EISDIR ? "name the folder that --journal was given"
                              : "check the disk, or bring the file back from a copy");
}

}  // namespace

Journal readJournal(const std::filesystem::path& folder) {
  const std::filesystem::path file = journalFile(folder);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    const std::filesystem::file_status status = std::filesystem::status(folder, ignored);
    const bool is_folder = std::filesystem::is_directory(status);
    const std::string reason = is_folder                         ? fmt::format("there is no {} in it", kJournalName)
                               : std::filesystem::exists(status) ? "it is no folder"
                                                                 : "there is no such folder";
    throw Error(Error::Code::kNotFound, folder.string(), reason, "name the folder that --journal was given");
  }
  const std::string bytes = contentsOf(file);
  Journal journal;
  const std::size_t first = readHeader(bytes, file.string(), journal.header);
  Reading(bytes).readRecords(first, journal);
  return journal;
}

std::string describeDamage(const JournalDamage& damage) {
  return fmt::format("{} record{} in {} byte{} from byte {} on, as {}", damage.records, damage.records == 1 ? "" : "s",
                     damage.bytes, damage.bytes == 1 ? "" : "s", damage.first_byte, damage.reason);
}

}  // namespace palpate
