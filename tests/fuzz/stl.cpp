// SPDX-License-Identifier: Apache-2.0
// An STL file, text or binary. An accepted binary file must be refused without its last byte, and with one more at its
// end.
#include <cstring>

#include "apps/mesh/stl_file.hpp"
#include "mesh_round_trip.hpp"

namespace {

using namespace palpate;

constexpr const char* kFile = "some.stl";

void check(const std::string& bytes) {
  TriangleMesh mesh;
  if (!fuzz::accepts(kFile, [&] { mesh = readStl(bytes, kFile); })) return;
  fuzz::requireMesh(mesh, readStl, kFile);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const bool is_binary =
      bytes.size() == 84 + 50 * mesh.triangles.size() && std::memcmp(bytes.data() + 80, &count, sizeof count) == 0;
  if (!is_binary) return;
  fuzz::require(!fuzz::isRead(readStl, bytes.substr(0, bytes.size() - 1), kFile), "it is read without its last byte");
  fuzz::require(!fuzz::isRead(readStl, bytes + '0', kFile), "it is read with a byte more");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
