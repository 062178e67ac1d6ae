// SPDX-License-Identifier: Apache-2.0
#include "endurance_figures.hpp"

#include <cstdlib>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "engine/gpu/gpu.hpp"

namespace palpate {

double numberOf(const char* variable, double usual) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atof(text) : usual;
}

BenchResult beginEndurance(const std::string& name, const std::string& version, std::string command) {
  const std::vector<gpu::GpuInfo> all = gpu::listGpus();
  BenchResult result =
      beginBench(name, all.empty() ? "none" : fmt::format("{}, {}", all.front().name, all.front().driver));
  const std::size_t begin = version.find('(') + 1;
  result.commit = version.substr(begin, version.find(')') - begin);
  result.command = std::move(command);
  return result;
}

void writeEndurance(const BenchResult& result, const std::string& title, const std::string& introduction,
                    const std::string& table) {
  const char* const folder = std::getenv("PALPATE_ENDURANCE_RESULTS");
  if (folder == nullptr) return;
  const std::filesystem::path place(folder);
  writeFileAtomically(place / (result.bench + ".json"), jsonText(result));
  writeFileAtomically(
      place / (result.bench + ".md"),
      benchPage(result, {.title = title.c_str(), .introduction = introduction.c_str(), .tables = table, .chart = {}}));
}

}  // namespace palpate
