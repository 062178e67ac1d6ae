// SPDX-License-Identifier: Apache-2.0
// MetaImage: .mha, and .mhd with its data in a second file. Source of the format: https://itk.org/Wiki/ITK/MetaIO
//
// ITK reads the header; its frame is LPS. Every number that is used is checked here first: MetaIO takes the absolute
// value of a negative spacing, reads "1x" as 1, and ignores surplus numbers. The values are read here. So is the slope
// from elements to intensities, which ITK does not apply.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/files/components.hpp"
#include "engine/files/itk_image.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/text_header.hpp"
#include "engine/files/text_stored.hpp"

namespace palpate {
namespace {

double metaTypeBytes(const std::string& type) {
  if (type.find("CHAR") != std::string::npos) return 1;
  if (type.find("SHORT") != std::string::npos) return 2;
  if (type.find("LONG_LONG") != std::string::npos || type.find("DOUBLE") != std::string::npos) return 8;
  return 4;
}

void checkMetaSizes(const TextHeader& header, const std::string& source, std::size_t memory_budget_bytes) {
  const std::vector<double> sizes = header.numbers("dimsize");
  if (sizes.size() < 3) refuse(source, fmt::format("it has {} dimensions", sizes.size()), "give a volume");
  // MetaIO trusts NDims: it reads that many numbers into arrays of ten.
  if (header.numbers("ndims") != std::vector<double>{static_cast<double>(sizes.size())} || sizes.size() > 10) {
    refuse(source, fmt::format("its NDims \"{}\" is not the count of its DimSize", header.text("ndims")),
           "write the file again");
  }
  double voxels = 1;
  for (const double size : sizes) {
    if (!(size >= 1 && size <= 1e15) || size != std::floor(size)) {
      refuse(source, fmt::format("its DimSize \"{}\" is no list of counts", header.text("dimsize")),
             "write the file again");
    }
    voxels *= size;
  }
  const double bytes = metaTypeBytes(header.text("elementtype"));
  checkMemory(source, voxels * (bytes + kDenseBytesPerVoxel + kGridBytesPerVoxel + kGpuBytesPerVoxel),
              memory_budget_bytes);
}

// One channel is one component; MetaIO itself turns a channel count that is no number into 1.
void checkChannels(const TextHeader& header, const std::string& source) {
  const std::string channels = header.text("elementnumberofchannels");
  if (channels.empty() || channels == "1") return;
  const std::vector<double> count = header.numbers("elementnumberofchannels");
  if (count.size() == 1 && count[0] > 1) refuseComponents(source, Components::kColoursOrVectors, count[0]);
  refuse(source, fmt::format("its ElementNumberOfChannels \"{}\" is no count", channels), "write the file again");
}

void checkSpacing(const TextHeader& header, const std::string& source) {
  for (const std::string key : {"elementspacing", "elementsize"}) {
    for (const double spacing : header.numbers(key)) {
      if (spacing > 0 && std::isfinite(spacing)) continue;
      refuse(source,
             fmt::format("its {} \"{}\" is not positive", key == "elementsize" ? "ElementSize" : "ElementSpacing",
                         header.text(key)),
             "write the true voxel size into the header");
    }
  }
}

// "" would be no number; a key that is missing is none.
void checkNumbers(const TextHeader& header, const std::string& key, const char* name, std::size_t count,
                  const std::string& source) {
  if (!header.fields.contains(key)) return;
  const std::vector<double> numbers = header.numbers(key);
  const bool finite = std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); });
  if (finite && numbers.size() == count) return;
  refuse(source,
         fmt::format("its {} \"{}\" is not {}", name, header.text(key),
                     count == 1 ? "a finite number" : fmt::format("{} finite numbers", count)),
         "write the file again");
}

// Where the voxels lie. MetaIO knows each by several keys.
void checkPlace(const TextHeader& header, const std::string& source) {
  const std::size_t axes = header.numbers("dimsize").size();
  for (const auto& [key, name] :
       {std::pair("offset", "Offset"), std::pair("position", "Position"), std::pair("origin", "Origin"),
        std::pair("elementspacing", "ElementSpacing"), std::pair("elementsize", "ElementSize")}) {
    checkNumbers(header, key, name, axes, source);
  }
  for (const auto& [key, name] : {std::pair("transformmatrix", "TransformMatrix"), std::pair("rotation", "Rotation"),
                                  std::pair("orientation", "Orientation")}) {
    checkNumbers(header, key, name, axes * axes, source);
  }
}

// From elements to intensities. A slope of 0 would make all densities the same.
void applyScale(const TextHeader& header, ItkRequest& request) {
  const std::string slope = "elementtointensityfunctionslope", offset = "elementtointensityfunctionoffset";
  checkNumbers(header, slope, "ElementToIntensityFunctionSlope", 1, request.facts.source);
  checkNumbers(header, offset, "ElementToIntensityFunctionOffset", 1, request.facts.source);
  if (header.fields.contains(slope)) request.slope = header.numbers(slope)[0];
  if (header.fields.contains(offset)) request.intercept = header.numbers(offset)[0];
  if (request.slope == 0) {
    refuse(request.facts.source, "its ElementToIntensityFunctionSlope is 0, which makes every density one",
           "write the true slope into the header, or leave it out");
  }
  request.facts.rescale_slope = request.slope;
  request.facts.rescale_intercept = request.intercept;
}

}  // namespace

Volume readMeta(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const TextHeader header = readTextHeader(name, name, TextFormat::kMeta);
  checkChannels(header, name);
  checkMetaSizes(header, name, wanted.memory_budget_bytes);
  checkSpacing(header, name);
  checkPlace(header, name);
  ItkRequest request;
  request.reader = ItkReader::kMeta;
  request.path = name;
  request.memory_budget_bytes = wanted.memory_budget_bytes;
  request.stored = metaStored(header, name, name);
  request.facts.source = name;
  applyScale(header, request);
  request.facts.instead_of_nan = wanted.instead_of_nan;
  request.facts.format = "MetaImage";
  request.facts.orientation = "LPS file";
  if (header.text("elementspacing").empty() && header.text("elementsize").empty()) {
    request.facts.remark = "the file gives no voxel size; 1 mm is assumed";
  }
  return readItkImage(std::move(request));
}

}  // namespace palpate
