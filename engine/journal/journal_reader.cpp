// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_reader.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
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
    const std::size_t first = at;
    std::string fault;
    while (at < bytes_.size()) {
      const Frame frame = frameAt(bytes_.substr(at));
      fault = take(frame, journal);
      if (!fault.empty()) break;
      journal.last_sequence = frame.sequence;
      at += frame.bytes;
    }
    if (fault.empty() && base_) fault = "is missing, and the journal begins with it";
    if (fault.empty()) return;
    const std::string reason = fmt::format("record {} {}", journal.last_sequence + 1, fault);
    if (base_) {  // without the rest of what it begins with nothing is of use
      at = first;
      journal.last_sequence = 0;
    }
    journal.damage = damageAt(at, journal.last_sequence, reason);
    if (at == first) noteBeginning(at, *journal.damage);
  }

 private:
  // Returns what is wrong with the record, or nothing.
  std::string take(const Frame& frame, Journal& journal) {
    if (frame.bytes == 0) return "is cut short";
    if (!frame.sound) return "has a wrong checksum";
    const auto kind = static_cast<RecordKind>(frame.kind);
    const bool is_first = journal.last_sequence == 0;
    if (kind == RecordKind::kBricks && is_first) base_.emplace();
    // A journal that begins with bricks goes on with the numbers of the one before.
    if (frame.sequence != journal.last_sequence + 1 && !(base_ && is_first && frame.sequence > 0))
      return fmt::format("is missing: {} follows", frame.sequence);
    if (base_) return takeBase(kind, frame, journal);
    if (kind == RecordKind::kStamp) {
      auto stamp = stampOf(frame.content);
      if (!stamp) return "holds no stamp";
      stamps_.push_back(std::move(stamp));
      return "";
    }
    JournalRecord record;
    std::string fault = decode(frame, record);
    if (!fault.empty()) return fault;
    if (!order_.follow(kind)) {
      return kind == RecordKind::kEditOn ? "goes on with what was not done"
             : kind == RecordKind::kUndo ? "undoes what was not done"
                                         : "does again what was not undone";
    }
    journal.records.push_back(std::move(record));
    return "";
  }

  std::string takeBase(RecordKind kind, const Frame& frame, Journal& journal) {
    if (kind != RecordKind::kBricks) return "is missing, and the journal begins with it";
    const auto bricks = bricksOf(frame.content, base_->bricks);
    if (!bricks) return "holds no bricks";
    if (journal.last_sequence > 0 && bricks->mark != base_->mark) return "holds bricks of other edits";
    base_->mark = bricks->mark;
    if (bricks->is_last) journal.base = *std::exchange(base_, std::nullopt);
    return "";
  }

  // What a sound frame holds. Returns what is wrong with it, or nothing.
  [[nodiscard]] std::string decode(const Frame& frame, JournalRecord& record) const {
    record = {static_cast<RecordKind>(frame.kind), frame.sequence, {}};
    switch (record.kind) {
      case RecordKind::kEdit:
      case RecordKind::kEditOn: {
        auto commands = editOf(frame.content, stamps_);
        if (!commands) return "holds no commands";
        record.commands = std::move(*commands);
        return "";
      }
      case RecordKind::kUndo:
        return frame.content.empty() ? "" : "holds more than an undo has";
      case RecordKind::kRedo:
        return frame.content.empty() ? "" : "holds more than a redo has";
      default:
        return fmt::format("is of a kind {} that is not known", frame.kind);
    }
  }

  // Whether a damaged first record is one of those that a journal may begin with, and of how many edits: by its kind,
  // or by what is in it.
  void noteBeginning(std::size_t at, JournalDamage& damage) const {
    constexpr std::uint64_t kMostEdits = std::uint64_t{1} << 32U;  // more is damage, too
    const Frame begin = frameAt(bytes_.substr(at));
    bool sound_behind = true;
    const std::size_t end = behindDamage(at, begin, 0, sound_behind);
    if (end < at + kRecordFrame) return;
    constexpr std::size_t kHead =
        kRecordFrame - sizeof(std::uint32_t);  // before the content; the checksum is behind it
    const std::string_view content = bytes_.substr(at + kHead, end - at - kRecordFrame);
    KeptBricks ignored;
    damage.is_of_beginning =
        static_cast<RecordKind>(begin.kind) == RecordKind::kBricks || bricksOf(content, ignored).has_value();
    const std::uint64_t edits = editsOfBricks(content);
    if (damage.is_of_beginning && edits < kMostEdits) damage.edits_before = edits;
  }

  // Walks from frame to frame. Where the length of one is damaged, the next that is sound is looked for.
  [[nodiscard]] JournalDamage damageAt(std::size_t at, std::uint64_t last_sequence, const std::string& reason) const {
    JournalDamage damage{at, bytes_.size() - at, 0, reason};
    damage.last_sequence = last_sequence;
    if (at < bytes_.size()) damage.is_torn_end = isTornEnd(at);
    if (damage.is_torn_end && frameAt(bytes_.substr(at)).bytes > 0) {  // zeros up to the end
      ++damage.records;
      ++damage.last_sequence;
      return damage;
    }
    bool has_sound_ones = true;  // behind this place, as far as is known
    while (at < bytes_.size()) {
      const Frame frame = frameAt(bytes_.substr(at));
      ++damage.records;
      ++damage.last_sequence;
      if (!frame.sound && has_sound_ones) {
        at = behindDamage(at, frame, damage.last_sequence, has_sound_ones);
        continue;
      }
      if (!frame.sound) {
        at = frame.bytes > 0 ? at + frame.bytes : bytes_.size();
        continue;
      }
      damage.is_torn_end = false;
      damage.last_sequence = std::max(damage.last_sequence, frame.sequence);
      JournalRecord record;
      if (decode(frame, record).empty() && std::ranges::none_of(record.commands, usesStamp))
        damage.later.push_back(std::move(record));
      at += frame.bytes;
    }
    return damage;
  }

  // Whether the record there may have been cut off as it was written: by the file's end, or, after a power cut, by
  // zeros up to the end, where the file had got its length and not yet its bytes. What a journal begins with was there
  // before it had its name.
  [[nodiscard]] bool isTornEnd(std::size_t at) const {
    constexpr std::size_t kFewestZeros = 8;  // more than a sound record can end in by its checksum
    const Frame frame = frameAt(bytes_.substr(at));
    const std::size_t zeros = bytes_.size() - (bytes_.find_last_not_of('\0') + 1);  // npos + 1 is 0
    const bool ends_in_zeros = zeros >= kFewestZeros && bytes_.size() - zeros < at + frame.bytes;
    if (static_cast<RecordKind>(frame.kind) == RecordKind::kBricks) return false;
    return ends_in_zeros || (frame.bytes == 0 && !isWholeButForItsLength(at));
  }

  // Whether all up to the file's end is one sound record whose length alone is damaged.
  [[nodiscard]] bool isWholeButForItsLength(std::size_t at) const {
    const std::size_t rest = bytes_.size() - at;
    if (rest < kRecordFrame || rest - kRecordFrame > kLongestRecord) return false;
    ByteWriter mended;
    mended.add(static_cast<std::uint32_t>(rest - kRecordFrame));
    mended.addRaw(bytes_.substr(at + sizeof(std::uint32_t)));
    return frameAt(mended.bytes()).sound;
  }

  // Where the next record begins. A search that finds none is the last.
  [[nodiscard]] std::size_t behindDamage(std::size_t at, const Frame& frame, std::uint64_t number,
                                         bool& has_sound_ones) const {
    const std::size_t next = at + frame.bytes;
    if (frame.bytes > 0 && (next == bytes_.size() || frameAt(bytes_.substr(next)).sound)) return next;
    // A journal that begins with bricks goes on with the numbers of the one before.
    const bool is_first = number <= 1;
    const std::uint64_t most =
        is_first ? std::numeric_limits<std::uint64_t>::max() : number + (bytes_.size() - at) / kRecordFrame;
    for (std::size_t place = at + 1; place + kRecordFrame <= bytes_.size(); ++place) {
      if (isNumbered(bytes_.substr(place), number, most) && frameAt(bytes_.substr(place)).sound) return place;
    }
    has_sound_ones = false;
    return frame.bytes > 0 && !isWholeButForItsLength(at) ? next : bytes_.size();
  }

  // Whether a head there has a number in this range and a kind that is known, which saves most checksums.
  [[nodiscard]] static bool isNumbered(std::string_view bytes, std::uint64_t from, std::uint64_t to) {
    ByteReader in(bytes);
    std::uint32_t length = 0, kind = 0;
    std::uint64_t sequence = 0;
    in.get(length);
    in.get(kind);
    in.get(sequence);
    return isRecordKind(kind) && sequence >= from && sequence <= to && length <= bytes.size() - kRecordFrame;
  }

  static bool usesStamp(const EditCommand& command) { return isStamp(command.kind); }

  std::string_view bytes_;
  std::optional<JournalBase> base_;  // until all of it is there
  std::vector<std::shared_ptr<const Stamp>> stamps_;
  RecordOrder order_;
};

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
  return readJournalFile(file);
}

Journal readJournalFile(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw Error(Error::Code::kBadInput, file.string(), "it is no plain file, so it is no journal",
                "move it away, and name the folder that --journal was given");
  }
  const std::string bytes = wholeFile(file, "the journal");
  Journal journal;
  journal.file = file;
  const std::size_t first = readHeader(bytes, file.string(), journal.header);
  Reading(bytes).readRecords(first, journal);
  return journal;
}

std::string describeDamage(const JournalDamage& damage) {
  return fmt::format("{} record{} in {} byte{} from byte {} on, as {}", damage.records, damage.records == 1 ? "" : "s",
                     damage.bytes, damage.bytes == 1 ? "" : "s", damage.first_byte, damage.reason);
}

}  // namespace palpate
