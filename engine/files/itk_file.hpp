// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_file.hpp: one image file open in ITK, which is in the module "itk" (base/module.hpp). Private to
// engine/files. A damaged file may end the process. So only itk_child.cpp may open one, and library_read.cpp, which
// measures ITK.
//
// Neither this header nor the module may include Eigen, and so neither a lattice nor a volume. ITK has an older copy of
// Eigen, and one source file cannot include both. ITK's images are LPS millimetres.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/field/value_type.hpp"

namespace palpate {

enum class ItkReader { kNrrd, kNifti, kMeta };

struct ItkHeader {
  unsigned components = 1;
  std::vector<std::int64_t> dimensions;
  std::array<double, 3> origin = {0, 0, 0};
  std::array<double, 3> spacing = {1, 1, 1};
  std::array<std::array<double, 3>, 3> direction = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // of i, j, k
  std::optional<ValueType> type;  // of the values as read() delivers them; empty: not numbers
};

class ItkFile {
 public:
  virtual ~ItkFile() = default;

  [[nodiscard]] virtual const ItkHeader& header() const noexcept = 0;
  // Fills `values`, which must have exactly the size of all voxels as header().type. Throws as open() does, and if the
  // size is another one.
  virtual void read(std::span<char> values) = 0;
};

struct ItkModule {
  static constexpr const char* kModule = "itk";
  static constexpr const char* kTable = "palpate_itk";
  // Reads the header. Throws std::runtime_error with ITK's reason on one line. Set-up thread. While this or read()
  // runs, std::cerr and std::cout are caught, so that ITK's messages do not reach the screen.
  std::unique_ptr<ItkFile> (*open)(ItkReader reader, const std::string& path);
};

}  // namespace palpate
