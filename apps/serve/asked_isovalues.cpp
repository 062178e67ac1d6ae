// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/asked_isovalues.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate {

void AskedIsovalues::add(double isovalue, Done done) {
  const std::lock_guard lock(mutex_);
  asked_.push_back({isovalue, std::move(done)});
}

void AskedIsovalues::reached(double isovalue) {
  std::vector<Asked> answered;
  {
    const std::lock_guard lock(mutex_);
    auto end = asked_.end();
    while (end != asked_.begin() && std::prev(end)->isovalue != isovalue) --end;
    answered.assign(std::move_iterator(asked_.begin()), std::move_iterator(end));
    asked_.erase(asked_.begin(), end);
  }
  for (const Asked& one : answered) one.done({});
}

bool AskedIsovalues::refuse(const Error& refusal, std::optional<double> kept) {
  std::vector<Asked> answered;
  {
    const std::lock_guard lock(mutex_);
    const auto end =
        std::stable_partition(asked_.begin(), asked_.end(), [&](const Asked& one) { return one.isovalue == kept; });
    answered.assign(std::move_iterator(end), std::move_iterator(asked_.end()));
    asked_.erase(end, asked_.end());
  }
  for (const Asked& one : answered) one.done(refusal);
  return !answered.empty();
}

}  // namespace palpate
