// SPDX-License-Identifier: Apache-2.0
// palpate gradient IN -o OUT.vdb: the gradients of a volume as an OpenVDB file of vectors.
#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "apps/gradient/gradient_job.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {

void addGradientVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("gradient", "write the gradients of a volume as an OpenVDB file of vectors");
  verb->footer("Vectors are in the world (LPS), in density/mm; docs/gradients.md compares the operators.");
  auto request = std::make_shared<GradientRequest>();
  verb->add_option("in", request->in, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option("-o,--out", request->out, "OpenVDB file to write")->required()->type_name("OUT.vdb");
  verb->add_option("--operator", request->gradient, gradientNames() + " (default central)");
  verb->add_flag("--all", request->all, "of every brick, not of those alone that the isosurface needs");
  verb->add_option("--iso", request->isovalue, "isovalue [density]; as `palpate touch` chooses it if not given");
  verb->add_option("--gpu", request->gpu, "part of the Vulkan device's name; the best one if not given");
  addVolumeOptions(*verb, request->in);
  verb->callback([request] {
    Progress progress;
    const GradientResult result = gradientFile(*request, progress);
    printResult("{}\n", gradientWords(*request, result));
  });
}

}  // namespace palpate
