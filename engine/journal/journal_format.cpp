// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_format.hpp"

#include <algorithm>
#include <random>

#include <fmt/format.h>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/journal/byte_stream.hpp"

namespace palpate {
namespace {

static_assert(sizeof(std::uint32_t) + kMaxCommands * kLongestCommand <= kLongestRecord);

constexpr std::uint32_t kFirstVersionWithId = 4;
constexpr std::uint8_t kHasObject = 1;
constexpr std::uint8_t kHasMaterial = 2;

// The encoded members of these types, in order. With a const object they are written, otherwise read.
template <typename Lattice, typename Visit>
void forEachNumber(Lattice& lattice, const Visit& visit) {
  visit(lattice.origin_W);
  visit(lattice.R_WL);
  visit(lattice.spacing_m);
}

template <typename Header, typename Visit>
void forEachMember(Header& header, const Visit& visit) {
  visit(header.volume.source);
  visit(header.volume.size);
  forEachNumber(header.volume.lattice, visit);
  visit(header.volume.content);
  visit(header.profile.isovalue);
  visit(header.profile.background);
  visit(header.profile.object);
  visit(header.profile.slope_per_m);
  visit(header.profile.band_m);
}

// Encodes only the members that a kind uses, so that a journal of strokes stays small. Kind and flags come before.
template <typename Command, typename Number, typename Visit>
void forEachMember(Command& c, Number& stamp_number, const Visit& visit) {
  visit(c.strength);
  if (isBrush(c.kind)) {
    visit(c.from_W);
    visit(c.to_W);
    visit(c.radius_m);
    visit(c.falloff);
  }
  if (hasValue(c.kind)) visit(c.value);
  if (hasPlane(c.kind)) {
    visit(c.plane_W);
    visit(c.normal_W);
  }
  if (isStamp(c.kind)) {
    visit(stamp_number);
    visit(c.from_W);
    visit(c.R_WS);
  }
  if (c.object) visit(*c.object);
  if (c.material) {
    visit(c.material->low_density);
    visit(c.material->high_density);
    visit(c.material->drop);
  }
}

auto into(ByteWriter& out) {
  return [&out](const auto& member) { out.add(member); };
}
auto from(ByteReader& in) {
  return [&in](auto& member) { in.get(member); };
}

void addCommand(ByteWriter& out, const EditCommand& c, std::uint32_t stamp_number) {
  out.add(static_cast<std::uint8_t>(c.kind));
  out.add(static_cast<std::uint8_t>((c.object ? kHasObject : 0) | (c.material ? kHasMaterial : 0)));
  forEachMember(c, stamp_number, into(out));
}

bool getCommand(ByteReader& in, EditCommand& c, std::span<const std::shared_ptr<const Stamp>> stamps) {
  std::uint8_t kind = 0;
  std::uint8_t flags = 0;
  in.get(kind);
  in.get(flags);
  if (kind >= kEditKinds || flags > (kHasObject | kHasMaterial)) return false;
  c.kind = static_cast<EditKind>(kind);
  if ((flags & kHasObject) != 0) c.object.emplace();
  if ((flags & kHasMaterial) != 0) c.material.emplace();
  std::uint32_t stamp_number = 0;
  forEachMember(c, stamp_number, from(in));
  if (isStamp(c.kind)) {
    if (stamp_number == 0 || stamp_number > stamps.size()) return false;
    c.stamp = stamps[stamp_number - 1];
  }
  return in.good();
}

}  // namespace

std::uint64_t randomId() {
  std::random_device random;
  return std::uint64_t{random()} << 32U | random() | 1;
}

bool RecordOrder::follow(RecordKind kind) noexcept {
  if (kind == RecordKind::kUndo) {
    if (done_ == 0) return false;
    --done_;
    ++undone_;
  } else if (kind == RecordKind::kRedo) {
    if (undone_ == 0) return false;
    --undone_;
    ++done_;
  } else {
    if (kind == RecordKind::kEditOn && done_ == 0) return false;
    ++done_;
    undone_ = 0;
  }
  return true;
}

std::string headerBytes(const JournalHeader& header) {
  ByteWriter content;
  forEachMember(header, into(content));
  content.add(header.id);
  ByteWriter out;
  out.addRaw(kJournalMagic);
  out.add(kJournalVersion);
  out.add(std::string_view(content.bytes()));
  out.add(crc32c(out.bytes()));
  return out.bytes();
}

std::size_t readHeader(std::string_view bytes, const std::string& input, JournalHeader& header) {
  ByteReader in(bytes);
  std::uint32_t version = 0;
  if (in.getRaw(kJournalMagic.size()) != kJournalMagic) {
    throw Error(Error::Code::kBadInput, input, "it is no journal of Palpate",
                "name the folder that --journal was given");
  }
  in.get(version);
  if (in.good() && (version < kOldestJournalVersion || version > kJournalVersion)) {
    throw Error(Error::Code::kBadInput, input,
                fmt::format("it is a journal of format version {}, and this program knows versions {} to {}", version,
                            kOldestJournalVersion, kJournalVersion),
                "recover it with the Palpate that wrote it");
  }
  std::string text;
  std::uint32_t checksum = 0;
  in.get(text);
  const std::size_t checked = bytes.size() - in.left();
  in.get(checksum);
  const bool sound = in.good() && crc32c(bytes.substr(0, checked)) == checksum;
  ByteReader content(text);
  forEachMember(header, from(content));
  header.id = 0;
  if (version >= kFirstVersionWithId) content.get(header.id);
  if (!sound || !content.atEnd()) {
    throw Error(Error::Code::kBadInput, input, "its header is damaged, so it cannot be said which volume it belongs to",
                "bring the file back from a copy");
  }
  return bytes.size() - in.left();
}

std::string recordBytes(RecordKind kind, std::uint64_t sequence, std::string_view content) {
  ByteWriter out;
  out.add(static_cast<std::uint32_t>(content.size()));
  out.add(static_cast<std::uint32_t>(kind));
  out.add(sequence);
  out.addRaw(content);
  out.add(crc32c(out.bytes()));
  return out.bytes();
}

std::string editContent(std::span<const EditCommand> commands, std::span<const std::uint32_t> stamp_numbers) {
  ByteWriter out;
  out.add(static_cast<std::uint32_t>(commands.size()));
  for (std::size_t i = 0; i < commands.size(); ++i) addCommand(out, commands[i], stamp_numbers[i]);
  return out.bytes();
}

std::string stampContent(const Stamp& stamp) {
  ByteWriter out;
  out.add(stamp.size);
  forEachNumber(stamp.lattice, into(out));
  out.addRaw({reinterpret_cast<const char*>(stamp.distance_m.data()), stamp.distance_m.size() * sizeof(float)});
  return out.bytes();
}

std::optional<std::vector<EditCommand>> editOf(std::string_view content,
                                               std::span<const std::shared_ptr<const Stamp>> stamps) {
  ByteReader in(content);
  std::uint32_t count = 0;
  in.get(count);
  std::vector<EditCommand> commands;
  for (std::uint32_t i = 0; i < count; ++i) {
    EditCommand command;
    if (!getCommand(in, command, stamps)) return std::nullopt;
    commands.push_back(std::move(command));
  }
  if (!in.atEnd() || commands.empty()) return std::nullopt;
  return commands;
}

std::shared_ptr<const Stamp> stampOf(std::string_view content) {
  ByteReader in(content);
  auto stamp = std::make_shared<Stamp>();
  in.get(stamp->size);
  forEachNumber(stamp->lattice, from(in));
  const std::string_view distances = in.getRaw(in.left());
  const Vec3i& size = stamp->size;
  if (!in.good() || size.minCoeff() < 2 || size.maxCoeff() > 1024 ||
      distances.size() != static_cast<std::size_t>(size.cast<long long>().prod()) * sizeof(float)) {
    return nullptr;
  }
  stamp->distance_m.resize(distances.size() / sizeof(float));
  std::memcpy(stamp->distance_m.data(), distances.data(), distances.size());
  return stamp;
}

std::string bricksContent(const EditMark& mark, bool is_last, const Volume& volume,
                          std::span<const std::uint32_t> bricks) {
  ByteWriter out;
  out.add(mark.edits);
  out.add(mark.hash);
  out.add(static_cast<std::uint32_t>(is_last ? 1 : 0));
  out.add(static_cast<std::uint32_t>(bricks.size()));
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  for (const std::uint32_t brick : bricks) addBrick(out, volume, grid, brick);
  return out.bytes();
}

std::optional<BricksRecord> bricksOf(std::string_view content, KeptBricks& bricks) {
  ByteReader in(content);
  BricksRecord record;
  std::uint32_t is_last = 0, count = 0;
  in.get(record.mark.edits);
  in.get(record.mark.hash);
  in.get(is_last);
  in.get(count);
  if (!in.good() || is_last > 1 || !getBricks(in, count, bricks) || !in.atEnd()) return std::nullopt;
  record.is_last = is_last == 1;
  return record;
}

std::uint64_t editsOfBricks(std::string_view content) {
  ByteReader in(content);
  std::uint64_t edits = 0;
  in.get(edits);
  return in.good() ? edits : 0;
}

}  // namespace palpate
