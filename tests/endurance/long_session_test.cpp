// SPDX-License-Identifier: Apache-2.0
// However many edits a session has made, a service that was killed is back as soon as after a few: it makes those again
// that the checkpoints lack, and the volume has all.
//
// PALPATE_SESSION_EDITS: how many at least (1000; `./dev kills` takes 15 for each kill: the memory for undo, which the
// test counts, holds some 19000).
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "apps/serve/service_client.hpp"
#include "endurance_figures.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "service_processes.hpp"

namespace palpate {
namespace long_session_test {

namespace fs = std::filesystem;

class LongSession : public ServiceTest {
 protected:
  LongSession() {
    serveIt();
    EXPECT_TRUE(awaitService()) << contentsOf(file("serve.log"));
  }
  void serveIt() { serve({"phantom:sphere?size=64"}); }
  [[nodiscard]] std::string socket() const { return (file("run") / "palpate/service.sock").string(); }

  // Dabs in random places by several clients at once, as fast as they are on the disk.
  void edit(int count) const {
    askAtOnce(count, [](int i) {
      std::mt19937 random(static_cast<unsigned>(i));
      std::uniform_real_distribution<double> place_mm(-25, 25);
      const double x_mm = place_mm(random), y_mm = place_mm(random), z_mm = place_mm(random);
      return std::pair(wire::Verb::Edit, Words{fmt::format("{}:radius=1.5mm:at={:.3f},{:.3f},{:.3f}mm",
                                                           i % 3 == 0 ? "add" : "remove", x_mm, y_mm, z_mm)});
    });
  }
  void undoAll() const {
    askAtOnce(static_cast<int>(figure("undoable")), [](int) { return std::pair(wire::Verb::Undo, Words{}); });
    EXPECT_EQ(figure("undoable"), 0);
  }
  void askAtOnce(int count, const std::function<std::pair<wire::Verb, Words>(int)>& question) const {
    constexpr int kClients = 16;
    std::vector<std::jthread> clients;
    for (int c = 0; c < kClients; ++c) {
      clients.emplace_back([this, c, count, &question] {
        ServiceClient client(socket());
        for (int i = c; i < count; i += kClients) {
          auto [verb, words] = question(i);
          static_cast<void>(client.ask(verb, std::move(words)));
        }
      });
    }
  }
  [[nodiscard]] std::uint64_t contentSavedAs(const std::string& name) const {
    EXPECT_EQ(ctl({"save", name}).status, 0);
    return contentHash(loadVolume(file(name).string()));
  }
  [[nodiscard]] std::vector<fs::path> checkpoints() const {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(file("state"))) {
      const std::string name = entry.path().filename().string();  // not one that is being written
      if (name.starts_with("checkpoint-") && name.ends_with(".palpate")) found.push_back(entry.path());
    }
    return found;
  }
  // At least so many edits, and until there are two. How many it were.
  int editUntilCheckpoints(int least) const {
    int edits = 0;
    for (int round = 0; edits < least || (checkpoints().size() < 2 && round < 100); ++round) {
      const int more = std::max(500, least - edits);
      edit(more);
      edits += more;
    }
    EXPECT_EQ(checkpoints().size(), 2U);
    return edits;
  }
  // The size of the largest [byte].
  [[nodiscard]] std::uintmax_t removeCheckpoints() const {
    std::uintmax_t bytes = 0;
    for (const fs::path& path : checkpoints()) {
      bytes = std::max(bytes, fs::file_size(path));
      fs::remove(path);
    }
    return bytes;
  }
  void stop() {
    ASSERT_EQ(ctl({"stop"}).status, 0);
    for (int look = 0; look < 500 && !engine.hasEnded(); ++look)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  // Kills it, starts it, and waits until it answers [s].
  double comeBack() {
    engine.end(SIGKILL);
    const auto begin = std::chrono::steady_clock::now();
    serveIt();
    EXPECT_TRUE(awaitService()) << contentsOf(file("serve.log"));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  [[nodiscard]] double figure(const char* name) const { return status()[name].get<double>(); }
};

TEST_F(LongSession, IsBackAsSoonAsAShortOne) {
  const int least = static_cast<int>(numberOf("PALPATE_SESSION_EDITS", 1000));
  constexpr int kEditsOfAKill = 15;  // as ./dev kills has it
  const double empty_s = comeBack();
  const std::uint64_t start = contentSavedAs("start.vdb");
  const int edits = editUntilCheckpoints(least);
  ASSERT_EQ(figure("undoable"), edits);
  const std::uint64_t content = contentSavedAs("before.vdb");
  const double with_s = comeBack();
  EXPECT_EQ(contentSavedAs("with.vdb"), content);
  const double again = figure("undoable");
  EXPECT_LT(again, edits);
  // Killed again and again: where making edits again takes long, a checkpoint is written of what was made again. Two
  // may be, before one has all; then none is any more.
  double undoable = again;
  int shrunk = 0;
  for (int i = 0; i < 5; ++i) {
    static_cast<void>(comeBack());
    EXPECT_EQ(contentSavedAs("again.vdb"), content);
    const double now = figure("undoable");
    EXPECT_GT(now, 0);
    EXPECT_LE(now, undoable);
    shrunk += now < undoable ? 1 : 0;
    undoable = now;
  }
  EXPECT_LE(shrunk, 2);
  // One edit and its undo count among the others.
  ASSERT_EQ(ctl({"edit", "add:radius=3mm:at=0,0,28mm"}).status, 0);
  static_cast<void>(comeBack());
  EXPECT_NE(contentSavedAs("more.vdb"), content);
  ASSERT_EQ(ctl({"undo"}).status, 0);  // the newest checkpoint may have it; a start begins from the earlier one
  EXPECT_EQ(contentSavedAs("less.vdb"), content);
  engine.end(SIGKILL);  // else it may be about to write one
  const std::uintmax_t bytes = removeCheckpoints();
  const double without_s = comeBack();
  EXPECT_EQ(contentSavedAs("without.vdb"), content);
  EXPECT_EQ(figure("undoable"), edits);

  // Edits that cannot be undone are edits, too, when a service ends in good order.
  editUntilCheckpoints(0);
  static_cast<void>(comeBack());
  undoAll();
  const std::uint64_t left = contentSavedAs("left.vdb");
  EXPECT_NE(left, start);
  stop();
  serveIt();
  ASSERT_TRUE(awaitService()) << contentsOf(file("serve.log"));
  EXPECT_EQ(contentSavedAs("left-again.vdb"), left);
  // A journal without an edit in effect goes, and the checkpoints with it.
  engine.end(SIGKILL);
  static_cast<void>(removeCheckpoints());
  static_cast<void>(comeBack());
  undoAll();
  EXPECT_EQ(contentSavedAs("none.vdb"), start);
  stop();
  EXPECT_TRUE(checkpoints().empty());

  BenchResult result =
      beginEndurance("service-return", run({"--version"}).out, fmt::format("./dev kills {}", least / kEditsOfAKill));
  result.rows.push_back({{"edits", std::int64_t{edits}},
                         {"made_again", again},
                         {"empty_s", empty_s},
                         {"with_checkpoints_s", with_s},
                         {"without_checkpoints_s", without_s},
                         {"largest_checkpoint_bytes", static_cast<std::int64_t>(bytes)}});
  result.targets = {{"back after a kill, with checkpoints [s]", with_s, 2}};
  if (std::getenv("PALPATE_ENDURANCE_RESULTS") !=
      nullptr) {  // a measuring run, not a test: its times are what it is for
    EXPECT_TRUE(result.targets[0].holds()) << with_s;
  }
  writeEndurance(
      result, "Back after a long session",
      "`palpate serve` is killed (`kill -9`) after many small edits, and the time is measured from its start until it "
      "answers. With checkpoints it makes those edits again that the earlier of the two lacks; without them, all.",
      fmt::format("{:32}{:>12}{:>16}\n{:32}{:>12}{:>16.2f}\n{:32}{:>12.0f}{:>16.2f}\n{:32}{:>12}{:>16.2f}\n\n"
                  "The larger checkpoint has {:.1f} MiB.\n",
                  "after", "made again", "back after [s]", "no edit", 0, empty_s, fmt::format("{} edits", edits), again,
                  with_s, fmt::format("{} edits, no checkpoint", edits), edits, without_s,
                  static_cast<double>(bytes) / (1 << 20U)));
}

}  // namespace long_session_test
}  // namespace palpate
