// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_chain.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/filter_passes/filter_whole.hpp"

namespace palpate {
namespace {

std::vector<FilterStep> checked(std::vector<FilterStep> steps) {
  if (steps.size() <= kMostFilterSteps) return steps;
  throw Error(Error::Code::kBadInput, "the chain of filters",
              fmt::format("it takes {} passes over the volume, and {} are the most", steps.size(), kMostFilterSteps),
              "take fewer filters, or diffusions of fewer steps");
}

}  // namespace

FilterChain::FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps)
    : gpu_(gpu),
      transfer_(transfer),
      source_(source),
      dispatch_(gpu, transfer, checked(std::move(steps))),
      routes_(routesOf(dispatch_.steps())),
      reach_(totalReach(dispatch_.steps())),
      result_(std::make_unique<BrickPool>(gpu, transfer, source, "filtered density")) {}

FilterRegion& FilterChain::region() {
  if (!region_) region_ = std::make_unique<FilterRegion>(gpu_, transfer_, dispatch_, routes_, source_, *result_);
  return *region_;
}

void FilterChain::run(const std::function<void(double)>& progress) {
  filterWhole(gpu_, transfer_, dispatch_, routes_, source_, *result_, progress);
}

void FilterChain::reserve(std::size_t bricks) {
  result_->reserve(std::min(result_->brickCount() - result_->storedBricks(), bricks));
}

std::unique_ptr<FilterChain> filteredBy(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source,
                                        std::vector<FilterStep> steps, const std::function<void(double)>& progress) {
  if (steps.empty()) return nullptr;
  auto chain = std::make_unique<FilterChain>(gpu, transfer, source, std::move(steps));
  chain->run(progress);
  return chain;
}

}  // namespace palpate
