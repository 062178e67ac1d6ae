// SPDX-License-Identifier: Apache-2.0
// A PLY file of any form. A file that is accepted must be refused without its last byte, and with one more at its end.
#include "apps/mesh/ply_file.hpp"
#include "apps/mesh/ply_header.hpp"
#include "mesh_round_trip.hpp"

namespace {

using namespace palpate;

constexpr const char* kFile = "some.ply";

void check(const std::string& bytes) {
  TriangleMesh mesh;
  if (!fuzz::accepts(kFile, [&] { mesh = readPly(bytes, kFile); })) return;
  fuzz::requireMesh(mesh, readPly, kFile);
  const PlyHeader header = plyHeader(bytes, kFile);
  const bool has_values = bytes.size() > header.bytes;
  // A text file may end with blanks, and is complete without them.
  const bool is_text = header.form == PlyForm::kText;
  if (has_values && !is_text)
    fuzz::require(!fuzz::isRead(readPly, bytes.substr(0, bytes.size() - 1), kFile), "it is read without its end");
  fuzz::require(!fuzz::isRead(readPly, bytes + '0', kFile), "it is read with a byte more");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
