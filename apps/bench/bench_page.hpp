// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_page.hpp: a bench's result as a page to read (Markdown), for docs/results.
//
// Any thread; no cost.
#pragma once

#include <string>

#include "apps/bench/bench_result.hpp"

namespace palpate {

struct PageWords {
  std::string title;
  std::string introduction;  // what was measured and how, in Markdown
  std::string tables;        // as on the terminal
  std::string chart;         // the picture's name as seen from the page; "" for none
};

[[nodiscard]] std::string benchPage(const BenchResult& result, const PageWords& words);

}  // namespace palpate
