// SPDX-License-Identifier: Apache-2.0
#include "apps/rivals/rivals_module.hpp"

#include "base/module.hpp"

namespace palpate {

std::vector<Rival> itkRivals(const std::string& job, const RivalField& field, unsigned threads) {
  return loadModule<RivalsModule>().itk(job, field, threads);
}

OpenVdbRivals::OpenVdbRivals(const RivalField& field, unsigned threads)
    : library_(loadModule<RivalsModule>().openvdb(field, threads)) {}

std::vector<Rival> OpenVdbRivals::rivalsOf(const std::string& job) const {
  return library_->rivalsOf(job);
}

std::vector<Rival> OpenVdbRivals::picturesOf(const RivalView& view) const {
  return library_->picturesOf(view);
}

std::vector<float> OpenVdbRivals::distancesOf(const RivalView& view) const {
  return library_->distancesOf(view);
}

}  // namespace palpate
