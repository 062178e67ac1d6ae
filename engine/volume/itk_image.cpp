// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/itk_image.hpp"

#include <system_error>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/large_buffer.hpp"
#include "engine/volume/memory_budget.hpp"
#include "engine/volume/raw_values.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuse(const std::string& source, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, source, reason, remedy);
}

void checkShape(const ItkHeader& header, const std::string& source) {
  if (header.components != 1) {
    refuse(source, fmt::format("it has {} components a voxel, and a density is one number", header.components),
           "extract one component");
  }
  if (header.dimensions.size() < 3) {
    refuse(source, fmt::format("it is an image of {} dimensions", header.dimensions.size()), "give a volume");
  }
  for (std::size_t axis = 3; axis < header.dimensions.size(); ++axis) {
    if (header.dimensions[axis] == 1) continue;
    refuse(source, fmt::format("it is a series of {} volumes", header.dimensions[axis]), "extract one time point");
  }
  if (!header.type) refuse(source, "its values are of a type that is not a number", "write it as integers or floats");
}

Lattice latticeOf(const ItkHeader& header, double metres_per_unit) {
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    lattice.origin_W[axis] = header.origin[n] * metres_per_unit;
    lattice.spacing_m[axis] = header.spacing[n] * metres_per_unit;
    lattice.R_WL.col(axis) = Vec3(header.direction[n][0], header.direction[n][1], header.direction[n][2]);
  }
  return lattice;
}

// Without ITK. Nothing if that fails or there are voxels that are no numbers: ITK then reads the file, to refuse it in
// its own words or to replace such voxels, as it does in NIfTI.
std::unique_ptr<Volume::Grid> readRaw(const ItkRequest& request, ValueType type, const Vec3i& size,
                                      const Lattice& lattice) {
  try {
    const LayerSource layers = layersOf(*request.raw, type, size, request.slope, request.intercept);
    return buildGridByLayers(size, lattice, request.facts, layers);
  } catch (const Error&) {
    return nullptr;
  } catch (const std::system_error&) {
    return nullptr;
  }
}

Volume read(ItkRequest& request) {
  const std::string& source = request.facts.source;
  std::optional<ItkFile> file;
  if (!request.header) file.emplace(request.reader, request.path);
  const ItkHeader header = request.header ? *request.header : file->header();
  checkShape(header, source);
  const ValueType type = *header.type;
  const auto& n = header.dimensions;
  checkMemory(source, n[0], n[1], n[2], static_cast<double>(byteSize(type)), request.memory_budget_bytes);
  const Vec3i size(static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2]));
  const Lattice claimed = request.lattice ? *request.lattice : latticeOf(header, request.metres_per_unit);
  const Lattice lattice = orthonormalised(claimed, source);
  if (request.facts.value_type.empty()) request.facts.value_type = nameOf(type);
  if (request.raw) {
    if (auto grid = readRaw(request, type, size, lattice)) return Volume(std::move(grid));
  }
  const auto count = static_cast<std::size_t>(size.cast<long long>().prod());
  if (!file) file.emplace(request.reader, request.path);
  checkShape(file->header(), source);
  const ValueType delivered = *file->header().type;  // not the file's where ITK applies a slope
  LargeBuffer raw(count * byteSize(delivered));
  file->read(raw.data());
  const BrickSource bricks = rawBricks({raw.data(), raw.size()}, delivered, size, request.slope, request.intercept);
  return Volume(buildGridByLayers(size, lattice, std::move(request.facts), [&](int) { return bricks; }));
}

}  // namespace

Volume readItkImage(ItkRequest request) {
  const std::string source = request.facts.source;
  try {
    return read(request);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(Error::Code::kOutOfMemory, source, "there is no memory for it", "crop or resample it");
  } catch (const std::exception& failure) {
    throw Error(Error::Code::kBadInput, source, fmt::format("it cannot be read ({})", failure.what()),
                "the file may be cut short or damaged: copy or write it again");
  }
}

}  // namespace palpate
