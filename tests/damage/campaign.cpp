// SPDX-License-Identifier: Apache-2.0
#include "tests/damage/campaign.hpp"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/engine/files/files.hpp"

namespace palpate::damage {
namespace {

// In text most changed bytes are refused; only changed digits may pass. Few bytes are digits, so text takes more tries.
constexpr std::size_t kTimesForWords = 10;

const char* wordOf(Verdict::Kind kind) {
  switch (kind) {
    case Verdict::Kind::kRead:
      return "accepted";
    case Verdict::Kind::kRefused:
      return "refused";
    case Verdict::Kind::kBadMessage:
      return "refused with a message that is not as it should be";
    case Verdict::Kind::kThrown:
      return "threw what is no Error";
    case Verdict::Kind::kCrashed:
      return "crashed";
    case Verdict::Kind::kTooLong:
      return "took too long";
    case Verdict::Kind::kTooLarge:
      return "took too much memory";
  }
  return "";
}

// One format: its folder, the bytes of its file, and the fingerprint of their content.
class Subject {
 public:
  Subject(const WholeFile& file, const Plan& plan, Result& result) : file_(file), plan_(plan), result_(result) {
    const pid_t writer = fork();  // in a child: writing may load a volume, which starts threads
    if (writer == 0) {
      file.write(folder_.path());
      _exit(0);
    }
    waitpid(writer, nullptr, 0);
    whole_ = readFile(path());
    if (file_.header_bytes == 0 && file_.header_is_text) file_.header_bytes = endOfHeader();
    const Verdict intact = judge(file_, folder_.path(), plan.limits);
    if (intact.kind != Verdict::Kind::kRead) {
      throw std::runtime_error(fmt::format("{}, undamaged: {}: {}", file.name, wordOf(intact.kind), intact.words));
    }
    fingerprint_ = intact.fingerprint;
  }

  // Damages and judges file `n` of a cell. Plans with the same seed get the same file.
  void tryOne(Damage damage, std::size_t n) {
    std::seed_seq seeds = {plan_.seed, static_cast<std::uint64_t>(damage), std::uint64_t{n}};
    std::mt19937_64 random(seeds);
    const std::string bytes = damaged(whole_, damage, file_, random);
    writeFile(path(), bytes);
    const Verdict verdict = judge(file_, folder_.path(), plan_.limits);
    ++result_.files;
    result_.most_seconds = std::max(result_.most_seconds, verdict.seconds);
    result_.most_memory_bytes = std::max(result_.most_memory_bytes, verdict.memory_bytes);
    Cell& cell = result_.cells[{file_.name, damage}];
    cell.promised = mustBeSeen(damage, file_);
    const bool accepted = verdict.kind == Verdict::Kind::kRead;
    const bool changed = accepted && verdict.fingerprint != fingerprint_;
    ++(changed ? cell.changed : accepted ? cell.unchanged : cell.refused);
    if (isFailure(verdict.kind) || (changed && mustBeSeen(damage, file_))) fail(damage, n, verdict, bytes);
  }

 private:
  [[nodiscard]] std::string path() const { return folder_.file(file_.damaged); }

  // The end of a header that a library wrote.
  [[nodiscard]] std::size_t endOfHeader() const {
    const std::size_t mark = whole_.find(file_.is_mesh ? "end_header" : "ElementDataFile");
    return mark == std::string::npos ? 0 : whole_.find('\n', mark) + 1;
  }

  void fail(Damage damage, std::size_t n, const Verdict& verdict, const std::string& bytes) {
    std::string line = fmt::format("{}, {}, number {}: {}", file_.name, nameOf(damage), n, wordOf(verdict.kind));
    if (!verdict.words.empty()) line += fmt::format(" ({})", verdict.words);
    result_.failures.push_back(line);
    if (plan_.keep.empty()) return;
    std::filesystem::create_directories(plan_.keep);
    writeFile(fmt::format("{}/{}-{}", plan_.keep, result_.failures.size(), file_.damaged), bytes);
  }

  WholeFile file_;
  const Plan& plan_;
  Result& result_;
  TempFolder folder_;
  std::string whole_;
  std::uint32_t fingerprint_ = 0;
};

const char* wordOf(const Cell& cell) {
  if (cell.changed > 0) return "may pass";
  if (!cell.promised) return "mostly seen";
  return cell.unchanged > 0 ? "seen or harmless" : "seen";
}

}  // namespace

Result run(const Plan& plan, const std::function<void(std::size_t files)>& progress) {
  Result result;
  for (const WholeFile& file : wholeFiles()) {
    if (file.name.find(plan.only) == std::string::npos) continue;
    result.formats.push_back(file.name);
    Subject subject(file, plan, result);
    const auto tryAll = [&](Damage damage, std::size_t count) {
      for (std::size_t n = 0; n < count && applies(damage, file); ++n) {
        subject.tryOne(damage, n);
        if (progress) progress(result.files);
      }
    };
    const std::size_t times = file.values_are_text ? kTimesForWords : 1;
    for (const Damage damage : kDamages) tryAll(damage, times * plan.per_cell);
    tryAll(Damage::kMany, plan.many);
  }
  return result;
}

std::string table(const Result& result) {
  std::string text = "| format |", rule = "|---|";
  for (const Damage damage : kDamages) {
    text += fmt::format(" {} |", nameOf(damage));
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const std::string& format : result.formats) {
    text += fmt::format("| {} |", format);
    for (const Damage damage : kDamages) {
      const auto cell = result.cells.find({format, damage});
      text += fmt::format(" {} |", cell == result.cells.end() ? "-" : wordOf(cell->second));
    }
    text += "\n";
  }
  return text;
}

}  // namespace palpate::damage
