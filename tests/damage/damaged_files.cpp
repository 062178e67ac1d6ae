// SPDX-License-Identifier: Apache-2.0
// damaged_files: damages whole files of every format that Palpate reads, and reads each in a process of its own. Lists
// those that crashed, hung, took too much memory or passed as undamaged. Exit status 1 if there are any.
//
//   damaged_files --count 100000 --seed 1 --seconds 5 --memory-mib 2048 --only NIfTI --keep FOLDER --table
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/damage/campaign.hpp"

int main(int count_of_words, char** words) {
  using namespace palpate::damage;
  Plan plan;
  std::size_t count = 2000, memory_mib = 2048;
  bool print_table = false;
  CLI::App app("Damages files of every format and reads them.");
  app.add_option("--count", count, "files, about; half of them with one damage each, half with several");
  app.add_option("--seed", plan.seed, "of all damage");
  app.add_option("--seconds", plan.limits.seconds, "the longest that one may take of a processor [s]");
  app.add_option("--memory-mib", memory_mib, "the most that one may take [MiB]");
  app.add_option("--only", plan.only, "a part of the names of formats");
  app.add_option("--keep", plan.keep, "a folder for the files that fail");
  app.add_flag("--table", print_table, "print the table of docs/volumes.md");
  CLI11_PARSE(app, count_of_words, words);
  plan.limits.memory_bytes = memory_mib << 20;

  std::size_t cells = 0, formats = 0;
  for (const WholeFile& file : wholeFiles()) {
    if (file.name.find(plan.only) == std::string::npos) continue;
    ++formats;
    for (const Damage damage : kDamages) cells += applies(damage, file) ? 1 : 0;
  }
  if (formats == 0) {
    std::cerr << "damaged_files: no format's name has \"" << plan.only << "\" in it\n";
    return 2;
  }
  plan.per_cell = (count / 2 + cells - 1) / cells;
  plan.many = (count / 2 + formats - 1) / formats;
  const Result result = run(plan, [&](std::size_t files) {
    if (files % 1000 == 0) std::cerr << files << " files\n";
  });
  for (const std::string& failure : result.failures) std::cout << failure << '\n';
  std::cout << fmt::format("{} files, {} failures; the longest took {:.1f} s, the largest {} MiB\n", result.files,
                           result.failures.size(), result.most_seconds, result.most_memory_bytes >> 20);
  if (print_table) std::cout << table(result);
  return result.failures.empty() ? 0 : 1;
}
