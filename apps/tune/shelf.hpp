// SPDX-License-Identifier: Apache-2.0
// apps/tune/shelf.hpp: a few things that are dear to make, kept for the next time.
//
// Who asks for a thing holds it: it lives on though the shelf drops it meanwhile. The shelf drops those that were asked
// for least lately, when there are too many, when they take too much, and all of them where a new one finds no memory.
// One thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>

#include "base/error.hpp"

namespace palpate {

template <class Thing>
class Shelf {
 public:
  // `most`: so many things at most, at least 1. `limit_bytes`: what they may take together, before another is made.
  Shelf(std::size_t most, std::function<std::uint64_t()> limit_bytes)
      : most_(most), limit_bytes_(std::move(limit_bytes)) {}

  // The thing that `fits`, or a new one. `make` returns a shared pointer, and may throw; `bytesOf` is a thing's size.
  template <class Fits, class Make, class BytesOf>
  [[nodiscard]] std::shared_ptr<Thing> find(const Fits& fits, const Make& make, const BytesOf& bytesOf) {
    const auto known = std::ranges::find_if(things_, [&](const auto& thing) { return fits(*thing); });
    if (known != things_.end()) {
      things_.splice(things_.begin(), things_, known);
      return things_.front();
    }
    const auto taken = [&] {
      std::uint64_t bytes = 0;
      for (const auto& thing : things_) bytes += bytesOf(*thing);
      return bytes;
    };
    while (!things_.empty() && (things_.size() >= most_ || taken() > limit_bytes_())) things_.pop_back();
    things_.push_front(withRoom(make));
    return things_.front();
  }

  // What `make` returns. Where it finds no memory the shelf is emptied, and it is called once more.
  template <class Make>
  [[nodiscard]] auto withRoom(const Make& make) {
    try {
      return make();
    } catch (const Error& error) {
      if (error.code() != Error::Code::kOutOfMemory || things_.empty()) throw;
    }
    clear();
    return make();
  }

  void clear() noexcept { things_.clear(); }

 private:
  std::size_t most_;
  std::function<std::uint64_t()> limit_bytes_;
  std::list<std::shared_ptr<Thing>> things_;  // the one asked for last comes first
};

}  // namespace palpate
