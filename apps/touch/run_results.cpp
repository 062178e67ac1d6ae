// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/run_results.hpp"

#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>

#include "apps/report/summary.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// By name only: a folder of results may have been moved.
std::vector<std::string> listedBy(const fs::path& summary) {
  std::error_code ignored;
  if (!fs::is_regular_file(summary, ignored)) return {};
  std::ifstream in(summary);
  const nlohmann::json run = nlohmann::json::parse(in, nullptr, false);
  if (!run.is_object()) return {};
  const nlohmann::json schema = run.value("schema", nlohmann::json());
  if (!schema.is_string() || !schema.get<std::string>().starts_with(kSummaryName)) return {};
  std::vector<std::string> names = {summary.filename().string()};
  if (const auto files = run.find("files"); files != run.end() && files->is_array()) {
    for (const auto& file : *files) {
      if (file.is_string()) names.push_back(fs::path(file.get<std::string>()).filename().string());
    }
  }
  return names;
}

}  // namespace

std::vector<std::string> foreignResults(const fs::path& folder) {
  const std::vector<std::string> ours = listedBy(folder / "summary.json");
  std::vector<std::string> foreign;
  for (const char* name : kRunResults) {
    std::error_code ignored;
    const bool is_file = fs::is_regular_file(folder / name, ignored);
    if (is_file && std::find(ours.begin(), ours.end(), name) == ours.end()) foreign.emplace_back(name);
  }
  return foreign;
}

void refuseForeignResults(const fs::path& folder) {
  const std::vector<std::string> foreign = foreignResults(folder);
  if (foreign.empty()) return;
  throw Error(Error::Code::kBadInput, (folder / foreign.front()).string(),
              "it is not a result of palpate and would be replaced by one",
              "move it away or choose another folder with --out");
}

}  // namespace palpate
