// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/run_length.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {
namespace {

double ticksOf(const Scene& scene) {
  return std::round(scene.duration_s * scene.rate_hz);
}

}  // namespace

double recordBytes(const Scene& scene) {
  return 2 * ticksOf(scene) * sizeof(TickRecord);
}

void checkRunLength(const Scene& scene, std::uint64_t available_bytes) {
  const std::string input = scene.path_file.empty()
                                ? fmt::format("--seconds {:g} at --rate {:g}", scene.duration_s, scene.rate_hz)
                                : fmt::format("{} at --rate {:g}", scene.path_file, scene.rate_hz);
  if (!(ticksOf(scene) >= 1)) {
    throw Error(Error::Code::kBadInput, input, "the run has no tick", "make it longer or the rate higher");
  }
  const double bytes = recordBytes(scene);
  const auto available = static_cast<double>(available_bytes);
  if (bytes <= available) return;
  constexpr double kBytesPerGiB = 1073741824.0;
  throw Error(Error::Code::kOutOfMemory, input,
              fmt::format("a run of {:.3g} s records {:.3g} ticks, which need {:.3g} GiB, and {:.3g} GiB are free",
                          scene.duration_s, ticksOf(scene), bytes / kBytesPerGiB, available / kBytesPerGiB),
              "make it shorter or the rate lower");
}

}  // namespace palpate
