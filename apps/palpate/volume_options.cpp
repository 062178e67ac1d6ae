// SPDX-License-Identifier: Apache-2.0
#include "series_option.hpp"

#include <memory>

#include "apps/scene/option_table.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

void addSeriesOption(CLI::App& verb, std::string& volume) {
  auto series = std::make_shared<std::string>();
  CLI::Option* option = verb.add_option("--series", *series, optionOfKey("series")->help);
  verb.parse_complete_callback([series, option, &volume] {
    if (option->count() > 0) volume = withSeries(volume, *series);
  });
}

}  // namespace palpate
