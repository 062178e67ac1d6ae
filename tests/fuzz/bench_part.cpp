// SPDX-License-Identifier: Apache-2.0
// Results of benches, which `palpate bench merge` reads. An accepted one, written and read again, is the same; joining
// it is refused in a line or gives a result, and every output can be made of it.
#include "apps/bench/result_file.hpp"
#include "apps/study/error_bench.hpp"
#include "apps/study/merge_parts.hpp"
#include "apps/study/study_chart.hpp"
#include "apps/study/study_report.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

void showAll(const BenchResult& result) {
  fuzz::require(!jsonText(result).empty() && !csvText(result).empty(), "a result is empty");
  static_cast<void>(errorTable(result));
  fuzz::require(errorReport(result).ends_with("</html>\n"), "the report has no end");
  fuzz::require(logChartSvg(errorCharts(result)).ends_with("</svg>\n"), "the chart has no end");
}

void check(const std::string& bytes) {
  const std::string name = "part.json";
  BenchResult result;
  if (!fuzz::accepts(name, [&] { result = benchResultFrom(bytes, name); })) return;
  const std::string text = jsonText(result);
  fuzz::mustAccept("its own words are refused", [&] {
    fuzz::require(jsonText(benchResultFrom(text, name)) == text, "it reads otherwise from its own words");
  });
  BenchResult joined;
  if (fuzz::accepts(name, [&] { joined = mergeParts({{name, result}}); })) {
    fuzz::mustAccept("an output cannot be made", [&] { showAll(joined); });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
