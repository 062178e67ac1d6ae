// SPDX-License-Identifier: Apache-2.0
#include "engine/vdb/vdb_stream.hpp"

#include <ostream>
#include <streambuf>

#include <openvdb/io/Stream.h>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/files/quiet.hpp"
#include "engine/files/vdb_checksum.hpp"

namespace palpate {
namespace {

class SinkBuffer : public std::streambuf {
 public:
  explicit SinkBuffer(const ByteSink& sink) : sink_(sink) {}

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    sink_({bytes, static_cast<std::size_t>(count)});
    return count;
  }
  int_type overflow(int_type byte) override {
    const char one = traits_type::to_char_type(byte);
    sink_({&one, 1});
    return byte;
  }
  const ByteSink& sink_;
};

}  // namespace

openvdb::math::Transform::Ptr vdbTransform(const Lattice& lattice, double units_per_metre, const std::string& name) {
  openvdb::Mat4R matrix = openvdb::Mat4R::identity();  // of row vectors
  for (int axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < 3; ++n) matrix(axis, n) = lattice.R_WL(n, axis) * lattice.spacing_m[axis] * units_per_metre;
    matrix(3, axis) = lattice.origin_W[axis] * units_per_metre;
  }
  try {
    return openvdb::math::Transform::createLinearTransform(matrix);
  } catch (const openvdb::Exception&) {
    throw Error(Error::Code::kBadInput, name, "its voxels are too small for OpenVDB in this unit of length",
                units_per_metre < kMillimetresPerMetre ? "use --unit mm, or write .nrrd" : "write .nrrd");
  }
}

void streamGrid(const openvdb::GridBase::ConstPtr& grid, const ByteSink& sink) {
  std::uint32_t crc = 0;
  const ByteSink counted = [&](std::string_view bytes) {
    crc = crc32c(bytes, crc);
    sink(bytes);
  };
  SinkBuffer buffer(counted);
  std::ostream out(&buffer);
  out.exceptions(std::ios::badbit);  // so that exceptions of the sink are passed on
  const Quiet quiet;
  openvdb::io::Stream(out).write(openvdb::GridCPtrVec{grid});
  sink(vdbChecksumBytes(crc));
}

}  // namespace palpate
