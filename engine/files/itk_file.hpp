// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_file.hpp: one image file open in ITK. Private to engine/files. A damaged file may end the process:
// only itk_child.cpp and library_read.cpp, which measures ITK, may open one.
//
// Neither this header nor its .cpp may include Eigen (so no lattice and no volume): ITK brings an older copy of its
// own, and the two do not go together in one source file. ITK's images are LPS millimetres.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/field/value_type.hpp"

namespace palpate {

enum class ItkReader { kNrrd, kNifti, kMeta, kDicomSlice };

struct ItkHeader {
  unsigned components = 1;
  std::vector<std::int64_t> dimensions;
  std::array<double, 3> origin = {0, 0, 0};
  std::array<double, 3> spacing = {1, 1, 1};
  std::array<std::array<double, 3>, 3> direction = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // of i, j, k
  std::optional<ValueType> type;  // as read() delivers them; empty: not numbers
};

class ItkFile {
 public:
  // Reads the header. Throws std::runtime_error with one line of ITK's reason. Set-up thread; while it and read() run,
  // std::cerr and std::cout are caught, so that ITK's chatter does not reach the screen.
  ItkFile(ItkReader reader, const std::string& path);
  ~ItkFile();

  [[nodiscard]] const ItkHeader& header() const noexcept { return header_; }
  // Fills `values`, which must hold all dimensions' voxels of header().type. Throws as the constructor does, and where
  // it holds more or less.
  void read(std::span<char> values);
  // Every DICOM value by its "0020|000e", trimmed; other formats may have some as well.
  [[nodiscard]] std::map<std::string, std::string> tags() const;

 private:
  struct Io;
  std::unique_ptr<Io> io_;
  ItkHeader header_;
};

}  // namespace palpate
