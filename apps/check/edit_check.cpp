// SPDX-License-Identifier: Apache-2.0
#include "apps/check/edit_check.hpp"

#include <vector>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/plan/plan.hpp"
#include "engine/reference/edit.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace {

// The next random edit that the volume accepts. In a thin volume many are too far away, or larger than the volume.
EditCommand nextEdit(RandomEdits& random, const Volume& volume) {
  for (int tries = 0; tries < 1000; ++tries) {
    EditCommand command = random.next();
    try {
      checkEdit(command, volume.size(), volume.lattice());
      return command;
    } catch (const Error&) {
      continue;
    }
  }
  throw Error(Error::Code::kBadInput, volume.facts().source, "it takes no edit of a thousand at random",
              "check edits on a larger volume");
}

}  // namespace

Check checkEdits(const Volume& volume, const EditCheckRequest& request, const std::function<void(double)>& progress) {
  return checkEdits(volume, reference::denseField(volume), request, progress);
}

Check checkEdits(const Volume& volume, reference::DenseField field, const EditCheckRequest& request,
                 const std::function<void(double)>& progress) {
  const double isovalue = request.isovalue ? *request.isovalue : defaultIsovalue(volume);
  checkIsovalue(volume, isovalue);
  Check check;
  check.name = "edits";
  check.what = fmt::format("{} at random, seed {}", request.edits, request.seed);
  check.volume = volume.facts().source;
  check.finite = true;
  const BrushProfile profile = brushProfile(volume, isovalue);
  Engine engine(volume, makePlan({}), isovalue, request.gpu);
  engine.allowEdits(profile);
  check.device = engine.gpu().name;

  // Densities from a tenth below the volume's to a tenth above, as far as edits may name them.
  const auto allowed = [](double density) { return std::clamp(density, -1e30, 1e30); };
  const double low = volume.minimum();
  const double high = volume.maximum();
  RandomEdits random(volume.size(), volume.lattice(), allowed(low - (high - low) / 10),
                     allowed(high + (high - low) / 10), request.seed);
  for (int done = 0; done < request.edits; ++done) {
    progress(static_cast<double>(done) / request.edits);
    const std::vector<EditCommand> commands = {nextEdit(random, volume)};
    const Stopwatch gpu_watch;
    (void)engine.edit(commands, 0);
    check.gpu_seconds += gpu_watch.seconds();
    const Stopwatch cpu_watch;
    reference::applyEdits(field, lowerEdits(commands, volume.size(), volume.lattice(), profile));
    check.cpu_seconds += cpu_watch.seconds();
  }
  Volume edited = Volume::fromDense(volume.size(), volume.lattice(), volume.toDense(), volume.facts());
  (void)engine.readBack(edited);
  const std::vector<float> got = edited.toDense();
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i)
        check.compare({i, j, k}, "density", got[field.offset(i, j, k)], field.at(i, j, k));
    }
  }
  progress(1);
  return check;
}

}  // namespace palpate
