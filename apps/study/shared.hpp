// SPDX-License-Identifier: Apache-2.0
// apps/study/shared.hpp: things that several cells share, made when the first cell needs them and kept until the study
// is over. One thread.
#pragma once

#include <map>
#include <memory>
#include <utility>

namespace palpate {

template <class Key, class Thing>
class Shared {
 public:
  // The thing of this key; `make` returns a std::unique_ptr to a new one.
  template <class Make>
  Thing& of(const Key& key, const Make& make) {
    std::unique_ptr<Thing>& thing = things_[key];
    if (!thing) thing = make();
    return *thing;
  }

 private:
  std::map<Key, std::unique_ptr<Thing>> things_;
};

}  // namespace palpate
