// SPDX-License-Identifier: Apache-2.0
// apps/rivals/itk_rivals.hpp: what ITK has for a job. The volume is read where it lies. One thread; ITK takes
// `threads`.
#pragma once

#include <string>
#include <vector>

#include "apps/rivals/rival.hpp"

namespace palpate {

// None where ITK has nothing alike.
[[nodiscard]] std::vector<Rival> itkRivals(const std::string& job, const RivalField& field, unsigned threads);

}  // namespace palpate
