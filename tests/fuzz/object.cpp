// SPDX-License-Identifier: Apache-2.0
// An object as --object takes it. An accepted object, written as text and read again, is the same, bit for bit.
#include "apps/scene/object_table.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

bool same(const ObjectSpec& a, const ObjectSpec& b) {
  return a.kind == b.kind && a.position_W == b.position_W && a.normal_W == b.normal_W && a.radius_m == b.radius_m &&
         a.size_m == b.size_m && a.rotation_deg == b.rotation_deg && a.scale == b.scale && a.unit == b.unit &&
         a.file == b.file;
}

void check(const std::string& text) {
  ObjectSpec spec;
  if (!fuzz::accepts("--object", [&] { spec = parseObject(text); })) return;
  const bool finite = spec.position_W.allFinite() && spec.normal_W.allFinite() && spec.size_m.allFinite() &&
                      spec.rotation_deg.allFinite() && std::isfinite(spec.radius_m) && std::isfinite(spec.scale);
  fuzz::require(finite, "a number is not finite");
  fuzz::mustAccept("its own words are refused: " + objectText(spec), [&] {
    fuzz::require(same(parseObject(objectText(spec)), spec), "it reads otherwise from " + objectText(spec));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
