// SPDX-License-Identifier: Apache-2.0
// Journals. Almost every change breaks a checksum. So each input is read as it is, and again with sound frames, numbers
// and checksums, so that only the contents are wrong. What is read must come back from a journal that is written from
// it. Losses must be reported. Edits in effect can be lowered or are refused with a message.
#include <algorithm>
#include <cstring>
#include <map>

#include "engine/edit/lower_edit.hpp"
#include "engine/journal/byte_stream.hpp"
#include "engine/journal/replay.hpp"
#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

const fuzz::ScratchFile& journalScratch() {
  static const fuzz::ScratchFile kFile(kJournalName);
  return kFile;
}

Journal read(std::string_view bytes) {
  journalScratch().write(bytes);
  return readJournal(journalScratch().folder());
}

// Any volume, for inputs whose own header is damaged.
JournalHeader plainHeader() {
  JournalHeader header;
  header.volume.source = "phantom:sphere?size=16";
  header.volume.size = Vec3i::Constant(16);
  header.profile = brushProfile(30, -100, 200, Vec3::Constant(1e-3));
  return header;
}

// Where the header of a journal's bytes ends, by the header's own lengths: magic, version, length, content, checksum.
std::size_t headerEnd(std::string_view bytes) {
  ByteReader in(bytes);
  std::uint32_t version = 0;
  std::string content;
  static_cast<void>(in.getRaw(kJournalMagic.size()));
  in.get(version);
  in.get(content);
  in.get(version);
  return in.good() ? bytes.size() - in.left() : 0;
}

std::string withSoundFrames(std::string_view bytes) {
  std::string sound = headerBytes(plainHeader());
  ByteReader in(bytes.substr(headerEnd(bytes)));
  for (std::uint64_t number = 1; !in.atEnd() && in.good(); ++number) {
    std::uint32_t length = 0, kind = 0, checksum = 0;
    std::uint64_t sequence = 0;
    in.get(length);
    in.get(kind);
    in.get(sequence);
    const std::string_view content = in.getRaw(std::min<std::size_t>(length, in.left()));
    in.get(checksum);
    sound += recordBytes(static_cast<RecordKind>(kind), number, content);
  }
  return sound;
}

// All that a journal says, in one form: stamps are numbered by their first use, as a writer numbers them. Stamps that
// no command uses are left out.
std::string writtenAnew(const Journal& journal) {
  std::string bytes = headerBytes(journal.header);
  if (journal.base) {
    const KeptBricks& bricks = journal.base->bricks;
    ByteWriter content;
    content.add(journal.base->mark.edits);
    content.add(journal.base->mark.hash);
    content.add(std::uint32_t{1});
    content.add(static_cast<std::uint32_t>(bricks.bricks.size()));
    const float* next = bricks.densities.data();
    for (std::size_t i = 0; i < bricks.bricks.size(); ++i) {
      content.add(bricks.bricks[i]);
      content.add(bricks.counts[i]);
      content.addRaw({reinterpret_cast<const char*>(next), bricks.counts[i] * sizeof(float)});
      next += bricks.counts[i];
    }
    bytes += recordBytes(RecordKind::kBricks, 1, content.bytes());
  }
  std::map<const Stamp*, std::uint32_t> numbers;
  std::uint64_t sequence = journal.base ? 1 : 0;
  for (const JournalRecord& record : journal.records) {
    std::vector<std::uint32_t> used;
    for (const EditCommand& command : record.commands) {
      std::uint32_t number = 0;
      if (command.stamp) {
        const auto [known, is_new] =
            numbers.try_emplace(command.stamp.get(), static_cast<std::uint32_t>(numbers.size() + 1));
        if (is_new) bytes += recordBytes(RecordKind::kStamp, ++sequence, stampContent(*command.stamp));
        number = known->second;
      }
      used.push_back(number);
    }
    const std::string content = record.commands.empty() ? "" : editContent(record.commands, used);
    bytes += recordBytes(record.kind, ++sequence, content);
  }
  return bytes;
}

bool hasStamps(const Journal& journal) {
  return std::any_of(journal.records.begin(), journal.records.end(), [](const JournalRecord& record) {
    return std::any_of(record.commands.begin(), record.commands.end(),
                       [](const EditCommand& c) { return c.stamp != nullptr; });
  });
}

void checkDamage(const Journal& journal, std::string_view bytes) {
  if (!journal.damage) return;
  const JournalDamage& damage = *journal.damage;
  fuzz::require(damage.first_byte + damage.bytes == bytes.size() && damage.bytes > 0 && damage.records > 0,
                "what is lost is not told right");
  fuzz::require(describeDamage(damage).find('\n') == std::string::npos && !damage.reason.empty(),
                "the damage has no words");
  const Journal kept = read(bytes.substr(0, damage.first_byte));
  fuzz::require(
      !kept.damage && kept.records.size() == journal.records.size() && kept.last_sequence == journal.last_sequence,
      "what is kept cannot be read alone");
}

void checkLasting(const Journal& journal) {
  Lattice lattice;
  for (const LastingEdit& edit : lastingEdits(journal)) {
    try {
      static_cast<void>(lowerEdits(edit.commands, Vec3i::Constant(16), lattice, journal.header.profile));
    } catch (const Error& error) {
      fuzz::requireMessage(error, "");
    }
  }
}

void check(const std::string& bytes) {
  Journal journal;
  if (!fuzz::accepts(kJournalName, [&] { journal = read(bytes); })) return;
  if (journal.damage) fuzz::verdict = fuzz::Verdict::kRefused;
  checkDamage(journal, bytes);
  const std::string anew = writtenAnew(journal);
  fuzz::mustAccept("what was read is refused when it is written anew", [&] {
    const Journal again = read(anew);
    fuzz::require(!again.damage && writtenAnew(again) == anew, "it reads otherwise when it is written anew");
  });
  // Without stamps a journal of this version has one form only. So anything that was not understood would be missing
  // from it.
  const bool is_present = bytes[kJournalMagic.size()] == static_cast<char>(kJournalVersion);
  if (is_present && journal.last_sequence == journal.records.size() && !hasStamps(journal)) {
    const std::size_t kept = journal.damage ? journal.damage->first_byte : bytes.size();
    fuzz::require(bytes.substr(0, kept) == anew, "it holds more than was understood");
  }
  checkLasting(journal);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::textOf(data, size);
  check(withSoundFrames(bytes));
  check(bytes);
  return 0;
}
