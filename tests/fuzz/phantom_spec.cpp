// SPDX-License-Identifier: Apache-2.0
// The text of a phantom. An accepted one is within its bounds. Made again from all that was understood, it gives the
// same phantom.
#include "engine/phantoms/phantom_spec.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/outside_text.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

bool hasThickness(const PhantomSpec& spec) {
  const auto& kinds = phantomKinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == spec.name; });
  return std::find(kind->extra_keys.begin(), kind->extra_keys.end(), "thickness") != kind->extra_keys.end();
}

std::string textOf(const PhantomSpec& spec) {
  std::string text = fmt::format("phantom:{}?size={}x{}x{}&spacing={:.17g}x{:.17g}x{:.17g}m&noise={:.17g}&seed={}",
                                 spec.name, spec.size.x(), spec.size.y(), spec.size.z(), spec.spacing_m.x(),
                                 spec.spacing_m.y(), spec.spacing_m.z(), spec.noise, spec.seed);
  if (hasThickness(spec)) text += fmt::format("&thickness={:.17g}", spec.thickness_voxels);
  return text;
}

void check(const std::string& text) {
  PhantomSpec spec;
  if (!fuzz::accepts(oneLine(text), [&] { spec = parsePhantomSpec(text); })) return;
  fuzz::require(spec.size.minCoeff() >= 1 && spec.spacing_m.allFinite() && spec.spacing_m.minCoeff() > 0,
                "its size or spacing is none");
  fuzz::require(spec.noise >= 0 && spec.noise <= 10 && spec.thickness_voxels > 0, "its noise or thickness is none");
  fuzz::mustAccept("its own words are refused", [&] {
    const PhantomSpec again = parsePhantomSpec(textOf(spec));
    const bool same = again.name == spec.name && again.size == spec.size && again.spacing_m == spec.spacing_m &&
                      again.noise == spec.noise && again.seed == spec.seed &&
                      again.thickness_voxels == spec.thickness_voxels;
    fuzz::require(same, "it reads otherwise from " + textOf(spec));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
