// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/field_cache.hpp: the IsoField of the newest window, made again only for a new window.
//
// The window must be usable. Thread: the servo's. Cost: two comparisons; for a new window some 20 ns. Errors: none.
#pragma once

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

class FieldCache {
 public:
  explicit FieldCache(double isovalue) noexcept : isovalue_(isovalue) {}

  [[nodiscard]] const IsoField& of(const SampleWindow& window) noexcept {
    if (window.version != version_ || window.samples != samples_) {
      field_ = IsoField(window, isovalue_);
      version_ = window.version;
      samples_ = window.samples;
    }
    return field_;
  }
  void forget() noexcept {
    version_ = 0;
    samples_ = nullptr;
  }
  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }

 private:
  double isovalue_;
  IsoField field_;
  std::uint64_t version_ = 0;
  const Sample* samples_ = nullptr;
};

}  // namespace palpate
