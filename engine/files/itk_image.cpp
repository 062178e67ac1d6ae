// SPDX-License-Identifier: Apache-2.0
#include "engine/files/itk_image.hpp"

#include <system_error>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/components.hpp"
#include "engine/files/itk_child.hpp"
#include "engine/files/large_buffer.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

void checkShape(const ItkHeader& header, const std::string& source) {
  if (header.components != 1) {
    refuseComponents(source, Components::kColoursOrVectors, header.components);
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

Volume buildOf(const ItkRequest& request, std::span<const char> raw, ValueType type, const Vec3i& size,
               const Lattice& lattice, RoundedNumbers* rounded) {
  Volume::BrickSource bricks = rawBricks(raw, type, size, request.slope, request.intercept, rounded);
  return Volume::fromLayers(size, lattice, request.facts, [&](int) { return bricks; });
}

Volume readValues(const ItkRequest& request, ValueType type, const Vec3i& size, const Lattice& lattice,
                  RoundedNumbers* rounded) {
  const std::size_t bytes = static_cast<std::size_t>(size.cast<long long>().prod()) * byteSize(type);
  const StoredValues stored = checkedBySize(request.stored, static_cast<double>(bytes), request.facts.source);
  if (const auto block = rawBlockOf(stored)) {
    return Volume::fromLayers(size, lattice, request.facts,
                              layersOf(*block, type, size, request.slope, request.intercept, rounded));
  }
  LargeBuffer raw(bytes);
  readStored(stored, type, {raw.data(), raw.size()});
  return buildOf(request, {raw.data(), raw.size()}, type, size, lattice, rounded);
}

Volume read(ItkRequest& request) {
  const std::string& source = request.facts.source;
  const ItkHeader header = request.header ? *request.header : readItkHeader(request.reader, request.path, source);
  checkShape(header, source);
  const ValueType type = request.stored_type.value_or(*header.type);
  const auto& n = header.dimensions;
  checkMemory(source, n[0], n[1], n[2], static_cast<double>(byteSize(type)), request.memory_budget_bytes);
  const Vec3i size(static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2]));
  const Lattice claimed = request.lattice ? *request.lattice : latticeOf(header, request.metres_per_unit);
  const Lattice lattice = orthonormalised(claimed, source);
  if (request.facts.value_type.empty()) request.facts.value_type = nameOf(type);
  RoundedNumbers rounded;
  Volume volume = readValues(request, type, size, lattice, &rounded);
  volume.noteRounding(rounded.of(nameOf(type), request.slope != 1 || request.intercept != 0));
  return volume;
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
  } catch (const std::system_error& failure) {
    throw cannotRead(source, "it", failure.code());
  } catch (const std::exception& failure) {
    throw Error(Error::Code::kBadInput, source, fmt::format("it cannot be read ({})", failure.what()),
                "the file may be cut short or damaged: copy or write it again");
  }
}

}  // namespace palpate
