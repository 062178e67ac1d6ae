// SPDX-License-Identifier: Apache-2.0
#include "engine/files/volume_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/text_header.hpp"
#include "engine/files/volume_name.hpp"
#include "engine/files/writers.hpp"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

// Visits the domain one layer of bricks at a time: eight slices, i fastest.
template <class Visit>
void forEachLayer(const Volume& volume, const Visit& visit) {
  const Vec3i& size = volume.size();
  const Vec3i bricks = volume.brickCount();
  const auto row = static_cast<std::size_t>(size.x());
  const std::size_t slice = row * static_cast<std::size_t>(size.y());
  std::vector<float> layer(slice * kBrickSize);
  std::array<float, kBrickVoxels> values = {};
  for (int bk = 0; bk < bricks.z(); ++bk) {
    const int deep = std::min(kBrickSize, size.z() - bk * kBrickSize);
    for (int bj = 0; bj < bricks.y(); ++bj) {
      for (int bi = 0; bi < bricks.x(); ++bi) {
        if (volume.readBrick({bi, bj, bk}, values.data())) values.fill(values[0]);
        const int wide = std::min(kBrickSize, size.x() - bi * kBrickSize);
        const int high = std::min(kBrickSize, size.y() - bj * kBrickSize);
        for (int k = 0; k < deep; ++k) {
          for (int j = 0; j < high; ++j) {
            float* to = layer.data() + static_cast<std::size_t>(k) * slice +
                        static_cast<std::size_t>(bj * kBrickSize + j) * row + std::ptrdiff_t{bi} * kBrickSize;
            std::copy_n(values.data() + (std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize, wide, to);
          }
        }
      }
    }
    visit(std::span<const float>(layer.data(), slice * static_cast<std::size_t>(deep)));
  }
}

// Compares bits, so -0 does not fit.
bool fitsInt16(float value) {
  if (!(value >= -32768.0F && value <= 32767.0F)) return false;
  return std::bit_cast<std::uint32_t>(static_cast<float>(static_cast<std::int16_t>(value))) ==
         std::bit_cast<std::uint32_t>(value);
}

template <class T>
std::string_view bytesOf(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

void refuseUnit(const std::string& name, std::optional<LengthUnit> unit) {
  if (unit != LengthUnit::kMetre) return;
  throw Error(Error::Code::kBadInput, name, "files of this format are in millimetres",
              "leave --unit out; .vdb and meshes can have metres");
}

}  // namespace

ValueType typeToWrite(const Volume& volume) {
  const std::string& type = volume.facts().value_type;
  if (!type.starts_with("int") && !type.starts_with("uint")) return ValueType::kFloat32;
  if (!fitsInt16(volume.minimum()) || !fitsInt16(volume.maximum())) return ValueType::kFloat32;
  std::array<float, kBrickVoxels> values = {};
  const Vec3i bricks = volume.brickCount();
  for (int bk = 0; bk < bricks.z(); ++bk) {
    for (int bj = 0; bj < bricks.y(); ++bj) {
      for (int bi = 0; bi < bricks.x(); ++bi) {
        const std::size_t count = volume.readBrick({bi, bj, bk}, values.data()) ? 1 : kBrickVoxels;
        if (!std::all_of(values.begin(), values.begin() + count, fitsInt16)) return ValueType::kFloat32;
      }
    }
  }
  return ValueType::kInt16;
}

void writeValues(const Volume& volume, ValueType type, const ByteSink& sink) {
  std::vector<std::int16_t> whole;
  forEachLayer(volume, [&](std::span<const float> values) {
    if (type == ValueType::kFloat32) return sink(bytesOf(values));
    whole.resize(values.size());
    std::transform(values.begin(), values.end(), whole.begin(), [](float v) { return static_cast<std::int16_t>(v); });
    sink(bytesOf(std::span<const std::int16_t>(whole)));
  });
}

namespace {

using Unit = std::optional<LengthUnit>;

LengthUnit unitOfVdb(const Volume& volume, Unit unit) {
  return unit.value_or(volume.facts().is_level_set ? LengthUnit::kMetre : LengthUnit::kMillimetre);
}

struct VolumeWriter {
  const char* suffix;
  bool takes_unit;  // and so keeps distances in it, where the volume is a level set
  void (*write)(const Volume& volume, const std::string& name, std::optional<LengthUnit> unit, const ByteSink& sink);
};

constexpr VolumeWriter kWriters[] = {
    {".vdb", true,
     [](const Volume& volume, const std::string& name, Unit unit, const ByteSink& sink) {
       writeVdb(volume, name, unitOfVdb(volume, unit), sink);
     }},
    {".nii", false,
     [](const Volume& volume, const std::string& name, Unit, const ByteSink& sink) { writeNifti(volume, name, sink); }},
    {".nii.gz", false,
     [](const Volume& volume, const std::string& name, Unit, const ByteSink& sink) {
       GzipSink packed(sink);
       writeNifti(volume, name, [&](std::string_view bytes) { packed.write(bytes); });
       packed.finish();
     }},
    {".nrrd", false,
     [](const Volume& volume, const std::string&, Unit, const ByteSink& sink) { writeNrrd(volume, sink); }},
    {".mha", false,
     [](const Volume& volume, const std::string&, Unit, const ByteSink& sink) { writeMeta(volume, sink); }}};

// Null for a name with another suffix.
const VolumeWriter* writerFor(const std::string& name) {
  const std::string lower = lowerCase(name);
  const auto* const found = std::find_if(std::begin(kWriters), std::end(kWriters),
                                         [&](const VolumeWriter& writer) { return lower.ends_with(writer.suffix); });
  return found == std::end(kWriters) ? nullptr : found;
}

}  // namespace

bool isVolumeFileName(const std::string& name) {
  return writerFor(name) != nullptr;
}

const std::string& volumeFileSuffixes() {
  static const std::string kSuffixes = [] {
    std::string words;
    for (const VolumeWriter& writer : kWriters) words += (words.empty() ? "" : ", ") + std::string(writer.suffix);
    return words;
  }();
  return kSuffixes;
}

void writeVolume(const Volume& volume, const std::string& name, std::optional<LengthUnit> unit, const ByteSink& sink) {
  const VolumeWriter* writer = writerFor(name);
  if (writer == nullptr) {
    throw Error(Error::Code::kBadInput, name, "its suffix names no format that volumes are written in",
                fmt::format("use one of {}", volumeFileSuffixes()));
  }
  if (!writer->takes_unit) refuseUnit(name, unit);
  writer->write(volume, name, unit, sink);
}

Rounding roundedByWriting(const Volume& volume, const std::string& name, std::optional<LengthUnit> unit) {
  const VolumeWriter* writer = writerFor(name);
  const bool scales = writer != nullptr && writer->takes_unit && volume.facts().is_level_set &&
                      unitOfVdb(volume, unit) == LengthUnit::kMillimetre;
  if (!scales) return {};
  RoundedFew rounded;
  forEachLayer(volume, [&](std::span<const float> values) {
    for (const float value : values) {
      const double distance_mm = static_cast<double>(value) * kMillimetresPerMetre;
      rounded.add(distance_mm, static_cast<float>(distance_mm));
    }
  });
  if (rounded.count == 0) return {};
  return {rounded.count, rounded.most, "millimetre"};
}

std::uint64_t saveVolume(const Volume& volume, const std::string& name) {
  AtomicFile file(name, Rights::kPrivate);
  std::uint64_t bytes = 0;
  writeVolume(volume, name, {}, [&](std::string_view piece) {
    bytes += piece.size();
    file.write(piece);
  });
  file.commit();
  return bytes;
}

void checkNotInput(const std::string& in, const std::string& out) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (!fs::exists(out, ignored)) return;
  const std::string path = parseVolumeName(in).path;
  const bool same = fs::equivalent(path, out, ignored);
  const fs::path folder = fs::absolute(out, ignored).parent_path();
  if (same || (fs::is_directory(path, ignored) && fs::equivalent(path, folder, ignored))) {
    throw Error(Error::Code::kBadInput, out, same ? "it is the input" : "it is a file of the input's folder",
                "write to another name");
  }
}

}  // namespace palpate
