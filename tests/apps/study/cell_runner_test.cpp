// SPDX-License-Identifier: Apache-2.0
#include "apps/study/cell_runner.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace cell_runner_test {

using testing::ElementsAre;
using testing::Gt;
using testing::IsEmpty;
using testing::SizeIs;

const auto kGoOn = [] { return false; };
const auto kTellNobody = [](const RunState&) {};

// Cells that note when they run, and find what `figures` says for their number and the number of their run.
struct Notebook {
  std::vector<std::size_t> order{};
  std::vector<int> runs{};
  std::vector<StudyCell> cells{};
  std::vector<const StudyCell*> pointers{};

  Notebook(std::size_t count, std::function<CellFigures(std::size_t cell, int run)> figures) : runs(count, 0) {
    for (std::size_t i = 0; i < count; ++i) {
      cells.push_back({{{"number", static_cast<std::int64_t>(i)}}, [this, i, figures] {
                         order.push_back(i);
                         return figures(i, runs[i]++);
                       }});
    }
    for (const StudyCell& cell : cells) pointers.push_back(&cell);
  }
};

CellFigures plain(std::size_t cell, int run) {
  return {{{"error", static_cast<double>(cell)}}, {{"cost_ns", 100.0 * static_cast<double>(cell) + run}}};
}

TEST(CellRunner, TheWarmUpsTimesDoNotCount) {
  Notebook cells(3, plain);
  const CellRuns runs = runCells(cells.pointers, {.rounds = 4, .seed = 1}, kGoOn, kTellNobody);
  EXPECT_FALSE(runs.stopped);
  ASSERT_THAT(runs.cells, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cells.runs[i], 5);
    EXPECT_EQ(figureOf(runs.cells[i].errors, "error"), static_cast<double>(i));
    ASSERT_THAT(runs.cells[i].costs, SizeIs(1));
    EXPECT_EQ(runs.cells[i].costs[0].first, "cost_ns");
    const double base = 100.0 * static_cast<double>(i);
    EXPECT_THAT(runs.cells[i].costs[0].second, ElementsAre(base + 1, base + 2, base + 3, base + 4));
    EXPECT_TRUE(runs.cells[i].repeats);
  }
}

// Each round has every cell once, in an order of its own; the same seed gives the same orders.
TEST(CellRunner, RoundsGoOverAllCellsInAnOrderDrawnAnew) {
  constexpr std::size_t kCells = 50;
  Notebook one(kCells, plain), again(kCells, plain), other(kCells, plain);
  static_cast<void>(runCells(one.pointers, {.rounds = 2, .seed = 7}, kGoOn, kTellNobody));
  static_cast<void>(runCells(again.pointers, {.rounds = 2, .seed = 7}, kGoOn, kTellNobody));
  static_cast<void>(runCells(other.pointers, {.rounds = 2, .seed = 8}, kGoOn, kTellNobody));
  ASSERT_THAT(one.order, SizeIs(3 * kCells));
  EXPECT_EQ(one.order, again.order);
  EXPECT_NE(one.order, other.order);
  std::vector<std::vector<std::size_t>> rounds;
  for (std::size_t round = 0; round < 3; ++round) {
    const auto begin = one.order.begin() + static_cast<std::ptrdiff_t>(round * kCells);
    rounds.emplace_back(begin, begin + kCells);
    std::vector<std::size_t> sorted = rounds.back();
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::size_t> all(kCells);
    std::iota(all.begin(), all.end(), 0U);
    EXPECT_EQ(sorted, all);
  }
  EXPECT_NE(rounds[0], rounds[1]);
  EXPECT_NE(rounds[1], rounds[2]);
}

// Of 6 orders of 3 cells each comes with probability 1/6: in 6000 draws 1000 times, with a deviation of 29.
TEST(CellRunner, NoOrderIsPreferred) {
  std::map<std::vector<std::size_t>, int> times;
  for (int round = 0; round < 6000; ++round) ++times[orderOfRound(3, 1, round)];
  EXPECT_THAT(times, SizeIs(6));
  for (const auto& [order, count] : times) EXPECT_NEAR(count, 1000, 5 * 29);
}

TEST(CellRunner, ErrorsThatDifferAreNoticed) {
  Notebook cells(3, [](std::size_t cell, int run) {
    const double drift = cell == 1 && run == 2 ? 1e-15 : 0;
    const double none = cell == 2 ? std::nan("") : 0;
    return CellFigures{{{"error", 1 + drift}, {"other", none}}, {{"cost_ns", 1.0}}};
  });
  const CellRuns runs = runCells(cells.pointers, {.rounds = 3, .seed = 1}, kGoOn, kTellNobody);
  EXPECT_TRUE(runs.cells[0].repeats);
  EXPECT_FALSE(runs.cells[1].repeats);
  EXPECT_TRUE(runs.cells[2].repeats);  // NaN: no such figure, in every round
}

// At first, and after some rounds.
TEST(CellRunner, ACellThatFailsIsLeftOutAndTheOthersGoOn) {
  Notebook cells(4, [](std::size_t cell, int run) {
    if (cell == 1) refuse("VTK", "it is not installed", "install it");
    if (cell == 2 && run == 2) throw std::runtime_error("words of a library");
    return plain(cell, run);
  });
  const CellRuns runs = runCells(cells.pointers, {.rounds = 3, .seed = 1}, kGoOn, kTellNobody);
  EXPECT_EQ(runs.cells[1].left_out, "VTK: it is not installed; install it");
  EXPECT_EQ(cells.runs[1], 1);
  EXPECT_EQ(runs.cells[2].left_out, "words of a library");
  EXPECT_FALSE(runs.cells[2].measured());
  EXPECT_THAT(runs.cells[0].costs.at(0).second, SizeIs(3));
  EXPECT_THAT(runs.cells[3].costs.at(0).second, SizeIs(3));
}

// Stopped in the warm-up, in the first round that counts and later, before a cell and in it.
TEST(CellRunner, WhatWasMeasuredBeforeAStopIsKept) {
  constexpr std::size_t kCells = 5;
  for (const std::size_t after : {0U, 3U, 5U, 7U, 13U}) {
    for (const bool inside : {false, true}) {
      Notebook* book = nullptr;
      Notebook cells(kCells, [&](std::size_t cell, int run) {
        if (inside && book->order.size() > after) throw Error(Error::Code::kCancelled, "work", "stopped", "go on");
        return plain(cell, run);
      });
      book = &cells;
      const CellRuns runs = runCells(
          cells.pointers, {.rounds = 3, .seed = 1}, [&] { return !inside && cells.order.size() == after; },
          kTellNobody);
      EXPECT_TRUE(runs.stopped);
      std::size_t counted = 0, measured = 0;
      for (const CellRun& run : runs.cells) {
        measured += run.measured() ? 1 : 0;
        if (run.measured()) counted += run.costs.at(0).second.size();
      }
      EXPECT_EQ(measured, std::min(after, kCells));
      // One time each of the warm-up, which those of the first round replace.
      EXPECT_EQ(counted, after <= 2 * kCells ? std::min(after, kCells) : after - kCells);
    }
  }
}

TEST(CellRunner, TellsHowFarItIs) {
  Notebook cells(4, plain);
  std::vector<RunState> told;
  static_cast<void>(
      runCells(cells.pointers, {.rounds = 2, .seed = 1}, kGoOn, [&](const RunState& state) { told.push_back(state); }));
  ASSERT_THAT(told, SizeIs(12));
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(told[i].round, static_cast<int>(i / 4));
    EXPECT_GE(told[i].share, 0);
    EXPECT_LT(told[i].share, 1);
  }
  EXPECT_THAT(told[1].left_s, Gt(0));  // after the first cell has taken its time
}

TEST(CellRunner, WithoutCellsThereIsNothing) {
  const CellRuns runs = runCells({}, {}, kGoOn, kTellNobody);
  EXPECT_FALSE(runs.stopped);
  EXPECT_THAT(runs.cells, IsEmpty());
}

TEST(Cell, ItsKeyTellsItsParameters) {
  EXPECT_EQ(cellKey({{"algorithm", "hri"}, {"n_ticks", std::int64_t{5}}, {"speed_m_per_s", 0.1}}),
            "algorithm=hri n_ticks=5 speed_m_per_s=0.1");
}

}  // namespace cell_runner_test
}  // namespace palpate
