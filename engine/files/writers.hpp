// SPDX-License-Identifier: Apache-2.0
// engine/files/writers.hpp: one writer per format. Private to engine/files; writeVolume chooses among them.
#pragma once

#include "base/byte_sink.hpp"
#include "engine/field/value_type.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {

void writeNrrd(const Volume& volume, const ByteSink& sink);
void writeNifti(const Volume& volume, const std::string& name, const ByteSink& sink);
void writeMeta(const Volume& volume, const ByteSink& sink);
void writeVdb(const Volume& volume, const std::string& name, LengthUnit unit, const ByteSink& sink);

// kInt16 or kFloat32, by the rule of volume_file.hpp.
[[nodiscard]] ValueType typeToWrite(const Volume& volume);
// Writes all densities as values of that type, i fastest, in little-endian order.
void writeValues(const Volume& volume, ValueType type, const ByteSink& sink);

// Compresses bytes by gzip and passes them on to `sink`. Call finish() once, after the last write(). Throws what the
// sink throws.
class GzipSink {
 public:
  explicit GzipSink(const ByteSink& sink);
  ~GzipSink();
  GzipSink(const GzipSink&) = delete;
  GzipSink& operator=(const GzipSink&) = delete;
  void write(std::string_view bytes);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
