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
  CLI::Option* resample_option = verb.add_flag("--resample", optionOfKey("resample")->help);
  const auto apply = [&volume](const CLI::Option& option, auto with) {
    if (option.count() == 0) return;
    if (volume.empty()) {
      throw Error(Error::Code::kBadInput, option.get_name(), "there is no volume that it could be said of",
                  "name the volume too");
    }
    volume = with(volume);
  };
  verb.parse_complete_callback([series, nan, series_option, nan_option, resample_option, apply] {
    apply(*series_option, [&](const std::string& name) { return withSeries(name, *series); });
    apply(*nan_option, [&](const std::string& name) { return withNan(name, *nan); });
    apply(*resample_option, withResample);
  });
}

}  // namespace palpate
