// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_format.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/journal/byte_stream.hpp"
#include "engine/journal/crc32c.hpp"

namespace palpate {
namespace {

constexpr std::uint8_t kHasObject = 1;
constexpr std::uint8_t kHasMaterial = 2;

void addLattice(ByteWriter& out, const Lattice& lattice) {
  out.add(lattice.origin_W);
  out.add(lattice.R_WL);
  out.add(lattice.spacing_m);
}
void getLattice(ByteReader& in, Lattice& lattice) {
  in.get(lattice.origin_W);
  in.get(lattice.R_WL);
  in.get(lattice.spacing_m);
}

// Only what a kind uses is written: a journal of strokes stays small.
void addCommand(ByteWriter& out, const EditCommand& c, std::uint32_t stamp_number) {
  out.add(static_cast<std::uint8_t>(c.kind));
  out.add(static_cast<std::uint8_t>((c.object ? kHasObject : 0) | (c.material ? kHasMaterial : 0)));
  out.add(c.strength);
  if (isBrush(c.kind)) {
    out.add(c.from_W);
    out.add(c.to_W);
    out.add(c.radius_m);
    out.add(c.falloff);
  }
  if (c.kind == EditKind::kPaint) out.add(c.value);
  if (hasPlane(c.kind)) {
    out.add(c.plane_W);
    out.add(c.normal_W);
  }
  if (isStamp(c.kind)) {
    out.add(stamp_number);
    out.add(c.from_W);
    out.add(c.R_WS);
  }
  if (c.object) out.add(*c.object);
  if (c.material) {
    out.add(c.material->low_density);
    out.add(c.material->high_density);
    out.add(c.material->drop);
  }
}

bool getCommand(ByteReader& in, EditCommand& c, std::span<const std::shared_ptr<const Stamp>> stamps) {
  std::uint8_t kind = 0;
  std::uint8_t flags = 0;
  in.get(kind);
  in.get(flags);
  if (kind > static_cast<std::uint8_t>(EditKind::kDeflate) || flags > (kHasObject | kHasMaterial)) return false;
  c.kind = static_cast<EditKind>(kind);
  in.get(c.strength);
  if (isBrush(c.kind)) {
    in.get(c.from_W);
    in.get(c.to_W);
    in.get(c.radius_m);
    in.get(c.falloff);
  }
  if (c.kind == EditKind::kPaint) in.get(c.value);
  if (hasPlane(c.kind)) {
    in.get(c.plane_W);
    in.get(c.normal_W);
  }
  if (isStamp(c.kind)) {
    std::uint32_t number = 0;
    in.get(number);
    in.get(c.from_W);
    in.get(c.R_WS);
    if (number == 0 || number > stamps.size()) return false;
    c.stamp = stamps[number - 1];
  }
  if ((flags & kHasObject) != 0) in.get(c.object.emplace());
  if ((flags & kHasMaterial) != 0) {
    MaterialRate& material = c.material.emplace();
    in.get(material.low_density);
    in.get(material.high_density);
    in.get(material.drop);
  }
  return in.good();
}

}  // namespace

std::string headerBytes(const JournalHeader& header) {
  ByteWriter content;
  content.add(header.volume.source);
  content.add(header.volume.size);
  addLattice(content, header.volume.lattice);
  content.add(header.volume.content);
  const BrushProfile& profile = header.profile;
  for (const double number :
       {profile.isovalue, profile.background, profile.object, profile.slope_per_m, profile.band_m}) {
    content.add(number);
  }
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
  if (in.good() && version != kJournalVersion) {
    throw Error(Error::Code::kBadInput, input,
                fmt::format("it is a journal of format version {}, and this program knows version {}", version,
                            kJournalVersion),
                "recover it with the Palpate that wrote it");
  }
  std::string text;
  std::uint32_t checksum = 0;
  in.get(text);
  const std::size_t checked = bytes.size() - in.left();
  in.get(checksum);
  const bool sound = in.good() && crc32c(bytes.substr(0, checked)) == checksum;
  ByteReader content(text);
  content.get(header.volume.source);
  content.get(header.volume.size);
  getLattice(content, header.volume.lattice);
  content.get(header.volume.content);
  BrushProfile& profile = header.profile;
  for (double* number :
       {&profile.isovalue, &profile.background, &profile.object, &profile.slope_per_m, &profile.band_m}) {
    content.get(*number);
  }
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
  addLattice(out, stamp.lattice);
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
  getLattice(in, stamp->lattice);
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

}  // namespace palpate
