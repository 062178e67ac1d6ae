// SPDX-License-Identifier: Apache-2.0
#include "volume_options.hpp"

#include <memory>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "engine/files/volume_name.hpp"

namespace palpate {

void addVolumeOptions(CLI::App& verb, std::string& volume) {
  auto series = std::make_shared<std::string>();
  auto nan = std::make_shared<std::string>();
  CLI::Option* series_option = verb.add_option("--series", *series, optionOfKey("series")->help);
  CLI::Option* nan_option = verb.add_option("--nan", *nan, optionOfKey("nan")->help);
  const auto apply = [&volume](const CLI::Option& option, const std::string& value, auto with) {
    if (option.count() == 0) return;
    if (volume.empty()) {
      throw Error(Error::Code::kBadInput, option.get_name(), "there is no volume that it could be said of",
                  "name the volume too");
    }
    volume = with(volume, value);
  };
  verb.parse_complete_callback([series, nan, series_option, nan_option, apply] {
    apply(*series_option, *series, withSeries);
    apply(*nan_option, *nan, withNan);
  });
}

}  // namespace palpate
