// SPDX-License-Identifier: Apache-2.0
#include "kill_sessions.hpp"

#include <fstream>
#include <random>

#include <fmt/format.h>

#include "base/vec.hpp"

namespace palpate {
namespace {

constexpr int kCommands = 3000;

// Around a ball of 8 mm, whose surface it changes everywhere. Every one is the same.
class Script {
 public:
  std::string text() {
    std::string text;
    for (int i = 0; i < kCommands; ++i) text += next() + "\n";
    return text;
  }

 private:
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  std::string place(double radius_mm) {
    Vec3 p;
    do p = Vec3(between(-1, 1), between(-1, 1), between(-1, 1));
    while (p.norm() > 1 || p.norm() < 0.1);
    p *= radius_mm / p.norm();
    return fmt::format("{:.3f},{:.3f},{:.3f}", p.x(), p.y(), p.z());
  }

  std::string next() {
    if (done_ > 0 && between(0, 1) < 0.12) {
      --done_;
      ++undone_;
      return "undo";
    }
    if (undone_ > 0 && between(0, 1) < 0.5) {
      --undone_;
      ++done_;
      return "redo";
    }
    ++done_;
    undone_ = 0;
    return edit() + fmt::format(":strength={:.3f}", between(0.05, 1));
  }

  std::string edit() {
    static constexpr std::array<const char*, 10> kKinds = {"remove",  "add",     "paint", "flatten",   "smooth",
                                                           "inflate", "deflate", "cut",   "stamp-add", "stamp-remove"};
    const std::string kind = kKinds[random_() % kKinds.size()];
    if (kind == "cut") return fmt::format("cut:point={}:normal={}", place(7.5), place(1));
    if (kind.starts_with("stamp")) {
      return fmt::format("{}:mesh={}.obj:at={}:turn={:.1f},{:.1f},0", kind, random_() % 2 == 0 ? "small" : "large",
                         place(between(4, 8)), between(0, 360), between(0, 360));
    }
    std::string text =
        fmt::format("{}:from={}:to={}:radius={:.3f}", kind, place(between(4, 8)), place(6), between(0.8, 2));
    if (kind == "flatten") text += ":normal=" + place(1);
    if (kind == "paint") text += fmt::format(":value={:.1f}", between(-1000, 1000));
    if (random_() % 8 == 0) text += ":mirror=x";
    return text;
  }

  std::mt19937 random_{20};
  int done_ = 0;
  int undone_ = 0;
};

void writeTetrahedron(const std::filesystem::path& file, double edge_mm) {
  std::ofstream(file) << fmt::format("v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
                                     edge_mm);
}

}  // namespace

const char* killName(KillKind kind) noexcept {
  switch (kind) {
    case KillKind::kTool:
      return "touch";
    case KillKind::kToolAndSave:
      return "touch --save-every";
    case KillKind::kScript:
      return "edit";
  }
  return "";
}

// The tool drills all along its slide: more than a thousand edits.
std::vector<std::string> killArguments(KillKind kind, bool real_clock) {
  if (kind == KillKind::kScript)
    return {"edit", kKilledVolume, kKilledResult, "--script", "script.txt", "--journal", "journal"};
  std::vector<std::string> words = {"touch",      kKilledVolume,
                                    "--seconds",  real_clock ? "2" : "12",
                                    "--clock",    real_clock ? "real" : "simulated",
                                    "--picture",  "off",
                                    "--trace",    "off",
                                    "--edit",     "remove:radius=1mm:strength=0.02:period=1",
                                    "--journal",  "journal",
                                    "--approach", "1",
                                    "--out",      "out"};
  if (kind == KillKind::kToolAndSave) words.insert(words.end(), {"--save", kKilledSave, "--save-every", "0.1"});
  return words;
}

void makeReady(KillKind kind, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  if (kind != KillKind::kScript) return;
  std::ofstream(folder / "script.txt") << Script().text();
  writeTetrahedron(folder / "small.obj", 2);
  writeTetrahedron(folder / "large.obj", 4);
}

}  // namespace palpate
