// SPDX-License-Identifier: Apache-2.0
// The name of a volume with its part and "?nan=". A name put together from what was understood is understood alike.
// Also the decimal strings of DICOM: each word is NaN, or a finite number that comes back when it is written and read
// again.
#include "engine/files/volume_name.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/outside_text.hpp"
#include "engine/files/dicom_slice.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

std::string textOf(const VolumeName& name) {
  std::string text = name.withPart();
  if (name.instead_of_nan) text += fmt::format("?nan={:.9g}", *name.instead_of_nan);
  if (name.resample) text += name.instead_of_nan ? "&resample" : "?resample";
  return text;
}

void checkName(const std::string& text) {
  VolumeName name;
  if (!fuzz::accepts(oneLine(text), [&] { name = parseVolumeName(text); })) return;
  fuzz::require(!name.instead_of_nan || std::isfinite(*name.instead_of_nan), "NaN would become no finite number");
  fuzz::mustAccept("its own words are refused", [&] {
    const VolumeName again = parseVolumeName(textOf(name));
    const bool same = again.path == name.path && again.part == name.part &&
                      again.instead_of_nan == name.instead_of_nan && again.resample == name.resample;
    fuzz::require(same, "it reads otherwise from " + textOf(name));
  });
}

void checkNumbers(const std::string& text) {
  for (const double number : dicomNumbers(text)) {
    fuzz::require(!std::isinf(number), "an infinite number");
    if (std::isnan(number)) continue;
    const std::vector<double> again = dicomNumbers(fmt::format("{:.17g}", number));
    fuzz::require(again.size() == 1 && again[0] == number, "a number that does not read back");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::textOf(data, size);
  checkName(text);
  checkNumbers(text);
  return 0;
}
