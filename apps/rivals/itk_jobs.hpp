// SPDX-License-Identifier: Apache-2.0
// apps/rivals/itk_jobs.hpp: the rivals on ITK, for the table of the module "rivals". One source file cannot include the
// headers of ITK and of OpenVDB, since ITK brings another version of Eigen. Private to apps/rivals.
#pragma once

#include "apps/rivals/rivals.hpp"

namespace palpate {

[[nodiscard]] std::vector<Rival> itkJobs(const std::string& job, const RivalField& field, unsigned threads);

}  // namespace palpate
