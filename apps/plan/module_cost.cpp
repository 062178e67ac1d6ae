// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/module_cost.hpp"

#include <algorithm>
#include <fstream>

#include <dlfcn.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/mapped_libraries.hpp"
#include "base/module.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

// Pages of this process in main memory, shared ones included [byte].
std::int64_t residentBytes() {
  std::ifstream file("/proc/self/statm");
  std::int64_t all_pages = 0;
  std::int64_t resident_pages = 0;
  file >> all_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

// In the child.
std::string loadedCost(const std::string& name) {
  const std::size_t libraries = mappedLibraries().size();
  const std::int64_t bytes = residentBytes();
  const Stopwatch watch;
  const void* library = dlopen(moduleFile(name).c_str(), RTLD_NOW | RTLD_LOCAL);
  const double ms = 1e3 * watch.seconds();
  if (library == nullptr) return nlohmann::json{{"failure", dlerror()}}.dump();
  return nlohmann::json{{"ms", ms},
                        {"bytes", std::max<std::int64_t>(0, residentBytes() - bytes)},
                        {"libraries", mappedLibraries().size() - libraries}}
      .dump();
}

}  // namespace

ModuleCost moduleCost(const std::string& name) {
  // The first time its files may come from the disk.
  const ChildOutcome outcome = runInChild(name, 1, ChildLimits{}, [&](std::size_t) { return loadedCost(name); });
  const ChildOutcome again = runInChild(name, 1, ChildLimits{}, [&](std::size_t) { return loadedCost(name); });
  ModuleCost cost{.name = name};
  for (const ChildOutcome* one : {&outcome, &again}) {
    if (!one->trouble) continue;
    cost.failure = one->trouble->error ? one->trouble->error->what() : one->trouble->words;
    return cost;
  }
  const nlohmann::json found = nlohmann::json::parse(again.results.front());
  cost.failure = found.value("failure", "");
  cost.ms = found.value("ms", 0.0);
  cost.bytes = found.value("bytes", std::uint64_t{0});
  cost.libraries = found.value("libraries", std::uint64_t{0});
  return cost;
}

}  // namespace palpate
