// SPDX-License-Identifier: Apache-2.0
// A PLY file of any form. What is whole is not whole any more without its last byte, nor with one more behind it.
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
  // Blanks may end a text, whose last line then is whole without them.
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
