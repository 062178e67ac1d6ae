// SPDX-License-Identifier: Apache-2.0
// servo/devices/parameter_rows.hpp: a device's parameters as a table of rows, for its entry in the registry. Private to
// servo/devices.
#pragma once

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <type_traits>
#include <utility>

#include "servo/devices/registry.hpp"

namespace palpate {

// A parameter and its member of a device's `Parameters`. The usual value is the default of that member.
template <class Parameters>
struct ParameterRow {
  std::string_view key, unit;
  double lowest, highest;
  std::string_view help;
  double (*get)(const Parameters&);
  void (*set)(Parameters&, double);
  bool is_whole = false;
};

// DeviceEntry::parameters of a device with one table of rows.
template <const auto& kRows>
std::span<const DeviceParameter> parametersOf() {
  static const auto kParameters = [] {
    std::array<DeviceParameter, std::size(kRows)> all;
    std::transform(std::begin(kRows), std::end(kRows), all.begin(), [](const auto& row) {
      return DeviceParameter{row.key, row.unit, row.get({}), row.lowest, row.highest, row.help, row.is_whole};
    });
    return all;
  }();
  return kParameters;
}

template <class Parameters>
Parameters given(std::span<const ParameterRow<Parameters>> rows, const DeviceSetup& setup) {
  Parameters parameters;
  for (const auto& row : rows) {
    const auto value = setup.values.find(row.key);
    if (value != setup.values.end()) row.set(parameters, value->second);
  }
  return parameters;
}

// A row for a number, or a flag, in the place that Place::of() finds in the parameters.
template <class Parameters, class Place>
constexpr ParameterRow<Parameters> placeRow(std::string_view key, std::string_view unit, double lowest, double highest,
                                            std::string_view help) {
  return {key,
          unit,
          lowest,
          highest,
          help,
          [](const Parameters& p) { return static_cast<double>(Place::of(p)); },
          [](Parameters& p, double v) {
            using Value = std::remove_reference_t<decltype(Place::of(p))>;
            Place::of(p) = static_cast<Value>(v);
          },
          std::is_integral_v<std::remove_reference_t<decltype(Place::of(std::declval<Parameters&>()))>>};
}

template <auto kMember>
struct MemberPlace {
  template <class Parameters>
  static constexpr auto& of(Parameters& p) {
    return p.*kMember;
  }
};

template <class Parameters, auto kMember>
constexpr ParameterRow<Parameters> memberRow(std::string_view key, std::string_view unit, double lowest, double highest,
                                             std::string_view help) {
  return placeRow<Parameters, MemberPlace<kMember>>(key, unit, lowest, highest, help);
}

}  // namespace palpate
