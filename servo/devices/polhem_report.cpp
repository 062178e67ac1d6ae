// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/polhem_report.hpp"

namespace palpate {
namespace {

constexpr std::size_t kWords = kPolhemBytes / 2;
constexpr int kPressed = 5000, kSwitch = 10000;  // [count]: what a pressed switch adds to encoder d, and half of it
constexpr std::int16_t kCountFrom = 1;           // the command

using Words = std::array<std::int16_t, kWords>;

std::optional<Words> wordsOf(std::span<const std::uint8_t> report, std::size_t report_bytes) noexcept {
  if (report.size() != report_bytes || report_bytes < kPolhemBytes) return {};
  Words words;
  for (std::size_t i = 0; i < kWords; ++i)
    words[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(report[2 * i] | report[2 * i + 1] << 8U));
  return words;
}

// After `first` bytes.
Report reportOf(const Words& words, std::size_t first, std::size_t report_bytes) noexcept {
  Report report;
  report.size = first + report_bytes;
  for (std::size_t i = 0; i < kWords; ++i) {
    const auto word = static_cast<std::uint16_t>(words[i]);
    report.bytes[first + 2 * i] = static_cast<std::uint8_t>(word & 0xFFU);
    report.bytes[first + 2 * i + 1] = static_cast<std::uint8_t>(word >> 8U);
  }
  return report;
}

}  // namespace

std::optional<PolhemState> parsePolhem(std::span<const std::uint8_t> report, std::size_t report_bytes) noexcept {
  const std::optional<Words> words = wordsOf(report, report_bytes);
  if (!words || (words->back() != 0 && words->back() != 1)) return {};
  PolhemState state;
  std::copy_n(words->begin(), state.counts.size(), state.counts.begin());
  state.asks_for_calibration = words->back() == 1;
  state.pressed = state.counts[3] > kPressed;
  if (state.pressed) state.counts[3] = static_cast<std::int16_t>(state.counts[3] - kSwitch);
  return state;
}

Report polhemStateReport(const PolhemState& state, std::size_t report_bytes) noexcept {
  Words words{};
  std::copy(state.counts.begin(), state.counts.end(), words.begin());
  if (state.pressed) words[3] = static_cast<std::int16_t>(words[3] + kSwitch);
  words.back() = state.asks_for_calibration ? 1 : 0;
  return reportOf(words, 0, report_bytes);
}

Report polhemReport(const PolhemCommand& command, std::size_t report_bytes) noexcept {
  Words words{};
  if (command.count_from) {
    const PolhemCounts& from = *command.count_from;
    words = {from[3], from[4], from[5], kCountFrom, from[0], from[1], from[2]};
  } else {
    std::copy(command.currents_mA.begin(), command.currents_mA.end(), words.begin());
  }
  return reportOf(words, 1, report_bytes);
}

std::optional<PolhemCommand> parsePolhemCommand(std::span<const std::uint8_t> report,
                                                std::size_t report_bytes) noexcept {
  const std::optional<Words> words = wordsOf(report, report_bytes);
  if (!words) return {};
  const Words& w = *words;
  if (w[3] == 0) return PolhemCommand{.currents_mA = {w[0], w[1], w[2]}};
  if (w[3] != kCountFrom) return {};
  return PolhemCommand{.count_from = PolhemCounts{w[4], w[5], w[6], w[0], w[1], w[2]}};
}

}  // namespace palpate
